/** Basins of attraction: where starts on a plane of gap and gap velocity lead to. */

import { respond } from "./response.js";
import { gapOffset } from "./clearance.js";
import { lengthOf, omegaOf } from "./structure.js";

/**
 * @typedef {{side: number, gap: number, speed: number, mean: [number, number]}} Plane
 *   gap from 0 and gap velocity to both sides, over a eta^2; means of displacements, velocities
 * @typedef {{multiplicity: number, samples: Float64Array, impacts: number}} Attractor
 */

export const SETTLING = { transient: 300, samples: 64, tolerance: 1e-2 };

/** The start at a cell of a plane. @param {Point} point @param {Plane} plane @param {number} column @param {number} row */
export function startAt(point, plane, column, row) {
  const length = lengthOf(point);
  const gap = ((column + 0.5) / plane.side) * plane.gap * length - gapOffset(point.structure);
  const speed = ((2 * (row + 0.5)) / plane.side - 1) * plane.speed * length * omegaOf(point.structure);
  const [x, v] = plane.mean;
  return [x - gap / 2, x + gap / 2, v - speed / 2, v + speed / 2];
}

/**
 * Where a start leads to.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {number[]} start
 * @returns {Generator<undefined, Attractor>} it pauses, so that the instance may do other things
 */
export function* destination(instance, point, start) {
  return attractorOf(yield* respond(instance, point, start, SETTLING));
}

/**
 * Number of an attractor among those known, to which it is added where it is new. Periodic ones are
 * the same where a state of one lies near one of the other; irregular ones are not told apart.
 * @param {Attractor[]} known
 * @param {Attractor} one
 * @param {number} tolerance
 */
export function label(known, one, tolerance) {
  const place = placeOf(known, one, tolerance);
  return place >= 0 ? place : known.push(one) - 1;
}

/** Number of an attractor among those known; −1 where it is new. @param {Attractor[]} known @param {Attractor} one @param {number} tolerance */
export function placeOf(known, one, tolerance) {
  return known.findIndex(
    (other) =>
      other.multiplicity === one.multiplicity &&
      (one.multiplicity === 0 || distance(other.samples, one.samples) <= tolerance),
  );
}

/** What a response is to the picture: as if it had so few samples. @param {import("./response.js").Response} response @returns {Attractor} */
export function attractorOf({ states, multiplicity, impacts }) {
  return { multiplicity: multiplicity <= SETTLING.samples / 4 ? multiplicity : 0, samples: states.slice(-64), impacts };
}

/** Least distance of the last state of `one` from states of `other`, relative. @param {Float64Array} other @param {Float64Array} one */
function distance(other, one) {
  const last = one.subarray(one.length - 4);
  const scale = [0, 0, 0, 0];
  other.forEach((value, i) => (scale[i % 4] = Math.max(scale[i % 4], Math.abs(value))));
  let least = Infinity;
  for (let i = 0; i < other.length; i += 4) {
    const parts = [0, 1, 2, 3].map((k) => Math.abs(other[i + k] - last[k]) / (scale[k] || 1));
    least = Math.min(least, Math.max(...parts));
  }
  return least;
}
