/** One settled response: stroboscopic samples, impacts, the largest gap, how often it repeats, and where it ends. */

import { gapsOf } from "./model.js";
import { lengthOf } from "./structure.js";

export const USUAL = { transient: 500, samples: 200, tolerance: 1e-2 };
export const REPEATED = 1;
export const UNDECIDED = 2;
export const DECIDED = ["irregular", "repeated", "undecided"];

/**
 * The response after a transient, from a state at phase 0.
 * @param {Oscillator} oscillator
 * @param {Point} point
 * @param {Iterable<number>} start
 * @param {Settings} settings
 * @param {boolean} [decides] whether its multiplicity is decided; else the instance stands at the last sample
 * @returns {Generator<undefined, Settled>} it pauses
 */
export function* computeResponse(oscillator, point, start, settings, decides = true) {
  const { states, largest, impacts, end, counts } = yield* oscillator.respond(point, start, settings, decides);
  const length = lengthOf(point);
  return {
    states,
    gaps: gapsOf(states, point).map((gap) => gap / length),
    peak: largest / length,
    impacts,
    contact: counts.touching !== 0 || counts.contacts_after > counts.contacts_before,
    multiplicity: counts.multiplicity,
    decided: counts.decided,
    start: Array.from(start),
    end,
  };
}

/** Periods after which a response is known to repeat; 0 where it is not. @param {{multiplicity: number, decided: number}} response */
export const repeatPeriods = ({ multiplicity, decided }) => (decided === REPEATED ? multiplicity : 0);
