/** Two pens with the same strokes: one draws on a canvas, one writes SVG. */

const FONT = "system-ui, sans-serif";

export class CanvasPen {
  /** @param {CanvasRenderingContext2D} context */
  constructor(context) {
    this.context = context;
  }

  /** @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys @param {Style} style */
  line(xs, ys, { stroke = "", width = 1, dash = [], alpha = 1 }) {
    const { context } = this;
    context.beginPath();
    for (let i = 0, down = false; i < xs.length; i++) {
      if (down) context.lineTo(xs[i], ys[i]);
      else context.moveTo(xs[i], ys[i]);
      down = ys[i] === ys[i];
    }
    Object.assign(context, { strokeStyle: stroke, lineWidth: width, globalAlpha: alpha });
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  /** @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys @param {number} radius @param {Style} style */
  dots(xs, ys, radius, { fill = "", alpha = 1 }) {
    const { context } = this;
    Object.assign(context, { fillStyle: fill, globalAlpha: alpha });
    context.beginPath();
    for (let i = 0; i < xs.length; i++) {
      if (radius < 1) {
        context.fillRect(xs[i] - radius, ys[i] - radius, 2 * radius, 2 * radius);
        continue;
      }
      context.moveTo(xs[i] + radius, ys[i]);
      context.arc(xs[i], ys[i], radius, 0, 7);
    }
    context.fill();
    context.globalAlpha = 1;
  }

  /** @param {number} x @param {number} y @param {number} w @param {number} h @param {Style} style */
  box(x, y, w, h, { stroke, fill, width = 1, alpha = 1 }) {
    const { context } = this;
    context.globalAlpha = alpha;
    if (fill) {
      context.fillStyle = fill;
      context.fillRect(x, y, w, h);
    }
    if (stroke) {
      Object.assign(context, { strokeStyle: stroke, lineWidth: width });
      context.strokeRect(x, y, w, h);
    }
    context.globalAlpha = 1;
  }

  /** @param {number} x @param {number} y @param {string} words @param {Lettering} style */
  text(x, y, words, { anchor = "middle", turn = false, size = 12, fill = "" }) {
    const { context } = this;
    context.save();
    context.translate(x, y);
    if (turn) context.rotate(-Math.PI / 2);
    context.font = `${size}px ${FONT}`;
    context.fillStyle = fill;
    context.textAlign = anchor === "middle" ? "center" : anchor;
    context.textBaseline = "middle";
    context.fillText(words, 0, 0);
    context.restore();
  }

  /** @param {HTMLCanvasElement} picture @param {number} x @param {number} y @param {number} w @param {number} h */
  image(picture, x, y, w, h) {
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(picture, x, y, w, h);
  }

  /** Keep what `strokes` draws inside a rectangle. @param {number[]} place @param {() => void} strokes */
  drawClipped([x, y, w, h], strokes) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, w, h);
    this.context.clip();
    strokes();
    this.context.restore();
  }
}

export class SvgPen {
  /** @param {number} width @param {number} height @param {string} paper */
  constructor(width, height, paper) {
    this.clips = 0;
    /** @type {string[]} */
    this.parts = [
      `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" ` +
        `width="${width}" height="${height}"><rect width="100%" height="100%" fill="${paper}"/>`,
    ];
  }

  /** @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys @param {Style} style */
  line(xs, ys, { stroke = "", width = 1, dash = [], alpha = 1 }) {
    let path = "";
    for (let i = 0, down = false; i < xs.length; i++) {
      if (xs[i] === xs[i] && ys[i] === ys[i]) path += `${down ? "L" : "M"}${shortNumber(xs[i])} ${shortNumber(ys[i])}`;
      down = ys[i] === ys[i];
    }
    const dashes = dash.length ? ` stroke-dasharray="${dash}"` : "";
    this.parts.push(
      `<path d="${path}" fill="none" stroke="${stroke}" stroke-width="${width}"${dashes} opacity="${alpha}"/>`,
    );
  }

  /** @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys @param {number} radius @param {Style} style */
  dots(xs, ys, radius, { fill = "", alpha = 1 }) {
    let path = "";
    for (let i = 0; i < xs.length; i++) path += `M${shortNumber(xs[i])} ${shortNumber(ys[i])}h0`;
    const round = `stroke="${fill}" stroke-width="${2 * radius}" stroke-linecap="round"`;
    this.parts.push(`<path d="${path}" ${round} opacity="${alpha}"/>`);
  }

  /** @param {number} x @param {number} y @param {number} w @param {number} h @param {Style} style */
  box(x, y, w, h, { stroke = "none", fill = "none", width = 1, alpha = 1 }) {
    const place = `x="${shortNumber(x)}" y="${shortNumber(y)}" width="${shortNumber(w)}" height="${shortNumber(h)}"`;
    const look = `stroke="${stroke}" fill="${fill}" stroke-width="${width}" opacity="${alpha}"`;
    this.parts.push(`<rect ${place} ${look}/>`);
  }

  /** @param {number} x @param {number} y @param {string} words @param {Lettering} style */
  text(x, y, words, { anchor = "middle", turn = false, size = 12, fill = "" }) {
    const place = `translate(${shortNumber(x)} ${shortNumber(y)})${turn ? " rotate(-90)" : ""}`;
    const look = `font-family="${FONT}" font-size="${size}" fill="${fill}" text-anchor="${anchor}"`;
    const safe = words.replace(/&/g, "&amp;").replace(/</g, "&lt;");
    this.parts.push(`<text transform="${place}" dy="0.35em" ${look}>${safe}</text>`);
  }

  /** @param {HTMLCanvasElement} picture @param {number} x @param {number} y @param {number} w @param {number} h */
  image(picture, x, y, w, h) {
    const place = `x="${x}" y="${y}" width="${w}" height="${h}" preserveAspectRatio="none"`;
    this.parts.push(`<image ${place} href="${picture.toDataURL("image/png")}"/>`);
  }

  /** Keep what `strokes` draws inside a rectangle. @param {number[]} place @param {() => void} strokes */
  drawClipped([x, y, w, h], strokes) {
    const id = `inside${++this.clips}`;
    this.parts.push(
      `<clipPath id="${id}"><rect x="${x}" y="${y}" width="${w}" height="${h}"/></clipPath>`,
      `<g clip-path="url(#${id})">`,
    );
    strokes();
    this.parts.push("</g>");
  }

  toSvg() {
    return `${this.parts.join("\n")}\n</svg>\n`;
  }
}

/** @param {number} value */
function shortNumber(value) {
  return Number(value.toFixed(2));
}
