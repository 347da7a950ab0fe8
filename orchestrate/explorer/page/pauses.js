/** Pauses in a long computation, counted by its work: a worker may do other things there. */

const MOST = 10000; // impacts and steps between two pauses: a few milliseconds
export const PIECE = 100; // periods of one step of a transient, at most

/** Of an instance that others use too: after a pause it stands where it stood before. */
export class Pauses {
  /** @param {Instance} instance that has begun */
  constructor(instance) {
    this.instance = instance;
    this.steps = 0;
    this.impacts = instance.get("impact_count");
  }

  /** Pause where enough was done since the last one. @param {number} steps that were done @returns {Generator<undefined, void>} */
  *after(steps) {
    const { instance } = this;
    const impacts = instance.get("impact_count");
    this.steps += steps;
    if (this.steps + impacts - this.impacts < MOST) return;
    Object.assign(this, { steps: 0, impacts });
    const kept = instance.memory.slice();
    yield;
    instance.memory.set(kept);
  }
}
