/** Draws an orbit diagram: gaps on a logarithmic axis with a strip for zero, impacts below. */

import { plottingArea, drawFrame } from "./chart.js";
import { LOWEST } from "./diagram.js";
import { Picture } from "./picture.js";
import { axisToPixels } from "./scale.js";
import { rgbOf } from "./theme.js";
import { ratioUnit, gapUnit, axisWords } from "./units.js";

export const STRIP = 16; // px
const SHARE = 0.72; // of the height, for the gaps

/** Places of both panels. @param {Size} size @returns {{gaps: Place, impacts: Place}} */
export function panelPlaces(size) {
  const [left, top, width, height] = plottingArea(size);
  const upper = Math.round(height * SHARE);
  const from = top + upper + 16;
  return { gaps: [left, top, width, upper], impacts: [left, from, width, top + height - from] };
}

/** What the axes of a diagram show at present. */
export class AxisLimits {
  constructor() {
    this.low = Infinity;
    this.high = 0;
    this.most = 1;
  }

  /** Take a response in; whether it reaches beyond. @param {Found} found @param {number} unit of gaps on the axis */
  include({ gaps, impacts }, unit) {
    let beyond = false;
    for (const gap of gaps) {
      if (gap * unit > this.high) [this.high, beyond] = [2 * gap * unit, true];
      if (gap > LOWEST && gap * unit < this.low) [this.low, beyond] = [Math.max(gap / 2, LOWEST * 0.5) * unit, true];
    }
    if (impacts > this.most) [this.most, beyond] = [2 * impacts, true];
    return beyond;
  }

  /** @param {Diagram} diagram */
  toAxes({ low, high, level }) {
    const [least, largest] = this.low < this.high ? [this.low, this.high] : [0.01, 10];
    const words = axisWords(level);
    return {
      x: { low, high, label: words.frequency },
      gaps: { low: least, high: largest, log: true, label: words.gap },
      impacts: { low: 0.1, high: this.most, log: true, label: "impacts a period" },
    };
  }
}

/** @typedef {{x: Axis, gaps: Axis, impacts: Axis}} Axes */

/** Dots of a diagram, in pixels of the screen. */
export class DotPlate {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.dot = 1; // pixels high,
    this.broad = 1; // and wide: no gaps between frequencies that lie apart
    this.alpha = 1; // of a dot
  }

  /** @param {Size} size @param {number} density @param {Axes} axes @param {number} count of responses that will come */
  restart({ width, height }, density, axes, count) {
    Object.assign(this.canvas, { width: Math.round(width * density), height: Math.round(height * density) });
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.data = this.context.createImageData(this.canvas.width, this.canvas.height);
    const { gaps, impacts } = panelPlaces({ width, height });
    const [left, top, wide, high] = gaps.map((number) => number * density);
    this.bottom = top + high;
    this.strip = STRIP * density;
    this.px = axisToPixels(axes.x, left, left + wide);
    this.py = axisToPixels(axes.gaps, this.bottom - this.strip, top);
    this.ends = [left, left + wide];
    this.top = top;
    const [, below, , deep] = impacts.map((number) => number * density);
    this.counts = axisToPixels(axes.impacts, below + deep - this.strip, below);
    this.countsEnds = [below, below + deep];
    this.dot = Math.max(1, Math.round(density));
    this.broad = Math.max(this.dot, Math.min(6, Math.ceil((0.9 * wide) / Math.max(count, 1))));
    this.alpha = Math.min(0.6, Math.max(0.1, 0.6 * Math.sqrt(wide / Math.max(count, 1) / this.dot)));
  }

  /** @param {Diagram["points"][number]} point @param {Found} found @param {string} colour @param {number} unit of gaps on the axis */
  addResponse(point, found, colour, unit) {
    const { px, py, counts, bottom = 0, strip = 0, top = 0 } = this;
    if (!px || !py || !counts || !this.ends || !this.countsEnds) return;
    const x = Math.floor(px(point.eta) - (this.broad - 1) / 2);
    if (x < this.ends[0] || x > this.ends[1]) return;
    const rgb = rgbOf(colour);
    for (const gap of found.gaps) {
      const y = gap > LOWEST ? py(gap * unit) : bottom - strip / 2;
      if (y >= top && y <= bottom) this.addDot(x, Math.floor(y), rgb);
    }
    const y = found.impacts > 0.1 ? counts(found.impacts) : this.countsEnds[1] - strip / 2;
    if (y >= this.countsEnds[0]) for (let i = 0; i < 3; i++) this.addDot(x, Math.floor(y), rgb);
  }

  /** @param {number} x @param {number} y @param {[number, number, number]} rgb */
  addDot(x, y, [r, g, b]) {
    const { data } = /** @type {ImageData} */ (this.data);
    for (let dx = 0; dx < this.broad; dx++) {
      for (let dy = 0; dy < this.dot; dy++) {
        const place = 4 * ((y + dy) * this.canvas.width + x + dx);
        const old = data[place + 3] / 255;
        const share = this.alpha * (1 - old);
        const all = old + share;
        data[place] = (data[place] * old + r * share) / all;
        data[place + 1] = (data[place + 1] * old + g * share) / all;
        data[place + 2] = (data[place + 2] * old + b * share) / all;
        data[place + 3] = 255 * all;
      }
    }
  }

  /** Bring the dots onto the canvas. */
  toCanvas() {
    if (this.context && this.data) this.context.putImageData(this.data, 0, 0);
    return this.canvas;
  }
}

