/** Line charts: a frame with ticks, lines, dots, and shaded spans. */

import { axisToPixels, formatNumber, tickText, axisTicks } from "./scale.js";

const CONTACT = "stuck together"; // what the spans are
const MARGIN = { left: 72, right: 18, top: 20, bottom: 38 };

/** The plotting area of a picture. @param {Size} size @returns {Place} */
export function plottingArea({ width, height }) {
  const { left, right, top, bottom } = MARGIN;
  return [left, top, Math.max(width - left - right, 10), Math.max(height - top - bottom, 10)];
}

/** @param {Pen} pen @param {Size} size @param {Theme} theme @param {Chart} chart */
export function drawChart(pen, size, theme, chart) {
  const place = plottingArea(size);
  const [left, top, width, height] = place;
  const px = axisToPixels(chart.x, left, left + width);
  const py = axisToPixels(chart.y, top + height, top);
  for (const [from, to] of chart.spans ?? []) {
    pen.box(px(from), top, Math.max(px(to) - px(from), 0.5), height, { fill: theme.contact });
  }
  drawFrame(pen, place, theme, chart.x, chart.y);
  pen.drawClipped(place, () => {
    for (const { x, y, colour, dots, alpha, width = 1.3 } of chart.series) {
      const [xs, ys] = [Float64Array.from(x, px), Float64Array.from(y, py)];
      if (dots) pen.dots(xs, ys, dots, { fill: theme[colour], alpha });
      else pen.line(xs, ys, { stroke: theme[colour], width, alpha });
    }
  });
  let end = left + width; // of what is written above, from right to left
  if (chart.spans?.length) {
    pen.text(end, top - 10, CONTACT, { anchor: "end", fill: theme.ink });
    end -= 6.3 * CONTACT.length + 18;
    pen.box(end, top - 16, 12, 12, { fill: theme.contact, stroke: theme.soft });
    end -= 10;
  }
  for (const { label, colour } of [...chart.series].reverse()) {
    if (!label) continue;
    pen.text(end, top - 10, label, { anchor: "end", fill: theme[colour] });
    end -= 16 + 7.5 * label.length;
  }
}

/**
 * Frame, grid, ticks and labels; the ticks of x stand `strip` pixels lower.
 * @param {Pen} pen
 * @param {Place} place
 * @param {Theme} theme
 * @param {Axis} x
 * @param {Axis} y
 * @param {number} [strip]
 */
export function drawFrame(pen, [left, top, width, height], theme, x, y, strip = 0) {
  const px = axisToPixels(x, left, left + width);
  const py = axisToPixels(y, top + height, top);
  const [right, bottom] = [left + width, top + height];
  for (const tick of axisTicks(x, width / 64)) {
    pen.line([px(tick), px(tick)], [top, bottom], { stroke: theme.grid });
    if (x.label !== undefined) pen.text(px(tick), bottom + strip + 12, formatNumber(tick, 6), { fill: theme.soft });
  }
  for (const tick of axisTicks(y, height / (y.log ? 24 : 30))) {
    pen.line([left, right], [py(tick), py(tick)], { stroke: theme.grid });
    pen.text(left - 6, py(tick), tickText(tick, y), { anchor: "end", fill: theme.soft });
  }
  pen.box(left, top, width, height, { stroke: theme.soft });
  if (x.label) pen.text(left + width / 2, bottom + strip + 28, x.label, { fill: theme.ink });
  if (y.label) pen.text(8, top + height / 2, y.label, { turn: true, fill: theme.ink });
}

/** An axis around values, with some room. @param {ArrayLike<number>[]} columns @param {string} label @returns {Axis} */
export function axisAround(columns, label) {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) {
    for (let i = 0; i < column.length; i++) {
      if (column[i] < low) low = column[i];
      if (column[i] > high) high = column[i];
    }
  }
  if (!(low <= high)) [low, high] = [-1, 1];
  const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high)); // a point, but for rounding
  const room = high - low > least ? 0.05 * (high - low) : 1e4 * least || 1;
  return { low: low - room, high: high + room, label };
}
