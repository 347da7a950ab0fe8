/** One settled response: stroboscopic samples, impacts, the largest gap, how often it repeats, and where it ends. */

import { Buffers, WORK } from "./kernel.js";
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
export function* computeResponse(oscillator, point, start, { transient, samples, tolerance }, decides = true) {
  const { library } = oscillator;
  const { calls, loops } = library;
  const buffers = new Buffers(library);
  try {
    const places = {
      ...{ states: buffers.array("f64", 4 * samples), ends: buffers.array("f64", 4), largest: buffers.array("f64", 1) },
      ...{ impacts: buffers.array("f64", 1), counts: buffers.array("i32", loops.counts.length) },
    };
    const more = { transients: buffers.array("u32", [transient, 0]), memory: buffers.array("f64", calls.memory_size(samples)) };
    const asked = { samples, tolerance, decides: Number(decides), ...more, ...places };
    const task = oscillator.responseTask(buffers, point, start, asked);
    yield* oscillator.loop("respond", oscillator.own, task, buffers.newStructure("ResponseProgress", {}), WORK);
    const found = library.viewMemory("i32", places.counts, loops.counts.length);
    const counts = Object.fromEntries(loops.counts.map((name, i) => [name, found[i]]));
    const [states, length] = [library.copyNumbers(places.states, 4 * samples), lengthOf(point)];
    return {
      states,
      gaps: gapsOf(states, point).map((gap) => gap / length),
      peak: library.copyNumbers(places.largest, 1)[0] / length,
      impacts: library.copyNumbers(places.impacts, 1)[0],
      contact: counts.touching !== 0 || counts.contacts_after > counts.contacts_before,
      multiplicity: counts.multiplicity,
      decided: counts.decided,
      start: Array.from(start),
      end: Array.from(library.copyNumbers(places.ends, 4)),
    };
  } finally {
    buffers.free();
  }
}

/** Periods after which a response is known to repeat; 0 where it is not. @param {{multiplicity: number, decided: number}} response */
export const repeatPeriods = ({ multiplicity, decided }) => (decided === REPEATED ? multiplicity : 0);
