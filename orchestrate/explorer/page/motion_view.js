/** The motion at the chosen frequency in four pictures, and in words. */

import { axisAround, drawChart } from "./chart.js";
import { hertzOf, isInHertz } from "./excitation.js";
import { gapsOf, traitsOf } from "./model.js";
import { Picture } from "./picture.js";
import { axisScale, axisWords } from "./units.js";

/** @typedef {"history" | "phase" | "section" | "spectrum"} Name */

const FEW = 24; // places of a section that are drawn as larger dots

/** @param {(id: string) => HTMLElement} at the page's elements */
export function motionPictures(at) {
  /** @type {Partial<Record<Name, Chart>>} */
  const charts = {};
  /** @param {Name} name */
  const picture = (name) =>
    new Picture(/** @type {HTMLCanvasElement} */ (at(name)), (pen, size, theme) => {
      const chart = charts[name];
      if (chart) drawChart(pen, size, theme, chart);
    });
  const pictures = { history: picture("history"), phase: picture("phase"), section: picture("section"), spectrum: picture("spectrum") };
  /** @param {Name} name @param {Chart} chart @param {string} words */
  const show = (name, chart, words) => {
    charts[name] = chart;
    pictures[name].describe(words);
    pictures[name].redraw();
  };
  return { charts, pictures, show };
}

/** Columns of a motion as the axes have them: time from its beginning, displacements from rest, where pressed halves touch. @param {Motion} motion @param {Point} point @param {Level} level */
export function shownColumns(motion, point, level) {
  const { length, speed, time } = axisScale(point, level);
  const { rest_1, rest_2 } = traitsOf(point);
  const rest = [rest_1, rest_2, 0, 0];
  /** @param {number} part @param {number} unit */
  const column = (part, unit) =>
    Float64Array.from({ length: motion.time.length }, (_, i) => (motion.states[4 * i + part] - rest[part]) / unit);
  return {
    turns: motion.time.map((t) => (t - motion.time[0]) / time),
    x1: column(0, length),
    x2: column(1, length),
    v1: column(2, speed),
    v2: column(3, speed),
  };
}

/** Spans of permanent contact. @param {Motion} motion @param {ArrayLike<number>} turns */
export function contactSpans({ contact }, turns) {
  /** @type {[number, number][]} */
  const spans = [];
  let from = -1;
  for (let i = 0; i <= contact.length; i++) {
    if (contact[i] && from < 0) from = i;
    if (!contact[i] && from >= 0) {
      spans.push([turns[from], turns[Math.min(i, contact.length - 1)]]);
      from = -1;
    }
  }
  return spans;
}

/** What a displacement is counted from is said where it is not the springs' own length. @param {Point} point @param {Level} level */
function displacementLabel(point, level) {
  const { place } = axisWords(level);
  return traitsOf(point).gap_offset < 0 ? place.replace("displacement", "displacement from rest") : place;
}

/** What half 1 strikes. @param {Point} point */
export const secondName = ({ structure }) => (structure.wall ? "wall" : "half 2");

/** Time histories with impacts and contact. @param {Motion} motion @param {Point} point @param {Level} level @returns {Chart} */
export function historyChart(motion, point, level) {
  const { turns, x1, x2 } = shownColumns(motion, point, level);
  const { length, time } = axisScale(point, level);
  const words = axisWords(level);
  const { rest_1 } = traitsOf(point);
  const hits = motion.impactTime.map((t) => (t - motion.time[0]) / time);
  return {
    x: { low: 0, high: turns[turns.length - 1], label: words.time },
    y: axisAround([x1, x2], displacementLabel(point, level)),
    spans: contactSpans(motion, turns),
    series: [
      { x: turns, y: x1, colour: "one", label: "half 1" },
      { x: turns, y: x2, colour: "two", label: secondName(point) },
      { x: hits, y: motion.impactPlace.map((x) => (x - rest_1) / length), colour: "hit", dots: 2.5, label: "impact" },
    ],
  };
}

