/** What is asked of the workers, and in which order. */

import { startOfResponse, startOfChain } from "./diagram.js";
import { joinOrders } from "./worker_pool.js";

/** Indices of a list, coarse ones first. @param {number} count */
export function indicesCoarseFirst(count) {
  const found = [];
  for (let step = 32; step >= 1; step /= 2) {
    for (let i = 0; i < count; i += step) {
      if (step === 32 || i % (2 * step) !== 0) found.push(i);
    }
  }
  return found;
}

/** Every `size`-th of a list, from each of the first on; no empty shares. @template T @param {T[]} list @param {number} size */
export function dealOut(list, size) {
  return Array.from({ length: Math.min(size, list.length) }, (_, first) => list.filter((_, i) => i % size === first));
}

/**
 * Compute what a diagram lacks: each response from where it is known to begin, else from the end of the one before.
 * @param {WorkerPool} pool
 * @param {Diagram} diagram
 * @param {Diagram | null} parent where the first may begin from
 * @param {Take} take
 */
export function requestDiagram(pool, diagram, parent, take) {
  const { points, lanes, settings } = diagram;
  const orders = lanes.map((lane) => {
    /** @param {number[]} indices @param {number[][]} starts of each, or of the first */
    const share = (indices, starts) => ({ indices, points: indices.map((i) => points[i]), starts: Float64Array.from(starts.flat()), settings });
    const shares = [];
    if (lane.starts) {
      const missing = indicesCoarseFirst(points.length).filter((i) => !lane.found[i]);
      for (const indices of dealOut(missing, pool.workers.length)) shares.push(share(indices, indices.map((i) => startOfResponse(lane, i) ?? [])));
    } else {
      const indices = points.map((_, i) => i);
      if (lane.direction === "down") indices.reverse();
      lane.from = startOfChain(parent, points[indices[0]], lane.direction);
      shares.push(share(indices, [lane.from]));
    }
    return pool.askAll("responses", shares, (parts) => {
      for (const found of parts) {
        lane.found[found.index] = found;
        take(lane, found);
      }
    });
  });
  return joinOrders(orders);
}
