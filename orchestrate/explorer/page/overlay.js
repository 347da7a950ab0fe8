/** Branches of periodic orbits over the diagram: stable, unstable, bifurcation points. */

import { panels, STRIP } from "./diagram_view.js";
import { scaleOf } from "./scale.js";

/**
 * Draws them.
 * @param {import("./payload.js").Table} table
 * @param {import("./diagram_view.js").DiagramView} view
 * @returns {import("./picture.js").Draw}
 */
export function overlayOf({ branches, bifurcations }, view) {
  return (pen, size, theme) => {
    const [left, top, width, height] = panels(size).gaps;
    const px = scaleOf(view.axes.x, left, left + width);
    const py = scaleOf(view.axes.gaps, top + height - STRIP, top);
    pen.inside([left, top, width, height - STRIP], () => {
      for (const { x, y, stable } of branches) {
        const look = { stroke: theme.two, width: 1.8, dash: stable ? [] : [5, 4] };
        pen.line(x.map(px), y.map(py), look);
      }
      for (const { eta, gap, kind } of bifurcations) {
        pen.dots([px(eta)], [py(gap)], 4, { fill: theme.two });
        pen.text(px(eta) + 7, py(gap) - 9, kind, { anchor: "start", fill: theme.two, size: 11 });
      }
    });
  };
}
