/** A picture on the page: a canvas, sharp on every screen, that can be saved as PNG or SVG. */

import { saveFile } from "./files.js";
import { drawCaption, captionHeight, wrapLines } from "./caption.js";
import { CanvasPen, SvgPen } from "./pen.js";
import { currentTheme } from "./theme.js";

const FINE = 2; // pixels of a saved picture, at the least, for one of the page's

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
      this.drawNow();
    });
  }

  drawNow() {
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
    this.draw(new CanvasPen(context), { width, height }, currentTheme());
  }

  /** Say in words what the picture shows. @param {string} words */
  describe(words) {
    this.canvas.setAttribute("aria-label", words);
  }

  /** As it is on the screen, on paper, twice as fine where that is coarse, with lines below. @param {string} name of the file @param {string[]} caption */
  savePng(name, caption) {
    const density = Math.max(FINE, window.devicePixelRatio || 1);
    const sheet = document.createElement("canvas");
    this.drawWithCaption(caption, (width, height, { paper }) => {
      Object.assign(sheet, { width: Math.round(width * density), height: Math.round(height * density) });
      const context = /** @type {CanvasRenderingContext2D} */ (sheet.getContext("2d"));
      context.fillStyle = paper;
      context.fillRect(0, 0, sheet.width, sheet.height);
      context.setTransform(density, 0, 0, density, 0, 0);
      return new CanvasPen(context);
    });
    sheet.toBlob((blob) => blob && saveFile(`${name}.png`, blob));
  }

  /** @param {string} name of the file @param {string[]} caption */
  saveSvg(name, caption) {
    const pen = this.drawWithCaption(caption, (width, height, { paper }) => new SvgPen(width, height, paper));
    saveFile(`${name}.svg`, new Blob([pen.toSvg()], { type: "image/svg+xml" }));
  }

  /** Draw on a sheet of another pen, with lines below. @template {Pen} T @param {string[]} caption @param {(width: number, height: number, theme: Theme) => T} penOf a sheet */
  drawWithCaption(caption, penOf) {
    const { size } = this;
    const lines = wrapLines(caption, size.width);
    const theme = currentTheme();
    const pen = penOf(size.width, size.height + captionHeight(lines), theme);
    this.draw(pen, size, theme);
    drawCaption(pen, lines, size.height, theme);
    return pen;
  }
}
