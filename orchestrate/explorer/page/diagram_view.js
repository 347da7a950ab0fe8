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

/** Dots of a diagram, in pixels of the screen. */
export class DotPlate {
  /** @param {Size} size @param {number} density @param {DiagramView["axes"]} axes @param {number} count of responses that will come */
  constructor({ width, height }, density, axes, count) {
    const pixels = { width: Math.round(width * density), height: Math.round(height * density) };
    this.canvas = Object.assign(document.createElement("canvas"), pixels);
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.image = this.context.createImageData(pixels.width, pixels.height);
    const places = panelPlaces({ width, height });
    const [left, top, wide, high] = places.gaps.map((number) => number * density);
    const [, below, , deep] = places.impacts.map((number) => number * density);
    this.strip = STRIP * density;
    this.x = { ends: [left, left + wide], pixel: axisToPixels(axes.x, left, left + wide) };
    this.gaps = { ends: [top, top + high], pixel: axisToPixels(axes.gaps, top + high - this.strip, top) };
    this.impacts = { ends: [below, below + deep], pixel: axisToPixels(axes.impacts, below + deep - this.strip, below) };
    this.dot = Math.max(1, Math.round(density)); // pixels high,
    // and wide: no gaps between frequencies that lie apart
    this.broad = Math.max(this.dot, Math.min(6, Math.ceil((0.9 * wide) / Math.max(count, 1))));
    this.alpha = Math.min(0.6, Math.max(0.1, 0.6 * Math.sqrt(wide / Math.max(count, 1) / this.dot))); // of a dot
  }

  /** @param {Point} point @param {Found} found @param {string} colour @param {number} unit of gaps on the axis */
  addResponse(point, found, colour, unit) {
    const x = Math.floor(this.x.pixel(point.eta) - (this.broad - 1) / 2);
    if (x < this.x.ends[0] || x > this.x.ends[1]) return;
    const rgb = rgbOf(colour);
    const [top, bottom] = this.gaps.ends;
    for (const gap of found.gaps) {
      const y = gap > LOWEST ? this.gaps.pixel(gap * unit) : bottom - this.strip / 2;
      if (y >= top && y <= bottom) this.addDot(x, Math.floor(y), rgb);
    }
    const [least, most] = this.impacts.ends;
    const y = found.impacts > 0.1 ? this.impacts.pixel(found.impacts) : most - this.strip / 2;
    if (y >= least) for (let i = 0; i < 3; i++) this.addDot(x, Math.floor(y), rgb);
  }

  /** @param {number} x @param {number} y @param {[number, number, number]} rgb */
  addDot(x, y, [r, g, b]) {
    const { data } = this.image;
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
}

/** The strip of zero below a logarithmic axis; the place that is left above it. @param {Pen} pen @param {Place} place @param {Theme} theme @returns {Place} */
function drawZeroStrip(pen, [left, top, width, height], theme) {
  pen.box(left, top + height - STRIP, width, STRIP, { fill: theme.grid });
  pen.text(left - 6, top + height - STRIP + 13, "0", { anchor: "end", fill: theme.soft });
  return [left, top, width, height - STRIP];
}

/** The chosen frequency, and the span that is being dragged. @param {Pen} pen @param {Size} size @param {Theme} theme @param {Axis} axis @param {{eta: number | null, drag: [number, number] | null}} marks */
function drawMarks(pen, size, theme, axis, { eta, drag }) {
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
    this.plate = /** @type {DotPlate | null} */ (null);
    this.diagram = /** @type {Diagram | null} */ (null);
    this.below = /** @type {Diagram | null} */ (null); // shown until the new one has come
    this.queue = /** @type {[Diagram, Lane, Found][]} */ ([]);
    this.done = 0; // of the queue
    this.limits = new AxisLimits();
    this.stale = true;
    /** @type {{eta: number | null, drag: [number, number] | null}} */
    this.marks = { eta: null, drag: null };
    this.overlay = /** @type {((pen: Pen, size: Size, theme: Theme) => void) | null} */ (null);
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
    for (const [{ points }, , found] of this.knownResponses()) {
      const point = points[found.index];
      if (point.eta >= diagram.low && point.eta <= diagram.high) this.limits.include(found, gapUnit(point, diagram.level));
    }
    this.redrawAll();
  }

