/** In which units a motion is shown: the paper's, or Hz, mm, g and seconds. */

import { GRAVITY, hertzOf, inHertz } from "./excitation.js";
import { lengthOf, omegaOf, periodOf } from "./structure.js";

/**
 * @typedef {import("./excitation.js").Level} Level
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {import("./structure.js").Point} Point
 * @typedef {{length: number, speed: number, time: number, line: number, acceleration: number}} Scale
 *   what is one on the axes, in m, m/s, s and m/s²; `line`: what the excitation's frequency is there
 * @typedef {{frequency: string, gap: string, gapSpeed: string, place: string, speed: string,
 *   time: string, line: string, acceleration: string}} Words
 */

/** @type {Words} */
const PAPER = {
  frequency: "shaking frequency η = Ω/ω",
  gap: "gap ξ",
  gapSpeed: "gap velocity ξ′",
  place: "displacement ξ",
  speed: "velocity ξ′",
  time: "time, shaking periods",
  line: "frequency / Ω",
  acceleration: "acceleration ξ″",
};
/** @type {Words} */
const OWN = {
  frequency: "shaking frequency, Hz",
  gap: "gap, mm",
  gapSpeed: "gap velocity, mm/s",
  place: "displacement, mm",
  speed: "velocity, mm/s",
  time: "time, s",
  line: "frequency, Hz",
  acceleration: "acceleration, g",
};

/** @param {Level} level */
export const wordsOf = (level) => (inHertz(level) ? OWN : PAPER);

/** @param {Point} point @param {Level} level @returns {Scale} */
export function scaleAt(point, level) {
  if (inHertz(level)) {
    return { length: 1e-3, speed: 1e-3, time: 1, line: point.frequency / (2 * Math.PI), acceleration: GRAVITY };
  }
  const length = lengthOf(point);
  const omega = omegaOf(point.structure);
  return { length, speed: length * omega, time: periodOf(point), line: 1, acceleration: length * omega * omega };
}

/** What a frequency ratio of one is on the axis. @param {Structure} structure @param {Level} level */
export const frequencyUnit = (structure, level) => (inHertz(level) ? hertzOf(1, structure) : 1);

/** What a gap of one a eta^2 is on the axis. @param {Point} point @param {Level} level */
export const gapUnit = (point, level) => lengthOf(point) / scaleAt(point, level).length;
