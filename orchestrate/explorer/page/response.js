/** One settled response: stroboscopic samples, impacts, the largest gap, and where it ends. */

import { gapBetween, gapOffset, withoutLastDigits } from "./clearance.js";
import { Pauses, PIECE } from "./pauses.js";
import { lengthOf, periodOf } from "./structure.js";

/**
 * @typedef {{transient: number, samples: number, tolerance: number}} Settings
 * @typedef {{states: Float64Array, gaps: Float64Array, peak: number, impacts: number,
 *   contact: boolean, multiplicity: number, start: number[], end: number[]}} Response
 *   gaps and peak over a eta^2; four numbers a state
 */

export const USUAL = { transient: 500, samples: 200, tolerance: 1e-2 };

const LEAST_GAP = 2 ** -20; // of the motion's size: smaller gaps have no size of their own

/**
 * The response after a transient, from a state at phase 0; the instance stands at its end.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {Iterable<number>} start
 * @param {Settings} settings
 * @returns {Generator<undefined, Response>} it pauses, so that the instance may do other things
 */
export function* respond(instance, point, start, { transient, samples, tolerance }) {
  const period = periodOf(point);
  instance.begin(point, start);
  const pauses = new Pauses(instance);
  for (let done = 0; done < transient; done += PIECE) {
    instance.step(0, Math.min(done + PIECE, transient) * period); // the end as it is, not rounded once more
    yield* pauses.after(PIECE);
  }
  const before = instance.get("impact_count");
  const contacts = instance.get("contact_count");
  const touching = instance.get("in_contact") !== 0;
  instance.set({ x_rel_max_on: 1 });
  const { states, peak } = instance.sampled(samples, (index) => (transient + index) * period);
  const length = lengthOf(point);
  const offset = gapOffset(point.structure);
  return {
    states,
    gaps: gapsOf(states, length, offset),
    peak: peak / length,
    impacts: (instance.get("impact_count") - before) / samples,
    contact: touching || instance.get("contact_count") > contacts,
    multiplicity: multiplicity(overSize(states, (2 * Math.PI) / period, peak), tolerance),
    start: Array.from(start),
    end: withoutLastDigits(states.subarray(states.length - 4), offset),
  };
}

/** @param {Float64Array} states @param {number} length @param {number} offset */
function gapsOf(states, length, offset) {
  const gaps = new Float64Array(states.length / 4);
  for (let i = 0; i < gaps.length; i++) gaps[i] = gapBetween(states[4 * i], states[4 * i + 1], offset) / length;
  return gaps;
}

/**
 * The least n such that the state repeats after n periods within a tolerance; 0 where none up to a
 * quarter does. Only the later half of the samples is compared. How deviations develop is not
 * asked here: `sweep` does.
 * @param {number[][]} states Of `overSize`.
 * @param {number} tolerance
 */
export function multiplicity(states, tolerance) {
  const first = Math.floor(states.length / 2);
  const limit = Math.min(Math.max(1, Math.floor(states.length / 4)), states.length - first - 1);
  for (let n = 1; n <= limit; n++) {
    if (repeats(states, first, n, tolerance)) return n;
  }
  return 0;
}

/**
 * States with the gap and its rate, over the motion's size; the gap over its own.
 * @param {Float64Array} states Four numbers a state.
 * @param {number} frequency rad/s
 * @param {number} gap The largest one, m.
 * @returns {number[][]}
 */
export function overSize(states, frequency, gap) {
  const rows = [];
  for (let i = 0; i < states.length; i += 4) {
    const [x1, x2] = [states[i], states[i + 1]];
    const [v1, v2] = [states[i + 2] / frequency, states[i + 3] / frequency];
    rows.push([x1, x2, v1, v2, x2 - x1, v2 - v1]);
  }
  const later = rows.slice(Math.floor(rows.length / 2));
  const size = Math.max(...later.map((row) => Math.max(...row.slice(0, 4).map(Math.abs)))) || 1;
  const ofGap = Math.max(gap, LEAST_GAP * size);
  const ofRate = Math.max(ofGap, ...later.map((row) => Math.abs(row[5])));
  return rows.map((row) => [...row.slice(0, 4).map((value) => value / size), row[4] / ofGap, row[5] / ofRate]);
}

/** @param {number[][]} states @param {number} first @param {number} shift @param {number} tolerance */
function repeats(states, first, shift, tolerance) {
  for (let i = first; i + shift < states.length; i++) {
    if (states[i].some((value, k) => Math.abs(states[i + shift][k] - value) > tolerance)) return false;
  }
  return true;
}