  /** What has come of both diagrams. @returns {Generator<[Diagram, Lane, Found]>} */
  *knownResponses() {
    for (const diagram of [this.below, this.diagram]) {
      for (const lane of diagram?.lanes ?? []) for (const found of lane.found) if (found && diagram) yield [diagram, lane, found];
    }
  }

  /** Redraw everything. */
  redrawAll() {
    this.stale = true;
    this.picture.redraw();
  }

  /** A response has come. @param {Lane} lane @param {Found} found */
  addResponse(lane, found) {
    const diagram = /** @type {Diagram} */ (this.diagram);
    if (this.limits.include(found, gapUnit(diagram.points[found.index], diagram.level))) this.stale = true;
    this.queue.push([diagram, lane, found]);
    this.picture.redraw();
  }

  /** Only the diagram itself from now on: it is complete. */
  dropDiagramBelow() {
    if (this.below) this.redrawAll();
    this.below = null;
  }

  /** @param {Pen} pen @param {Size} size @param {Theme} theme */
  draw(pen, size, theme) {
    if (!this.diagram) return;
    if (this.stale || !this.plate) {
      this.stale = false;
      const count = this.diagram.points.length * this.diagram.lanes.length;
      this.plate = new DotPlate(size, window.devicePixelRatio || 1, this.axes, count);
      [this.queue, this.done] = [[...this.knownResponses()], 0];
    }
    this.drawQueuedDots(this.plate, theme, this.diagram);
    const { structure, level, lanes } = this.diagram;
    const { gaps, impacts } = panelPlaces(size);
    const [left, top, width] = gaps;
    if (lanes.length > 1) {
      lanes.forEach(({ direction }, i) =>
        pen.text(left + width - 100 * (1 - i), top - 10, `swept ${direction}`, { anchor: "end", fill: theme[direction] }),
      );
    }
    const { axes } = this;
    const unit = ratioUnit(structure, level);
    const x = { ...axes.x, low: axes.x.low * unit, high: axes.x.high * unit };
    drawFrame(pen, drawZeroStrip(pen, gaps, theme), theme, { ...x, label: undefined }, axes.gaps);
    drawFrame(pen, drawZeroStrip(pen, impacts, theme), theme, x, axes.impacts, STRIP);
    this.plate.context.putImageData(this.plate.image, 0, 0);
    pen.image(this.plate.canvas, 0, 0, size.width, size.height);
    this.overlay?.(pen, size, theme);
    drawMarks(pen, size, theme, this.axes.x, this.marks);
    if (this.queue.length > this.done) this.picture.redraw();
  }

  /** Put dots on the plate for some milliseconds. @param {DotPlate} plate @param {Theme} theme @param {Diagram} shown */
  drawQueuedDots(plate, theme, shown) {
    const end = performance.now() + 10;
    while (this.done < this.queue.length && performance.now() < end) {
      const [diagram, { direction }, found] = this.queue[this.done++];
      const point = diagram.points[found.index];
      // colours of directions only where both are shown
      const colour = shown.lanes.length > 1 ? theme[direction] : theme.ink;
      plate.addResponse(point, found, colour, gapUnit(point, shown.level));
    }
    if (this.done === this.queue.length) [this.queue, this.done] = [[], 0];
  }

  /** Frequency at a place. @param {number} x in CSS pixels from the canvas's left side */
  etaAt(x) {
    const [left, , width] = panelPlaces(this.picture.size).gaps;
    const { low, high } = this.axes.x;
    return Math.min(Math.max(low + ((x - left) / width) * (high - low), low), high);
  }
}
