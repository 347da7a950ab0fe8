/** One settled response: stroboscopic samples, impacts, the largest gap, and where it ends. */

import { lengthOf, periodOf } from "./structure.js";

/**
 * @typedef {import("./kernel.js").Oscillator} Oscillator
 * @typedef {import("./structure.js").Point} Point
 * @typedef {{transient: number, samples: number, tolerance: number}} Settings
 * @typedef {{states: Float64Array, gaps: Float64Array, peak: number, impacts: number,
 *   contact: boolean, multiplicity: number, start: number[], end: number[]}} Response
 *   gaps and peak over a eta^2; four numbers a state
 */

export const USUAL = { transient: 500, samples: 200, tolerance: 1e-2 };

const TO_WHOLE = 1.5 * 2 ** 52; // added and taken away it leaves a whole number, ties to even

/**
 * The response after a transient, from a state at phase 0; the instance stands at its end.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {ArrayLike<number>} start
 * @param {Settings} settings
 * @returns {Response}
 */
export function respond(instance, point, start, { transient, samples, tolerance }) {
  const period = periodOf(point);
  instance.begin(point, start);
  if (transient) instance.step(0, transient * period);
  const before = instance.get("impact_count");
  const contacts = instance.get("contact_count");
  const touching = instance.get("in_contact") !== 0;
  instance.set({ x_rel_max_on: 1 });
  const { states, peak } = instance.sampled(samples, (index) => (transient + index) * period);
  const length = lengthOf(point);
  return {
    states,
    gaps: gapsOf(states, length),
    peak: peak / length,
    impacts: (instance.get("impact_count") - before) / samples,
    contact: touching || instance.get("contact_count") > contacts,
    multiplicity: multiplicity(states, tolerance),
    start: Array.from(start),
    end: withoutLastDigits(states.subarray(states.length - 4)),
  };
}

/**
 * A state to 44 bits of the larger displacement and of the larger velocity, as `sweep` passes it on.
 * @param {Float64Array} state
 */
function withoutLastDigits(state) {
  return [...toBits(state.subarray(0, 2)), ...toBits(state.subarray(2))];
}

/** @param {Float64Array} values @param {number} [bits] */
function toBits(values, bits = 44) {
  const largest = Math.max(...values.map(Math.abs));
  const words = new Uint32Array(new Float64Array([largest]).buffer);
  const digit = largest === 0 ? 1 : 2 ** ((words[1] >>> 20) - 1022 - bits);
  return Array.from(values, (value) => (value / digit + TO_WHOLE - TO_WHOLE) * digit);
}

/** @param {Float64Array} states @param {number} length */
export function gapsOf(states, length) {
  const gaps = new Float64Array(states.length / 4);
  for (let i = 0; i < gaps.length; i++) gaps[i] = (states[4 * i + 1] - states[4 * i]) / length;
  return gaps;
}

/**
 * The least n such that the state repeats after n periods; 0 where none up to a quarter does.
 * Only the later half of the samples is compared.
 * @param {Float64Array} states
 * @param {number} tolerance
 */
export function multiplicity(states, tolerance) {
  const count = states.length / 4;
  const first = Math.floor(count / 2);
  const scale = [0, 0, 0, 0];
  for (let i = 4 * first; i < states.length; i++) {
    scale[i % 4] = Math.max(scale[i % 4], Math.abs(states[i]));
  }
  const limit = Math.min(Math.max(1, Math.floor(count / 4)), count - first - 1);
  for (let n = 1; n <= limit; n++) {
    if (repeats(states, 4 * first, 4 * n, scale, tolerance)) return n;
  }
  return 0;
}

/**
 * @param {Float64Array} states
 * @param {number} first
 * @param {number} shift
 * @param {number[]} scale
 * @param {number} tolerance
 */
function repeats(states, first, shift, scale, tolerance) {
  for (let i = first; i + shift < states.length; i++) {
    const unit = scale[i % 4] || 1;
    if (Math.abs(states[i + shift] / unit - states[i] / unit) > tolerance) return false;
  }
  return true;
}