/** Colours of directions only where both are shown. @param {Theme} theme @param {Diagram} shown @param {"up" | "down"} direction */
export const laneColour = (theme, { lanes }, direction) => (lanes.length > 1 ? theme[direction] : theme.ink);

/** Frames of both panels. @param {Pen} pen @param {Size} size @param {Theme} theme @param {Axes} axes @param {number} unit of frequency ratios on the axis */
export function drawFrames(pen, size, theme, axes, unit) {
  const x = { ...axes.x, low: axes.x.low * unit, high: axes.x.high * unit };
  const { gaps, impacts } = panelPlaces(size);
  drawFrame(pen, drawZeroStrip(pen, gaps, theme), theme, { ...x, label: undefined }, axes.gaps);
  drawFrame(pen, drawZeroStrip(pen, impacts, theme), theme, x, axes.impacts, STRIP);
}

/** The strip of zero below a logarithmic axis; the place that is left above it. @param {Pen} pen @param {Place} place @param {Theme} theme @returns {Place} */
function drawZeroStrip(pen, [left, top, width, height], theme) {
  pen.box(left, top + height - STRIP, width, STRIP, { fill: theme.grid });
  pen.text(left - 6, top + height - STRIP + 13, "0", { anchor: "end", fill: theme.soft });
  return [left, top, width, height - STRIP];
}

/** Which colour is which direction, where there are both. @param {Pen} pen @param {Size} size @param {Theme} theme @param {Diagram} diagram */
function drawLaneLegend(pen, size, theme, { lanes }) {
  if (lanes.length < 2) return;
  const [left, top, width] = panelPlaces(size).gaps;
  lanes.forEach(({ direction }, i) =>
    pen.text(left + width - 100 * (1 - i), top - 10, `swept ${direction}`, { anchor: "end", fill: theme[direction] }),
  );
}

/** The chosen frequency, and the span that is being dragged. @param {Pen} pen @param {Size} size @param {Theme} theme @param {Axis} axis @param {{eta: number | null, drag: [number, number] | null}} marks */
export function drawMarks(pen, size, theme, axis, { eta, drag }) {
  const { gaps, impacts } = panelPlaces(size);
  const [left, top, width] = gaps;
  const bottom = impacts[1] + impacts[3];
  const px = axisToPixels(axis, left, left + width);
  if (drag) {
    const [from, to] = drag.map(px);
    pen.box(Math.min(from, to), top, Math.abs(to - from), bottom - top, { fill: theme.mark, alpha: 0.25 });
  }
  if (eta !== null && eta >= axis.low && eta <= axis.high) {
    pen.line([px(eta), px(eta)], [top, bottom], { stroke: theme.mark, width: 1.5, dash: [4, 3] });
  }
}

