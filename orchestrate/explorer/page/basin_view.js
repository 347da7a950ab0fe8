/** The basin of attraction as a picture that fills in, coarse first; a click starts there. */

import { addOrFindAttractor, findAttractor, SETTLING, startOfCell } from "./basin.js";
import { drawFrame, plottingArea } from "./chart.js";
import { isInHertz, PAPER } from "./excitation.js";
import { Picture } from "./picture.js";
import { averageWords, meanImpactCountWords, repeatWords } from "./response_words.js";
import { repeatPeriods } from "./response.js";
import { omegaOf } from "./structure.js";
import { rgbOf } from "./theme.js";
import { gapUnit, axisWords } from "./units.js";

const COLOURS = ["#5b8ff9", "#e8a33d", "#5ad8a6", "#d9468f", "#9270ca", "#7a7a7a"];

/** Cells of a square, coarse ones first. @param {number} side @returns {[number, number][]} */
export function cellsCoarseFirst(side) {
  /** @type {[number, number][]} */
  const cells = [];
  for (let step = 8; step >= 1; step /= 2) {
    for (let row = 0; row < side; row += step) {
      for (let column = 0; column < side; column += step) {
        const before = step < 8 && row % (2 * step) === 0 && column % (2 * step) === 0;
        if (!before) cells.push([column, row]);
      }
    }
  }
  return cells;
}

export class BasinView {
  /** @param {HTMLCanvasElement} canvas @param {number} alike distance within which two motions are one @param {(start: number[]) => void} choose */
  constructor(canvas, alike, choose) {
    this.alike = alike;
    this.plane = /** @type {Plane | null} */ (null);
    this.point = /** @type {Point | null} */ (null);
    this.level = PAPER;
    this.attractors = /** @type {Attractor[]} */ ([]);
    this.examples = /** @type {[number, number][]} */ ([]); // a cell of each
    this.labels = new Int16Array(0);
    this.cells = document.createElement("canvas");
    this.picture = new Picture(canvas, (pen, size, theme) => this.draw(pen, size, theme));
    /** @type {[number, number] | null} */
    this.cursor = null;
    /** @param {[number, number] | null} cell */
    const start = (cell) => {
      if (cell && this.plane && this.point) choose(startOfCell(this.point, this.plane, ...cell));
    };
    canvas.addEventListener("click", (event) => {
      this.cursor = this.cellAt(event.offsetX, event.offsetY);
      start(this.cursor);
    });
    /** @type {Record<string, [number, number]>} */
    const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "Enter") start(this.cursor);
      else if (ways[event.key] && this.plane) {
        const { side } = this.plane;
        const from = this.cursor ?? [side / 2, side / 2];
        const [column, row] = ways[event.key].map((way, i) => Math.min(Math.max(from[i] + way, 0), side - 1));
        this.cursor = [column, row];
        this.picture.redraw();
      } else return;
      event.preventDefault();
    });
  }

  /** Nothing to show. */
  clearMap() {
    Object.assign(this, { plane: null, cursor: null, attractors: [], examples: [] });
    this.picture.redraw();
  }

  /** @param {Point} point @param {Plane} plane @param {Level} level */
  startMap(point, plane, level) {
    this.level = level;
    Object.assign(this, { point, plane, attractors: [], examples: [] });
    this.labels = new Int16Array(plane.side * plane.side).fill(-1);
    Object.assign(this.cells, { width: plane.side, height: plane.side });
    this.picture.redraw();
  }

  /** @param {{column: number, row: number} & Attractor} part */
  addCell({ column, row, ...found }) {
    if (!this.plane) return;
    const number = addOrFindAttractor(this.attractors, found, this.alike);
    this.labels[row * this.plane.side + column] = number;
    this.examples[number] ??= [column, row];
    this.picture.redraw();
  }

  /** What was found in words, and a start that leads to each. @param {Attractor | null} shown the motion on the page */
  attractorWords(shown) {
    const { point, plane } = this;
    if (!point || !plane) return [];
    const total = this.labels.reduce((sum, one) => sum + (one >= 0 ? 1 : 0), 0) || 1;
    const now = shown ? findAttractor(this.attractors, shown, this.alike) : -1;
    return this.attractors.map((one, number) => {
      const { impacts } = one;
      const periods = repeatPeriods(one);
      const share = this.labels.reduce((sum, one) => sum + (one === number ? 1 : 0), 0) / total;
      const kind = periods ? `repeats after ${repeatWords(one)}` : repeatWords(one);
      const worth = periods ? "" : ` (${averageWords(SETTLING.samples)})`;
      const text = `${kind}, ${meanImpactCountWords(impacts, periods)}${worth}: ${(100 * share).toFixed(1)} % of starts`;
      return { colour: attractorColour(number), text, now: number === now, start: startOfCell(point, plane, ...this.examples[number]) };
    });
  }

  /** @param {number} x @param {number} y @returns {[number, number] | null} */
  cellAt(x, y) {
    if (!this.plane) return null;
    const [left, top, width, height] = plottingArea(this.picture.size);
    const column = Math.floor(((x - left) / width) * this.plane.side);
    const row = Math.floor((1 - (y - top) / height) * this.plane.side);
    const inside = [column, row].every((index) => index >= 0 && index < (this.plane?.side ?? 0));
    return inside ? [column, row] : null;
  }

  /** @param {Pen} pen @param {Size} size @param {Theme} theme */
  draw(pen, size, theme) {
    const place = plottingArea(size);
    const { plane } = this;
    if (!plane || !this.point) return;
    this.paintCells(plane.side);
    pen.image(this.cells, ...place);
    if (this.cursor) {
      const [left, top, width, height] = place;
      const [cell, tall] = [width / plane.side, height / plane.side];
      const [column, row] = this.cursor;
      const corner = [left + column * cell, top + height - (row + 1) * tall];
      pen.box(corner[0] - 2, corner[1] - 2, cell + 4, tall + 4, { stroke: theme.ink, width: 2 });
    }
    const [words, unit] = [axisWords(this.level), gapUnit(this.point, this.level)];
    const speed = plane.speed * unit * (isInHertz(this.level) ? omegaOf(this.point.structure) : 1);
    const x = { low: 0, high: plane.gap * unit, label: `${words.gap}, at the start` };
    drawFrame(pen, place, { ...theme, grid: "transparent" }, x, { low: -speed, high: speed, label: words.gapSpeed });
  }

  /** Cells that are still to come have the colour of the coarser cell they lie in. @param {number} side */
  paintCells(side) {
    const context = /** @type {CanvasRenderingContext2D} */ (this.cells.getContext("2d"));
    const image = context.createImageData(side, side);
    for (let row = 0; row < side; row++) {
      for (let column = 0; column < side; column++) {
        const found = this.coarserLabel(column, row, side);
        if (found < 0) continue;
        const place = 4 * ((side - 1 - row) * side + column);
        image.data.set([...rgbOf(attractorColour(found)), 255], place);
      }
    }
    context.putImageData(image, 0, 0);
  }

  /** @param {number} column @param {number} row @param {number} side */
  coarserLabel(column, row, side) {
    for (let step = 1; step <= 8; step *= 2) {
      const found = this.labels[(row - (row % step)) * side + column - (column % step)];
      if (found >= 0) return found;
    }
    return -1;
  }
}

/** @param {number} number */
function attractorColour(number) {
  return COLOURS[Math.min(number, COLOURS.length - 1)];
}
