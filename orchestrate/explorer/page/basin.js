/** Basins of attraction: where starts on a plane of gap and gap velocity lead to. */

import { distanceToState, traitsOf } from "./model.js";
import { repeatPeriods, REPEATED, computeResponse, UNDECIDED } from "./response.js";
import { lengthOf, omegaOf } from "./structure.js";

export const SETTLING = { transient: 300, samples: 64, tolerance: 1e-2 };
const LONGEST = 6000; // periods after which what is undecided stays so

/** The start at a cell of a plane. @param {Point} point @param {Plane} plane @param {number} column @param {number} row */
export function startOfCell(point, plane, column, row) {
  const length = lengthOf(point);
  const gap = ((column + 0.5) / plane.side) * plane.gap * length - traitsOf(point).gap_offset;
  const speed = ((2 * (row + 0.5)) / plane.side - 1) * plane.speed * length * omegaOf(point.structure);
  if (point.structure.wall) return [-gap, 0, -speed, 0];
  const [x, v] = plane.mean;
  return [x - gap / 2, x + gap / 2, v - speed / 2, v + speed / 2];
}

/**
 * Where a start leads to: it is run on, for as long again each time, while that is undecided.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {number[]} start
 * @returns {Generator<undefined, Attractor>} it pauses, so that the instance may do other things
 */
export function* followToAttractor(instance, point, start) {
  let found = yield* computeResponse(instance, point, start, SETTLING);
  for (let done = SETTLING.transient + SETTLING.samples; found.decided === UNDECIDED && done < LONGEST; ) {
    found = yield* computeResponse(instance, point, found.end, { ...SETTLING, transient: done });
    done += done + SETTLING.samples;
  }
  return attractorOf(found, point);
}

/**
 * Number of an attractor among those known, to which it is added where it is new. Periodic ones are
 * the same where a state of one lies near one of the other; irregular ones are not distinguished, nor
 * are undecided ones.
 * @param {Attractor[]} known
 * @param {Attractor} one
 * @param {number} tolerance
 */
export function addOrFindAttractor(known, one, tolerance) {
  const place = findAttractor(known, one, tolerance);
  return place >= 0 ? place : known.push(one) - 1;
}

/** Number of an attractor among those known; −1 where it is new. @param {Attractor[]} known @param {Attractor} one @param {number} tolerance */
export function findAttractor(known, one, tolerance) {
  return known.findIndex(
    (other) =>
      other.decided === one.decided &&
      repeatPeriods(other) === repeatPeriods(one) &&
      (one.decided !== REPEATED || distanceToState(other.samples, other.frequency, other.gap, one.samples.slice(-4)) < tolerance),
  );
}

/** Whether a motion is another one than the one that is shown: both are decided. @param {Attractor} shown @param {Attractor} one @param {number} tolerance */
export function isOtherAttractor(shown, one, tolerance) {
  return [shown, one].every(({ decided }) => decided !== UNDECIDED) && findAttractor([shown], one, tolerance) < 0;
}

/** What a response is to the picture. @param {Settled} response @param {Point} point @returns {Attractor} */
export function attractorOf({ states, multiplicity, decided, impacts, peak }, point) {
  const samples = states.slice(-4 * SETTLING.samples);
  return { multiplicity, decided, samples, impacts, frequency: point.frequency, gap: peak * lengthOf(point) };
}