/** Phase curves of both masses, as in the paper's Figure 12. @param {Motion} motion @param {Point} point @param {Level} level @returns {Chart} */
export function phaseChart(motion, point, level) {
  const { x1, x2, v1, v2 } = shownColumns(motion, point, level);
  const words = axisWords(level);
  return {
    x: axisAround([x1, x2], displacementLabel(point, level)),
    y: axisAround([v1, v2], words.speed),
    series: [
      { x: x1, y: v1, colour: "one", label: "half 1", width: 1 },
      { x: x2, y: v2, colour: "two", label: secondName(point), width: 1 },
    ],
  };
}

/** In which of 200 equal parts of an axis a value lies. @param {number} value @param {Axis} axis */
const cellIndex = (value, { low, high }) => Math.round((200 * (value - low)) / (high - low));

/** Stroboscopic section of gap and gap velocity. @param {ArrayLike<number>} states @param {Point} point @param {Level} level @returns {Chart} */
export function sectionChart(states, point, level) {
  const { length, speed } = axisScale(point, level);
  const words = axisWords(level);
  const count = states.length / 4;
  const x = gapsOf(states, point).map((gap) => gap / length);
  const y = Float64Array.from({ length: count }, (_, i) => (states[4 * i + 3] - states[4 * i + 2]) / speed);
  const axes = { x: axisAround([x], words.gap), y: axisAround([y], words.gapSpeed) };
  const places = new Set(x.map((value, i) => 1000 * cellIndex(value, axes.x) + cellIndex(y[i], axes.y)));
  const dots = places.size <= FEW ? 5 : count > 2000 ? 0.8 : 1.8;
  return { ...axes, series: [{ x, y, colour: "ink", dots, alpha: 0.8 }] };
}

/** @param {{delaminated: Spectrum, bonded: Spectrum | null}} found @param {Point} point @param {Level} level @param {Measured | null} record @returns {Chart} */
export function spectrumChart({ delaminated, bonded }, point, level, record) {
  const { line, acceleration } = axisScale(point, level);
  const words = axisWords(level);
  const measured = record && isInHertz(level) ? measuredSeries(record, hertzOf(point.eta, point.structure)) : null;
  const heights = [delaminated.amplitude, bonded?.amplitude ?? new Float64Array(0), Float64Array.from(measured?.y ?? [])];
  const ends = heights.map((amplitude) => amplitude.reduce((most, value) => Math.max(most, value), 0));
  const high = Math.max(...ends) / acceleration || 1;
  const low = high * 1e-7;
  /** @param {Float64Array} amplitude */
  const kept = (amplitude) => amplitude.map((value) => Math.max(value / acceleration, low / 10));
  const x = delaminated.order.map((order) => order * line);
  /** @type {Series[]} */
  const series = [
    { x, y: kept(heights[0]), colour: "one", label: bonded ? "delaminated" : "half 1", width: 1 },
  ];
  if (bonded) series.push({ x, y: kept(heights[1]), colour: "two", label: "undamaged" });
  if (measured) series.push({ x: measured.x.map((order) => order * line), y: kept(heights[2]), colour: "ink", label: "measured", dots: measured.dots });
  return {
    x: { low: 0, high: x[x.length - 1], label: words.line },
    y: { low, high: high * 2, log: true, label: words.acceleration },
    series,
  };
}

/** What is measured at a frequency: orders of a swept sine, or a spectrum, over the excitation's frequency. @param {Measured} record @param {number} hertz @returns {{x: number[], y: number[], dots?: number} | null} nothing beside the sweep */
function measuredSeries({ orders, lines }, hertz) {
  if (lines) return { x: lines.frequency.map((value) => value / hertz), y: lines.amplitude };
  const { frequency, amplitude } = /** @type {NonNullable<Measured["orders"]>} */ (orders);
  if (hertz < frequency[0] || hertz > frequency[frequency.length - 1]) return null;
  const after = frequency.findIndex((value) => value >= hertz);
  const near = after > 0 && hertz - frequency[after - 1] < frequency[after] - hertz ? after - 1 : after;
  return { x: amplitude.map((_, i) => i + 1), y: amplitude.map((row) => row[near]), dots: 4 };
}
