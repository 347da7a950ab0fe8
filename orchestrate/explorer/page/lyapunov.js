/** The largest Lyapunov exponent, estimated: how fast two motions that begin close by part. */

import { gapsOf, traitsOf } from "./model.js";
import { lengthOf, omegaOf, periodOf } from "./structure.js";

/** @typedef {{value: number, error: number}} Exponent per unit of tau */

const SLICE = 20; // periods between two pauses
const BLOCKS = 8; // parts of the whole whose growths are samples of the mean
const QUANTILE = 4.79; // of Student's t of as many less one, two-sided 99.8 %: it is asked several times

/**
 * Mean growth rate per unit of tau of a small difference, made small again after each period: over
 * so many periods, or twice as many again and again where the sign is within the error.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {number[]} start on the attractor, at phase 0
 * @param {{periods: number, most: number, distance: number}} settings `most`: periods at the most
 * @returns {Generator<undefined, Exponent>} minus infinity where permanent contact forgets the
 *   difference; it pauses, so that the instance may do other things
 */
export function* exponentOf(instance, point, start, { periods, most, distance }) {
  const period = periodOf(point);
  const length = lengthOf(point);
  const speed = length * omegaOf(point.structure);
  const scale = [length, length, speed, speed];
  /** @param {number[]} state */
  const next = (state) => {
    instance.begin(point, state);
    return Array.from(instance.sampled(0, period, 1));
  };
  let state = start;
  let difference = [-0.5, 0.5, 0.5, -0.5].map((part) => part * distance);
  const step = period * omegaOf(point.structure);
  let blocks = new Float64Array(BLOCKS);
  for (let n = 0, end = periods; ; n++) {
    if (n === end) {
      const found = meanOf(blocks, n, step);
      if (Math.abs(found.value) > found.error || 2 * n > most) return found;
      end = 2 * n;
      blocks = paired(blocks);
    }
    const twin = beside(state, difference, scale, point);
    const moved = twin.map((value, i) => (value - state[i]) / scale[i]);
    [state, difference] = separate(next(state), next(twin), scale);
    const growth = norm(difference) / norm(moved);
    if (!(growth > 0)) return { value: -Infinity, error: 0 };
    blocks[Math.floor((n * BLOCKS) / end)] += Math.log(growth);
    const factor = distance / norm(difference);
    difference = difference.map((part) => part * factor);
    if (n % SLICE === SLICE - 1) yield;
  }
}

/** The same growths in half as many blocks, and as many empty ones. @param {Float64Array} blocks */
const paired = (blocks) => blocks.map((_, i) => (blocks[2 * i] ?? 0) + (blocks[2 * i + 1] ?? 0));

/** The mean growth, and how far it may be off: by chance (99.8 %), or since differences that grow as the time does are no chaos. @param {Float64Array} blocks growth in equal times @param {number} periods of all @param {number} step a period, in tau @returns {Exponent} */
function meanOf(blocks, periods, step) {
  const time = periods * step;
  const sum = blocks.reduce((all, one) => all + one, 0);
  const spread = blocks.reduce((all, one) => all + (one - sum / blocks.length) ** 2, 0);
  const chance = QUANTILE * Math.sqrt((spread * blocks.length) / (blocks.length - 1));
  return { value: sum / time, error: Math.max(chance, Math.log(periods)) / time };
}

/** A state close by whose gap is none below zero. @param {number[]} state @param {number[]} d @param {number[]} scale @param {Point} point */
function beside(state, d, scale, point) {
  const other = state.map((value, i) => value + d[i] * scale[i]);
  const sign = gapsOf(other, point)[0] < 0 ? -1 : 1;
  const twin = state.map((value, i) => value + sign * d[i] * scale[i]);
  return gapsOf(twin, point)[0] < 0 ? [twin[0], twin[0] - traitsOf(point).gap_offset, twin[2], twin[3]] : twin;
}

/** @param {number[]} state @param {number[]} twin @param {number[]} scale @returns {[number[], number[]]} */
function separate(state, twin, scale) {
  return [state, twin.map((value, i) => (value - state[i]) / scale[i])];
}

/** @param {number[]} vector */
function norm(vector) {
  return Math.hypot(...vector);
}