/** The diagram on the page: what has come is drawn with the frames, a few milliseconds each. */
export class DiagramView {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.plate = new DotPlate();
    /** @type {Diagram | null} */
    this.diagram = null;
    /** @type {Diagram | null} */
    this.below = null; // shown until the new one has come
    /** @type {[Diagram, "up" | "down", number][]} */
    this.queue = [];
    this.done = 0; // of the queue
    this.limits = new AxisLimits();
    this.stale = true;
    /** @type {{eta: number | null, drag: [number, number] | null}} */
    this.marks = { eta: null, drag: null };
    /** @type {((pen: Pen, size: Size, theme: Theme) => void) | null} */
    this.overlay = null;
    this.picture = new Picture(canvas, (pen, size, theme) => this.draw(pen, size, theme));
    new ResizeObserver(() => this.redrawAll()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redrawAll());
  }

  get axes() {
    return this.limits.toAxes(/** @type {Diagram} */ (this.diagram));
  }

  /** @param {Diagram} diagram @param {Diagram | null} below */
  showDiagram(diagram, below) {
    this.diagram = diagram;
    this.below = below;
    this.limits = new AxisLimits();
    for (const one of [below, diagram]) {
      for (const { found } of one?.lanes ?? []) {
        found.forEach((response, i) => {
          const eta = one?.points[i].eta ?? NaN;
          if (one && response && eta >= diagram.low && eta <= diagram.high) this.limits.include(response, gapUnit(one.points[i], diagram.level));
        });
      }
    }
    this.redrawAll();
  }

  /** Redraw everything. */
  redrawAll() {
    this.stale = true;
    this.picture.redraw();
  }

  /** A response has come. @param {"up" | "down"} direction @param {number} index @param {Found} found */
  addResponse(direction, index, found) {
    const diagram = /** @type {Diagram} */ (this.diagram);
    if (this.limits.include(found, gapUnit(diagram.points[index], diagram.level))) this.stale = true;
    this.queue.push([diagram, direction, index]);
    this.picture.redraw();
  }

  /** Only the diagram itself from now on: it is complete. */
  dropDiagramBelow() {
    if (this.below) this.redrawAll();
    this.below = null;
  }

  restartPlate() {
    this.stale = false;
    const { points, lanes } = /** @type {Diagram} */ (this.diagram);
    const count = points.length * lanes.length;
    this.plate.restart(this.picture.size, window.devicePixelRatio || 1, this.axes, count);
    this.queue = [];
    for (const one of [this.below, this.diagram]) {
      for (const lane of one?.lanes ?? []) {
        lane.found.forEach((found, i) => {
          if (found && one) this.queue.push([one, lane.direction, i]);
        });
      }
    }
    this.done = 0;
  }

  /** @param {Pen} pen @param {Size} size @param {Theme} theme */
  draw(pen, size, theme) {
    if (!this.diagram) return;
    if (this.stale) this.restartPlate();
    this.drawQueuedDots(theme, this.diagram);
    drawLaneLegend(pen, size, theme, this.diagram);
    drawFrames(pen, size, theme, this.axes, ratioUnit(this.diagram.structure, this.diagram.level));
    pen.image(this.plate.toCanvas(), 0, 0, size.width, size.height);
    this.overlay?.(pen, size, theme);
    drawMarks(pen, size, theme, this.axes.x, this.marks);
    if (this.queue.length > this.done) this.picture.redraw();
  }

  /** Put dots on the plate for some milliseconds. @param {Theme} theme @param {Diagram} shown */
  drawQueuedDots(theme, shown) {
    const end = performance.now() + 10;
    let done = this.done;
    while (done < this.queue.length && performance.now() < end) {
      const [diagram, direction, index] = this.queue[done++];
      const found = diagram.lanes.find((lane) => lane.direction === direction)?.found[index];
      const point = diagram.points[index];
      if (found) this.plate.addResponse(point, found, laneColour(theme, shown, direction), gapUnit(point, shown.level));
    }
    this.done = done;
    if (done === this.queue.length) [this.queue, this.done] = [[], 0];
  }

  /** Frequency at a place. @param {number} x in CSS pixels from the canvas's left side */
  etaAt(x) {
    const [left, , width] = panelPlaces(this.picture.size).gaps;
    const { low, high } = this.axes.x;
    return Math.min(Math.max(low + ((x - left) / width) * (high - low), low), high);
  }
}
