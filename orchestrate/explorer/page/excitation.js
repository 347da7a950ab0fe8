/** How the box is shaken: the paper's amplitude 1/eta^2 m, or a level held at all frequencies. */

import { omegaOf } from "./structure.js";

export const GRAVITY = 9.80665; // m/s²
/** @type {Level} */
export const PAPER = { unit: "paper", value: 1 };
/** @type {Record<Level["unit"], [number, number]>} */
export const LEVELS = { paper: [1, 1], g: [1e-6, 1e4], mm: [1e-6, 1e4] };

/** Whether numbers are shown in Hz, mm, g and seconds. @param {Level} level */
export const isInHertz = ({ unit }) => unit !== "paper";

/** @param {Level} a @param {Level} b */
export const isSameLevel = (a, b) => a.unit === b.unit && a.value === b.value;

/** @param {number} eta @param {Structure} structure */
export const hertzOf = (eta, structure) => (eta * omegaOf(structure)) / (2 * Math.PI);

/** The paper's frequency ratio as a point, or the frequency in Hz of nine digits that is nearest. @param {Structure} structure @param {number} eta @param {Level} level @returns {Point} */
export function pointAt(structure, eta, level) {
  if (isInHertz(level)) return pointAtHertz(structure, Number(hertzOf(eta, structure).toPrecision(9)), level);
  return { structure, eta, frequency: eta * omegaOf(structure), amplitude: 1 / (eta * eta) };
}

/** As `orchestrate` computes it from `--hz` with `--g` or `--amplitude`. @param {Structure} structure @param {number} hertz @param {Level} level @returns {Point} */
export function pointAtHertz(structure, hertz, { unit, value }) {
  const frequency = 2 * Math.PI * hertz;
  const amplitude = unit === "g" ? (value * GRAVITY) / (frequency * frequency) : value / 1000;
  return { structure, eta: shortestRatio(frequency, omegaOf(structure)), frequency, amplitude };
}

/** As `orchestrate` has it: of the numbers near the quotient that give the frequency back, the shortest. @param {number} frequency @param {number} omega */
function shortestRatio(frequency, omega) {
  const guess = frequency / omega;
  const bits = new BigInt64Array(new Float64Array([guess]).buffer)[0];
  const near = [-3n, -2n, -1n, 0n, 1n, 2n, 3n].map((step) => new Float64Array(new BigInt64Array([bits + step]).buffer)[0]);
  const fitting = near.filter((number) => number * omega === frequency);
  /** @param {number} one @param {number} other */
  const order = (one, other) => String(one).length - String(other).length || Math.abs(one - guess) - Math.abs(other - guess);
  return fitting.sort(order)[0] ?? guess;
}

/** The frequency in Hz as it was given, without the roundings of 2 pi. @param {Point} point */
export function hertzAsGiven({ frequency }) {
  const hertz = Number((frequency / (2 * Math.PI)).toPrecision(12));
  return 2 * Math.PI * hertz === frequency ? hertz : frequency / (2 * Math.PI);
}
