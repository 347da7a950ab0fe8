/** The gap between the faces: open, closed or pressed where the springs are unloaded. */

/** @typedef {[number, number]} Places */

const TOUCHING = 2 ** -50; // relative: no more than the rounding of displacements
const TO_WHOLE = 1.5 * 2 ** 52; // added and taken away it leaves a whole number, ties to even

/** The gap where both springs are unloaded, m; below zero the faces are pressed together. @param {Structure} s */
export const gapOffset = (s) => (s.bonded ? 0 : s.clearance);

/** Displacements at rest, m: of the preload where there is one. @param {Structure} s @returns {Places} */
export function atRest(s) {
  const preload = (Math.max(0, -gapOffset(s)) * s.k2) / (1 + s.k2 / s.k1);
  return [0 - preload / s.k1, preload / s.k2];
}

/** The gap of two displacements; 0 where it is no more than rounding. @param {number} x1 @param {number} x2 @param {number} offset */
export function gapBetween(x1, x2, offset) {
  if (offset === 0) return x2 - x1;
  const gap = x2 - x1 + offset;
  const size = Math.abs(x1) + Math.abs(x2) + Math.abs(offset);
  return Math.abs(gap) <= TOUCHING * size ? 0 : gap;
}

/** A state as the kernel takes it: with a preload, from the displacements at rest, where a state of zeros is. @param {Iterable<number>} state @param {Structure} s @returns {number[]} */
export function fromRest([x1, x2, v1, v2], s) {
  if (gapOffset(s) >= 0 || [x1, x2, v1, v2].every((value) => value === 0)) return [x1, x2, v1, v2];
  const [first, second] = atRest(s);
  const touching = gapBetween(x1, x2, gapOffset(s)) === 0;
  return [x1 - first, touching ? x1 - first : x2 - second, v1, v2];
}

/** A state to 44 bits of the larger face and of the larger velocity, as `sweep` passes it on. @param {Iterable<number>} state @param {number} offset */
export function withoutLastDigits([x1, x2, v1, v2], offset) {
  const [first, second] = toBits([x1, offset === 0 ? x2 : x1 + gapBetween(x1, x2, offset)]);
  return [first, offset === 0 ? second : second - offset, ...toBits([v1, v2])];
}

/** @param {number[]} values @param {number} [bits] */
function toBits(values, bits = 44) {
  const largest = Math.max(...values.map(Math.abs));
  const words = new Uint32Array(new Float64Array([largest]).buffer);
  const digit = largest === 0 ? 1 : 2 ** ((words[1] >>> 20) - 1022 - bits);
  return values.map((value) => (value / digit + TO_WHOLE - TO_WHOLE) * digit);
}
