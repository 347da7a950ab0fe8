/** The motion at the chosen frequency in four pictures. */

import { axisAround, drawChart } from "./chart.js";
import { Picture } from "./picture.js";
import { shown } from "./scale.js";
import { lengthOf, omegaOf } from "./structure.js";

/**
 * @typedef {import("./motion.js").Motion} Motion
 * @typedef {import("./structure.js").Point} Point
 * @typedef {import("./chart.js").Series} Series
 * @typedef {import("./chart.js").Chart} Chart
 */

const GRAVITY = 9.80665; // m/s²
const WAIT = "click the orbit diagram";

/** @param {(id: string) => HTMLElement} at the page's elements */
export function motionPictures(at) {
  /** @type {Record<"history" | "phase" | "section" | "spectrum", Chart>} */
  const charts = { history: blank("time / T", "ξ"), phase: blank("ξ", "ξ′"), section: blank("gap ξ", "gap ξ′"), spectrum: blank("frequency / Ω", "amplitude, m/s²") };
  /** @param {keyof typeof charts} name */
  const picture = (name) =>
    new Picture(/** @type {HTMLCanvasElement} */ (at(name)), (pen, size, theme) =>
      drawChart(pen, size, theme, charts[name]),
    );
  const pictures = {
    history: picture("history"),
    phase: picture("phase"),
    section: picture("section"),
    spectrum: picture("spectrum"),
  };
  /** @param {keyof typeof charts} name @param {Chart} chart @param {string} words */
  const show = (name, chart, words) => {
    charts[name] = chart;
    pictures[name].describe(words);
    pictures[name].redraw();
  };
  return { pictures, show };
}

/** @param {string} x @param {string} y @returns {Chart} */
function blank(x, y) {
  return { x: { low: 0, high: 1, label: x }, y: { low: 0, high: 1, label: y }, series: [], empty: WAIT };
}

/** Columns of a motion over a eta^2, time in periods. @param {Motion} motion @param {Point} point */
export function columnsOf(motion, point) {
  const length = lengthOf(point);
  const speed = length * omegaOf(point.structure);
  /** @param {number} part @param {number} unit */
  const column = (part, unit) =>
    Float64Array.from({ length: motion.time.length }, (_, i) => motion.states[4 * i + part] / unit);
  return {
    turns: motion.time.map((time) => time / motion.period),
    x1: column(0, length),
    x2: column(1, length),
    v1: column(2, speed),
    v2: column(3, speed),
  };
}

/** Spans of permanent contact, in periods. @param {Motion} motion @param {ArrayLike<number>} turns */
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

/** Time histories with impacts and contact. @param {Motion} motion @param {Point} point @param {number} periods shown @returns {Chart} */
export function historyChart(motion, point, periods) {
  const { turns, x1, x2 } = columnsOf(motion, point);
  const [from, to] = [turns[0], Math.min(turns[0] + periods, turns[turns.length - 1])];
  const hits = Float64Array.from(motion.impactTime, (time) => time / motion.period);
  const places = motion.impactPlace.map((x) => x / lengthOf(point));
  return {
    x: { low: from, high: to, label: "time / T" },
    y: axisAround([x1, x2], "ξ₁, ξ₂"),
    spans: contactSpans(motion, turns),
    series: [
      { x: turns, y: x1, colour: "one", label: "mass 1" },
      { x: turns, y: x2, colour: "two", label: "mass 2" },
      { x: hits, y: places, colour: "hit", dots: 2.5, label: "impact" },
    ],
  };
}

/** Phase curves of both masses, as in the paper's Figure 12. @param {Motion} motion @param {Point} point @returns {Chart} */
export function phaseChart(motion, point) {
  const { x1, x2, v1, v2 } = columnsOf(motion, point);
  return {
    x: axisAround([x1, x2], "ξ"),
    y: axisAround([v1, v2], "ξ′"),
    series: [
      { x: x1, y: v1, colour: "one", label: "mass 1", width: 1 },
      { x: x2, y: v2, colour: "two", label: "mass 2", width: 1 },
    ],
  };
}

/** Stroboscopic section of gap and gap velocity. @param {ArrayLike<number>} states @param {Point} point @returns {Chart} */
export function sectionChart(states, point) {
  const length = lengthOf(point);
  const speed = length * omegaOf(point.structure);
  const count = states.length / 4;
  const x = Float64Array.from({ length: count }, (_, i) => (states[4 * i + 1] - states[4 * i]) / length);
  const y = Float64Array.from({ length: count }, (_, i) => (states[4 * i + 3] - states[4 * i + 2]) / speed);
  const dots = count > 2000 ? 0.8 : 1.8;
  return {
    x: axisAround([x], "gap ξ₂ − ξ₁"),
    y: axisAround([y], "gap velocity"),
    series: [{ x, y, colour: "hit", dots, alpha: 0.8 }],
  };
}

/** @param {{delaminated: import("./spectrum.js").Spectrum, bonded: import("./spectrum.js").Spectrum}} found @returns {Chart} */
export function spectrumChart({ delaminated, bonded }) {
  const high = Math.max(...delaminated.amplitude, ...bonded.amplitude) || 1;
  const low = high * 1e-7;
  /** @param {Float64Array} amplitude */
  const kept = (amplitude) => amplitude.map((value) => Math.max(value, low / 10));
  return {
    x: { low: 0, high: delaminated.order[delaminated.order.length - 1], label: "frequency / Ω" },
    y: { low, high: high * 2, log: true, label: "|a₁|, m/s²" },
    series: [
      { x: delaminated.order, y: kept(delaminated.amplitude), colour: "one", label: "delaminated", width: 1 },
      { x: bonded.order, y: kept(bonded.amplitude), colour: "hit", label: "bonded" },
    ],
  };
}

/** The same in Hz, mm and g, of a structure that is not the paper's of 1 rad/s. @param {import("./response.js").Response} response @param {Point} point @returns {Record<string, string>} */
function inUnits({ peak }, { structure, eta, frequency, amplitude }) {
  if (Math.abs(omegaOf(structure) - 1) < 1e-9) return {};
  return {
    "frequency, Hz": shown(frequency / (2 * Math.PI), 6),
    "amplitude of the box, mm": shown(1e3 * amplitude),
    "acceleration of the box, g": shown((amplitude * frequency * frequency) / GRAVITY),
    "largest gap, mm": shown(1e3 * peak * amplitude * eta * eta),
  };
}

/** Numbers of a response for people. @param {import("./response.js").Response} response @param {Point} point */
export function numbersOf(response, point) {
  return {
    "frequency ratio η": String(point.eta),
    "impacts per period": shown(response.impacts),
    multiplicity: response.multiplicity ? String(response.multiplicity) : "0 (does not repeat)",
    "largest gap ξ": shown(response.peak, 6),
    ...inUnits(response, point),
    "permanent contact": response.contact ? "yes" : "no",
  };
}
