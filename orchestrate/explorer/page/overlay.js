/** Branches of periodic orbits over the diagram: stable, unstable, bifurcation points. */

import { panelPlaces, STRIP } from "./diagram_view.js";
import { pointAt } from "./excitation.js";
import { axisToPixels } from "./scale.js";
import { gapUnit } from "./units.js";

/** Draws them. @param {Table} table @param {DiagramView} view @returns {Draw} */
export function branchOverlay({ branches, bifurcations, structure }, view) {
  return (pen, size, theme) => {
    const [left, top, width, height] = panelPlaces(size).gaps;
    const px = axisToPixels(view.axes.x, left, left + width);
    const scale = axisToPixels(view.axes.gaps, top + height - STRIP, top);
    const { level, lanes } = /** @type {Diagram} */ (view.diagram);
    const colour = lanes.length > 1 ? theme.ink : theme.two; // not one of the sweeps'
    /** @param {number} gap @param {number} eta */
    const py = (gap, eta) => scale(gap * gapUnit(pointAt(structure, eta, level), level));
    pen.drawClipped([left, top, width, height - STRIP], () => {
      for (const { x, y, stable } of branches) {
        const look = { stroke: colour, width: 1.8, dash: stable ? [] : [5, 4] };
        pen.line(x.map(px), y.map((gap, i) => py(gap, x[i])), look);
      }
      /** @type {[number, number][]} */
      const taken = [];
      for (const { eta, gap, kind } of bifurcations) {
        const [x, y] = [px(eta), py(gap, eta)];
        pen.dots([x], [y], 4, { fill: colour });
        let level = y - 10;
        while (taken.some(([a, b]) => Math.abs(a - x) < 110 && Math.abs(b - level) < 12)) level -= 13;
        taken.push([x, level]);
        pen.text(x + 6, level, kind, { anchor: "start", fill: colour, size: 11 });
      }
    });
  };
}
