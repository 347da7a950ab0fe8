/** A motion in time with its impacts, and what an accelerometer on mass 1 would read. */

import { Pauses } from "./pauses.js";
import { periodOf } from "./structure.js";

/**
 * @typedef {{time: Float64Array, states: Float64Array, contact: Uint8Array,
 *   impactTime: Float64Array, impactSpeed: Float64Array, impactPlace: Float64Array,
 *   impactEnergy: Float64Array, period: number, first: number, points: number}} Motion
 *   of each impact: closing speed, the common displacement of both masses, energy lost in J
 */

/**
 * Go on from where the instance stands, `first` periods after its start.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {number} first
 * @param {number} periods
 * @param {number} points a period
 * @returns {Generator<undefined, Motion>} it pauses, so that the instance may do other things
 */
export function* record(instance, point, first, periods, points) {
  const period = periodOf(point);
  const count = periods * points + 1;
  const time = new Float64Array(count);
  const states = new Float64Array(4 * count);
  const contact = new Uint8Array(count);
  /** @type {number[][]} */
  const impacts = [];
  instance.set({ x_rel_max_on: 0, sample_count: 0 });
  const pauses = new Pauses(instance);
  for (let i = 0; i < count; i++) {
    time[i] = (first + i / points) * period;
    if (i > 0) advance(instance, time[i - 1], time[i], impacts);
    states.set(instance.state(), 4 * i);
    contact[i] = instance.get("in_contact");
    yield* pauses.after(1);
  }
  /** @param {number} part */
  const column = (part) => Float64Array.from(impacts, (impact) => impact[part]);
  const [impactTime, impactSpeed, impactPlace, impactEnergy] = [0, 1, 2, 3].map(column);
  const found = { impactTime, impactSpeed, impactPlace, impactEnergy };
  return { time, states, contact, ...found, period, first, points };
}

/**
 * Step to `target`, stopping at each impact.
 * @param {Oscillator} instance
 * @param {number} time
 * @param {number} target
 * @param {number[][]} impacts
 */
function advance(instance, time, target, impacts) {
  while (time < target) {
    const before = ["impact_count", "impact_energy"].map((name) => instance.get(name));
    time = instance.step(time, target, true);
    if (instance.get("impact_count") > before[0]) {
      const told = ["impact_time", "impact_velocity", "x1"].map((name) => instance.get(name));
      impacts.push([...told, instance.get("impact_energy") - before[1]]);
    }
  }
}

/**
 * Absolute accelerations of both masses between impacts, by (6), in contact with its force (18).
 * @param {Float64Array | number[]} state
 * @param {boolean} touching
 * @param {Point} point
 * @returns {[number, number]}
 */
export function accelerations([x1, x2, v1, v2], touching, { structure: s }) {
  if (touching) {
    const both = -((s.k1 + s.k2) * x1 + s.k2 * (x2 - x1) + (s.d1 + s.d2) * v1) / (s.m1 + s.m2);
    return [both, both];
  }
  return [-(s.k1 * x1 + s.d1 * v1) / s.m1, -(s.k2 * x2 + s.d2 * v2) / s.m2];
}
