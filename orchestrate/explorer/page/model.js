/** What the compiled loops say of a structure and of states of it, at once. */

import { lengthOf, omegaOf } from "./structure.js";

/** @type {Library} of the oscillator, of this thread */
let library;

/** Say, once, whom to ask. @param {Library} compiled */
export const useLibrary = (compiled) => (library = compiled);

/** A structure under an excitation: its numbers, and by name what follows from them. @param {Point} point @returns {Record<string, number>} */
export function traitsOf(point) {
  const { traits } = library.loops;
  const row = library.withBuffers((buffers) => library.copyNumbers(buffers.traitsRow(point), traits.length));
  return Object.fromEntries(traits.map((name, i) => [name, row[i]]));
}

/** Gaps of states, m. @param {ArrayLike<number>} states four numbers each @param {Point} point */
export function gapsOf(states, point) {
  const count = states.length / 4;
  const { gap_offset } = traitsOf(point);
  return library.withBuffers((buffers) => {
    const gaps = buffers.array("f64", count);
    library.calls.find_gaps(buffers.array("f64", states), count, buffers.array("f64", [gap_offset]), 1, gaps);
    return library.copyNumbers(gaps, count);
  });
}

/** Absolute accelerations of both masses. @param {Motion} motion @param {Point} point */
export function accelerationsOf({ states, contact }, point) {
  return library.withBuffers((buffers) => {
    const found = buffers.array("f64", 2 * contact.length);
    library.calls.find_accelerations(buffers.array("f64", states), contact.length, buffers.traitsRow(point), buffers.array("u8", contact), found);
    return library.copyNumbers(found, 2 * contact.length);
  });
}

/** A state at one point as the like one at another. @param {number[]} state @param {Point} from @param {Point} to */
export function carryState(state, from, to) {
  const length = lengthOf(to) / lengthOf(from);
  const speed = (length * omegaOf(to.structure)) / omegaOf(from.structure);
  return library.withBuffers((buffers) => {
    const like = buffers.array("f64", 4);
    library.calls.carry_state(buffers.array("f64", state), buffers.traitsRow(from), buffers.traitsRow(to), length, speed, like);
    return Array.from(library.copyNumbers(like, 4));
  });
}

/** How near states of a motion come to a state, over the motion's size. @param {Float64Array} states @param {number} frequency @param {number} gap its largest, m @param {ArrayLike<number>} state */
export function distanceToState(states, frequency, gap, state) {
  const count = states.length / 4;
  return library.withBuffers((buffers) => {
    const [one, other] = [states, state].map((numbers) => buffers.array("f64", numbers));
    return library.calls.nearest_state(one, count, frequency, gap, other, buffers.array("f64", library.calls.memory_size(count)));
  });
}
