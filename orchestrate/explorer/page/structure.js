/** A structure and its excitation: SI numbers, and the paper's. */

/**
 * @typedef {{m1: number, m2: number, k1: number, k2: number, d1: number, d2: number,
 *   e: number, gamma: number, bonded: number}} Structure
 * @typedef {{omega: number, mu: number, kappa: number, D1: number, D2: number}} Ratios
 * @typedef {{structure: Structure, eta: number, frequency: number, amplitude: number}} Point
 */

/** The unit of frequency, rad/s (2). @param {Structure} s */
export function omegaOf(s) {
  return Math.sqrt(s.k1 / s.m1);
}

/** The paper's numbers, (2) and (8). @param {Structure} s @returns {Ratios} */
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

/** A structure in a few words. @param {Structure} s */
export function titleOf(s) {
  const { D1, D2, mu, kappa } = ratiosOf(s);
  const ratios = { e: s.e, "D₁": D1, "D₂": D2, "μ": mu, "κ": kappa };
  const told = Object.entries(ratios).map(([name, value]) => `${name} = ${Number(value.toPrecision(6))}`);
  return `A ${s.bonded ? "bonded" : "delaminated"} beam in a shaken box: ${told.join(", ")}`;
}

/**
 * A structure that differs in one of the paper's numbers; `mu` keeps the damping ratios.
 * @param {Structure} s
 * @param {string} name
 * @param {number} value
 * @returns {Structure}
 */
export function withRatio(s, name, value) {
  const { omega, D2 } = ratiosOf(s);
  if (name === "mu") return { ...s, m2: value * s.m1, d2: 2 * D2 * omega * s.m1 * value };
  if (name === "kappa") return { ...s, k2: value * s.k1 };
  if (name === "D1") return { ...s, d1: 2 * value * omega * s.m1 };
  if (name === "D2") return { ...s, d2: 2 * value * omega * s.m1 * (s.m2 / s.m1) };
  return { ...s, [name]: value };
}

/**
 * Frequency ratio `eta` with the amplitude 1/eta^2 m, so that xi of (3) is x in metres.
 * @param {Structure} structure
 * @param {number} eta
 * @returns {Point}
 */
export function pointAt(structure, eta) {
  return { structure, eta, frequency: eta * omegaOf(structure), amplitude: 1 / (eta * eta) };
}

/**
 * Points of one structure as columns, which reach a worker faster.
 * @typedef {{structure: Structure, eta: Float64Array, frequency: Float64Array,
 *   amplitude: Float64Array}} Columns
 */

/** @param {Point[]} points @param {number[]} indices @returns {Columns} */
export function columnsAt(points, indices) {
  /** @param {"eta" | "frequency" | "amplitude"} name */
  const column = (name) => Float64Array.from(indices, (i) => points[i][name]);
  const { structure } = points[indices[0]];
  return { structure, eta: column("eta"), frequency: column("frequency"), amplitude: column("amplitude") };
}

/** @param {Columns} columns @param {number} i @returns {Point} */
export function pointOf({ structure, eta, frequency, amplitude }, i) {
  return { structure, eta: eta[i], frequency: frequency[i], amplitude: amplitude[i] };
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
export function sameStructure(a, b) {
  return Object.keys(a).every((name) => a[/** @type {keyof Structure} */ (name)] === b[/** @type {keyof Structure} */ (name)]);
}
