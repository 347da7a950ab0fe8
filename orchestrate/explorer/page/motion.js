/** A motion in time with its impacts. */

import { periodOf } from "./structure.js";

const TOLD = ["impact_velocity", "x1", "impact_energy"];

/**
 * A motion from a start, kept from `first` periods on.
 * @param {Oscillator} stopping that stops at its events
 * @param {Point} point
 * @param {Iterable<number>} start
 * @param {number} first
 * @param {number} periods
 * @param {number} points a period
 * @returns {Generator<undefined, Motion>} it pauses
 */
export function* recordMotion(stopping, point, start, first, periods, points) {
  const period = periodOf(point);
  const time = Float64Array.from({ length: periods * points + 1 }, (_, i) => (first + i / points) * period);
  stopping.initialize(point, start);
  const before = yield* stopping.play(0, time.slice(0, 1), [], TOLD);
  const { rows, contact, impacts } = yield* stopping.play(time[0], time, ["x1", "x2", "v1", "v2"], TOLD);
  const [impactTime, impactSpeed, impactPlace, lost] = [0, 1, 2, 3].map((part) => Float64Array.from(impacts, (impact) => impact[part]));
  const lostBefore = before.impacts[before.impacts.length - 1]?.[3] ?? 0;
  const impactEnergy = lost.map((energy, i) => energy - (i ? lost[i - 1] : lostBefore));
  return { time, states: rows, contact, impactTime, impactSpeed, impactPlace, impactEnergy, period, first, points };
}
