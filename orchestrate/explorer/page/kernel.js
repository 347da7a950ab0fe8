/** Kernels in WebAssembly: an instance each, driven as the FMU drives it. */

import { fromRest } from "./clearance.js";

/**
 * @typedef {{SIZE: number, TIME: number, STOP: number, SET: number, CUBIC: number, CUBIC_END: number,
 *   [name: string]: number}} Slots
 * @typedef {{module: WebAssembly.Module, slots: Slots, starts: Record<string, number>}} Compiled
 * @typedef {[number, number, number, number]} State x1, x2 in m, v1, v2 in m/s
 */

const ROOM = 200; // states that a step can keep

/** Entry points and memory of a compiled kernel, with one instance in it. */
export class Instance {
  /** @param {Compiled} compiled */
  constructor({ module, slots, starts }) {
    const { exports } = new WebAssembly.Instance(module);
    const memory = /** @type {WebAssembly.Memory} */ (exports.memory);
    const base = /** @type {WebAssembly.Global} */ (exports.__heap_base).value;
    this.address = Math.ceil(base / 16) * 16;
    const missing = this.address + 8 * slots.SIZE - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / 65536));
    this.memory = new Float64Array(memory.buffer, this.address, slots.SIZE);
    this.slots = slots;
    this.starts = starts;
    this.entries = /** @type {Record<string, (address: number, time: number) => number>} */ (
      /** @type {unknown} */ (exports)
    );
  }

  /** @param {string} name */
  get(name) {
    return this.memory[this.slots[name]];
  }

  /** As the FMU's setters do: a cubic input begins where it is set. @param {Record<string, number>} values by variable */
  set(values) {
    const { SET, CUBIC, CUBIC_END } = this.slots;
    for (const name in values) {
      const slot = this.slots[name];
      this.memory[slot] = values[name];
      if (CUBIC <= slot && slot < CUBIC_END) this.memory[SET] = 1;
    }
  }

  /** Reset and initialise at time 0. @param {Record<string, number>} values by variable */
  initialize(values) {
    this.memory.fill(0);
    this.set(this.starts);
    this.set(values);
    this.call("kernel_initialize", 0);
  }

  /** @param {string} name @param {number} time */
  call(name, time) {
    const code = this.entries[name](this.address, time);
    if (code !== 0) throw new Error(`the kernel stopped at ${time} s with code ${code}`);
  }

  /**
   * One communication step from `time` to `target`, rounded as an importer's call rounds it.
   * @param {number} time
   * @param {number} target
   * @param {boolean} stop whether to end at the first event
   * @returns {number} the time reached
   */
  step(time, target, stop = false) {
    return this.stepBy(time, target - time, stop);
  }

  /** @param {number} time @param {number} h length of the step @param {boolean} stop */
  stepBy(time, h, stop = false) {
    const { TIME, STOP } = this.slots;
    const reached = this.memory[TIME];
    this.memory[STOP] = stop ? 1 : 0;
    this.call("kernel_advance", Math.max(time + h, reached));
    if (this.memory[TIME] < reached) this.memory[TIME] = reached;
    return this.memory[TIME];
  }
}

/** `TwoMassImpactOscillator`. */
export class Oscillator extends Instance {
  /** Begin at phase 0. @param {Point} point @param {Iterable<number>} start */
  begin(point, start) {
    const [x1, x2, v1, v2] = fromRest(start, point.structure);
    this.initialize({
      ...point.structure,
      x1_start: x1,
      x2_start: x2,
      v1_start: v1,
      v2_start: v2,
      box_amplitude: point.amplitude,
      box_frequency: point.frequency,
      x_rel_max_on: 0,
    });
  }

  /** @returns {State} */
  state() {
    const first = this.slots.x1;
    return /** @type {State} */ (Array.from(this.memory.subarray(first, first + 4)));
  }

  /**
   * States at equal parts of a span, the last at its end, taken inside few steps.
   * @param {number} count
   * @param {(index: number) => number} time of the end of part `index`, 0 for the span's start
   * @returns {{states: Float64Array, peak: number}} four numbers a state; largest gap if watched
   */
  sampled(count, time) {
    const states = new Float64Array(4 * count);
    let peak = 0;
    for (let done = 0; done < count; done += ROOM) {
      const size = Math.min(ROOM, count - done);
      this.set({ sample_count: size });
      this.step(time(done), time(done + size));
      this.keep(states, done, size);
      peak = Math.max(peak, this.get("x_rel_max"));
    }
    this.set({ sample_count: 0 });
    return { states, peak };
  }

  /** @param {Float64Array} states @param {number} done @param {number} size */
  keep(states, done, size) {
    ["x1_sample", "x2_sample", "v1_sample", "v2_sample"].forEach((name, part) => {
      const first = this.slots[name];
      for (let i = 0; i < size; i++) states[4 * (done + i) + part] = this.memory[first + i];
    });
  }
}
