/** What is asked of the workers, and in which order. */

import { startOfResponse, startOfChain } from "./diagram.js";
import { columnsAt } from "./structure.js";

/** @typedef {(lane: Lane, found: Found) => void} Take */

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

/** Every `size`-th of a list, from each of the first on. @template T @param {T[]} list @param {number} size */
export function dealOut(list, size) {
  return Array.from({ length: size }, (_, first) => list.filter((_, i) => i % size === first));
}

/** Compute what a diagram still lacks, each response from where it is known to begin. @param {WorkerPool} pool @param {Diagram} diagram @param {Take} take @returns {Order} */
export function requestReplay(pool, diagram, take) {
  const orders = diagram.lanes.map((lane) => {
    const missing = indicesCoarseFirst(diagram.points.length).filter((i) => !lane.found[i]);
    const groups = dealOut(missing, pool.workers.length).filter((indices) => indices.length);
    const asked = groups.map((indices) => ({
      indices,
      columns: columnsAt(diagram.points, indices),
      starts: Float64Array.from(indices.flatMap((i) => startOfResponse(lane, i) ?? [])),
      settings: diagram.settings,
    }));
    return pool.askAll("replay", asked, (parts) => parts.forEach((part) => enterResponse(lane, part, take)));
  });
  return joinOrders(orders);
}

/** Compute a diagram, each response from the end of the last. @param {WorkerPool} pool @param {Diagram} diagram @param {Diagram | null} parent where the first may begin from @param {Take} take @returns {Order} */
export function requestChain(pool, diagram, parent, take) {
  const orders = diagram.lanes.map((lane) => {
    const indices = diagram.points.map((_, i) => i);
    if (lane.direction === "down") indices.reverse();
    const columns = columnsAt(diagram.points, indices);
    lane.from = startOfChain(parent, diagram.points[indices[0]], lane.direction);
    const asked = { indices, columns, start: lane.from, settings: diagram.settings };
    return pool.ask("chain", asked, (parts) => parts.forEach((part) => enterResponse(lane, part, take)));
  });
  return joinOrders(orders);
}

/** @param {Lane} lane @param {Found} found @param {Take} take */
function enterResponse(lane, found, take) {
  lane.found[found.index] = found;
  take(lane, found);
}

/** @param {Order[]} orders @returns {Order} */
function joinOrders(orders) {
  return {
    cancel: () => orders.forEach((order) => order.cancel()),
    done: Promise.all(orders.map((order) => order.done)).then(() => {}),
  };
}
