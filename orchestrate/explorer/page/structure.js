/** A structure and its excitation: SI numbers, and the paper's. */

const TURN = 2 * Math.PI;
/** @type {Record<string, keyof Structure>} what a slider of the paper's beam, without units, is called besides */
const SAME = { xi0: "clearance", play: "stroke", push: "box_acceleration", push1: "force1", push2: "force2" };

/** The unit of frequency, rad/s (2). @param {Structure} s */
export function omegaOf(s) {
  return Math.sqrt(s.k1 / s.m1);
}

/** The paper's numbers, (2) and (8). @param {Structure} s */
export function ratiosOf(s) {
  const omega = omegaOf(s);
  return {
    omega,
    mu: s.m2 / s.m1,
    kappa: s.k2 / s.k1,
    D1: s.d1 / (2 * omega * s.m1),
    D2: s.d2 / (2 * omega * s.m2),
  };
}

/** Natural frequency in Hz and damping ratio of each half alone. @param {Structure} s */
export function halvesOf(s) {
  const [first, second] = [Math.sqrt(s.k1 / s.m1), Math.sqrt(s.k2 / s.m2)];
  return {
    f1: first / TURN,
    f2: second / TURN,
    zeta1: s.d1 / (2 * first * s.m1),
    zeta2: s.d2 / (2 * second * s.m2),
  };
}

/** A structure by its halves; `mu` is the ratio of the masses. @param {Structure} s @param {{m1: number, m2: number, f1: number, f2: number, zeta1: number, zeta2: number}} halves @returns {Structure} */
export function withHalves(s, { m1, m2, f1, f2, zeta1, zeta2 }) {
  const [first, second] = [TURN * f1, TURN * f2];
  return {
    ...{ ...s, m1, m2, k1: m1 * first * first, k2: m2 * second * second },
    ...{ d1: 2 * zeta1 * first * m1, d2: 2 * zeta2 * second * m2 },
  };
}

/**
 * A structure that differs in one number; `mu` keeps the damping ratios, the numbers of a half
 * keep its others.
 * @param {Structure} s
 * @param {string} name
 * @param {number} value
 * @returns {Structure}
 */
export function withNumber(s, name, value) {
  const { omega, D2 } = ratiosOf(s);
  const halves = { m1: s.m1, m2: s.m2, ...halvesOf(s) };
  if (name in halves && !(name in s)) return withHalves(s, { ...halves, [name]: value });
  if (name === "mass1") return withHalves(s, { ...halves, m1: value });
  if (name === "mass2") return withHalves(s, { ...halves, m2: value });
  if (name === "zeta") return withHalves(s, { ...halves, zeta1: value / 100, zeta2: value / 100 });
  if (name === "gap") return { ...s, clearance: value / 1000 };
  if (name === "most") return { ...s, stroke: value / 1000 };
  if (name === "wall" && value) return { ...s, wall: value, force2: 0 };
  if (name in SAME) return { ...s, [SAME[name]]: value };
  if (name === "mu") return { ...s, m2: value * s.m1, d2: 2 * D2 * omega * s.m1 * value };
  if (name === "kappa") return { ...s, k2: value * s.k1 };
  if (name === "D1") return { ...s, d1: 2 * value * omega * s.m1 };
  if (name === "D2") return { ...s, d2: 2 * value * omega * s.m1 * (s.m2 / s.m1) };
  if (name === "D") return withNumber(withNumber(s, "D1", value), "D2", value);
  return { ...s, [name]: value };
}

/** What contradicts itself in a structure, in words. @param {Structure} s */
export const contradictionIn = (s) => (s.stroke && s.stroke < s.clearance ? "expected a largest gap of 0, or not below that at rest" : "");

/** All numbers that a field may show. @param {Structure} s @returns {Record<string, number>} */
export function fieldNumbers(s) {
  const [ratios, halves] = [ratiosOf(s), halvesOf(s)];
  const own = { mass1: s.m1, mass2: s.m2, zeta: 100 * halves.zeta1, gap: 1000 * s.clearance, most: 1000 * s.stroke };
  const paper = Object.fromEntries(Object.entries(SAME).map(([name, other]) => [name, s[other]]));
  return { ...s, ...ratios, ...halves, ...own, ...paper, D: ratios.D1 };
}

/**
 * The same motions in other units, with a mass 1 of 1 kg: all ratios stay.
 * @param {Structure} s
 * @param {Units} units of its parameters
 * @param {number} omega rad/s
 * @param {number} length factor of what is a length
 * @param {number} digits that are kept: fewer than all, so that there and back is the same
 * @returns {Structure}
 */
export function rescaled(s, units, omega, length, digits) {
  const [masses, rates] = [1 / s.m1, omega / omegaOf(s)];
  /** @type {Record<string, number>} */
  const changed = { ...s };
  for (const [name, { kg, m, s: seconds }] of Object.entries(units)) {
    let factor = 1;
    for (const [base, exponent] of [[masses, kg], [rates, -seconds], [length, m]]) {
      for (let i = exponent; i > 0; i--) factor *= base;
      for (let i = exponent; i < 0; i++) factor /= base;
    }
    changed[name] = Number((changed[name] * factor).toPrecision(digits));
  }
  return /** @type {Structure} */ (changed);
}

/** One period of the box, s (22). @param {Point} point */
export function periodOf(point) {
  return (2 * Math.PI) / point.frequency;
}

/** The unit of xi, a eta^2 in m; exactly 1 where it is 1 but for rounding. @param {Point} point */
export function lengthOf(point) {
  const length = point.amplitude * (point.eta * point.eta);
  return Math.abs(length - 1) <= 2e-15 * Math.max(length, 1) ? 1 : length;
}

/** @param {Structure} a @param {Structure} b */
export function isSameStructure(a, b) {
  return Object.keys(a).every((name) => a[/** @type {keyof Structure} */ (name)] === b[/** @type {keyof Structure} */ (name)]);
}
