/** An orbit diagram: responses along the frequency, some of them still to come. */

import { hertzOf, isInHertz, pointAt, pointAtHertz } from "./excitation.js";
import { carryState } from "./model.js";
import { niceStep } from "./scale.js";

export const LOWEST = 1e-5; // gaps below are drawn in the strip of zero

/**
 * Frequencies on a decimal grid, as `orchestrate sweep --eta FIRST:LAST:STEP` has them.
 * @param {number} low
 * @param {number} high
 * @param {number} count at most
 */
export function decimalGrid(low, high, count) {
  const step = niceStep((high - low) / count);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const unit = Math.round(step * 10 ** digits);
  const first = Math.ceil(Math.round(low * 10 ** digits) / unit - 1e-9) * unit;
  const values = [];
  for (let i = Math.max(first, unit); i <= Math.round(high * 10 ** digits); i += unit) {
    values.push(Number(`${i}e-${digits}`));
  }
  return values;
}

/**
 * A diagram that is still to be computed.
 * @param {Structure} structure
 * @param {Region} region
 * @param {number} count of frequencies, at most
 * @param {Settings} settings
 * @returns {Diagram}
 */
export function emptyDiagram(structure, { low, high, direction, level }, count, settings) {
  const points = isInHertz(level)
    ? decimalGrid(hertzOf(low, structure), hertzOf(high, structure), count).map((hertz) => pointAtHertz(structure, hertz, level))
    : decimalGrid(low, high, count).map((eta) => pointAt(structure, eta, level));
  /** @type {("up" | "down")[]} */
  const ways = direction === "both" ? ["up", "down"] : [direction];
  const lanes = ways.map((way) => ({ direction: way, found: new Array(points.length), starts: null, from: null }));
  return { structure, direction, level, low, high, points, lanes, settings };
}

/** Index of the frequency nearest to `eta`. @param {Diagram} diagram @param {number} eta */
export function nearestIndex({ points }, eta) {
  let best = 0;
  points.forEach((point, i) => {
    if (Math.abs(point.eta - eta) < Math.abs(points[best].eta - eta)) best = i;
  });
  return best;
}

/** Where the response at an index begins; null where that is not known yet. @param {Lane} lane @param {number} index */
export function startOfResponse(lane, index) {
  if (lane.starts) return Array.from(lane.starts.subarray(4 * index, 4 * index + 4));
  return lane.found[index]?.start ?? null;
}

/**
 * Where a new chain through a region begins: what another diagram of the same structure has there.
 * @param {Diagram | null} other
 * @param {Point} point the first of the chain
 * @param {"up" | "down"} direction
 */
export function startOfChain(other, point, direction) {
  const rest = [0, 0, 0, 0];
  const lane = other?.lanes.find((one) => one.direction === direction);
  if (!other || !lane) return rest;
  const sign = direction === "up" ? 1 : -1;
  let best = -1;
  other.points.forEach(({ eta }, i) => {
    if (sign * (point.eta - eta) < -1e-12 || !startOfResponse(lane, i)) return;
    if (best < 0 || sign * (eta - other.points[best].eta) > 0) best = i;
  });
  return best < 0 ? rest : carryState(startOfResponse(lane, best) ?? rest, other.points[best], point);
}
