/** The gap between the faces: open, closed or pressed where the springs are unloaded. */

/** @typedef {[number, number]} Places */

const TOUCHING = 2 ** -50; // relative: no more than the rounding of displacements

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
