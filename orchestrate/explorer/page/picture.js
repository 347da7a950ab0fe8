/** A picture on the page: a canvas, sharp on every screen, that can be saved as PNG or SVG. */

import { save } from "./files.js";
import { CanvasPen, SvgPen } from "./pen.js";
import { themeOf } from "./theme.js";

/**
 * @typedef {import("./pen.js").Pen} Pen
 * @typedef {import("./theme.js").Theme} Theme
 * @typedef {{width: number, height: number}} Size
 * @typedef {(pen: Pen, size: Size, theme: Theme) => void} Draw
 */

export class Picture {
  /** @param {HTMLCanvasElement} canvas @param {Draw} draw */
  constructor(canvas, draw) {
    this.canvas = canvas;
    this.draw = draw;
    this.asked = false;
    new ResizeObserver(() => this.redraw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
  }

  /** @returns {Size} in CSS pixels */
  get size() {
    return { width: this.canvas.clientWidth, height: this.canvas.clientHeight };
  }

  /** Draw with the next frame, however often it is asked for before. */
  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.paint();
    });
  }

  paint() {
    const { width, height } = this.size;
    if (!width || !height) return;
    const density = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(width * density), Math.round(height * density)];
    if (this.canvas.width !== w || this.canvas.height !== h) {
      Object.assign(this.canvas, { width: w, height: h });
    }
    const context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    context.setTransform(density, 0, 0, density, 0, 0);
    context.clearRect(0, 0, width, height);
    this.draw(new CanvasPen(context), { width, height }, themeOf());
  }

  /** Say in words what the picture shows. @param {string} words */
  describe(words) {
    this.canvas.setAttribute("aria-label", words);
  }

  /** @param {string} name of the file */
  savePng(name) {
    this.canvas.toBlob((blob) => blob && save(`${name}.png`, blob));
  }

  /** @param {string} name of the file */
  saveSvg(name) {
    const { width, height } = this.size;
    const theme = themeOf();
    const pen = new SvgPen(width, height, theme.paper);
    this.draw(pen, { width, height }, theme);
    save(`${name}.svg`, new Blob([pen.finished()], { type: "image/svg+xml" }));
  }
}
