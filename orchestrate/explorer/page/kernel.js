/** FMUs in WebAssembly and the compiled loops over them: what Python does by ctypes. */

import { omegaOf } from "./structure.js";

const WIDTH = { u32: 4, i32: 4, f64: 8, u8: 1 };
const [PAUSED, BROKEN] = [1, 2]; // what a loop answers
export const WORK = 10000; // periods, steps and impacts between two pauses: a few milliseconds
const PIECE = 100; // periods of one step of a transient, at most
const DEVIATED = ["x1", "x2", "v1", "v2", "impact_velocity"];
const SAMPLED = 4; // periods of a spectrum's states between two pauses
const IMPACTS = 4096; // that a loop keeps until it pauses
const MODEL = "oscillator";

/** The compiled models and loops, and memory for any number of instances. */
export class Library {
  /** @param {Compiled} compiled */
  constructor({ module, variables, loops }) {
    this.variables = variables;
    this.loops = loops;
    const { exports } = new WebAssembly.Instance(module);
    this.calls = /** @type {Record<string, (...numbers: number[]) => number>} */ (/** @type {unknown} */ (exports));
    this.memory = /** @type {WebAssembly.Memory} */ (exports.memory);
    this.places = /** @type {Record<string, WebAssembly.Global>} */ (/** @type {unknown} */ (exports));
    this.calls._initialize();
  }

  /** What an FMU said last. */
  lastMessage(model = MODEL) {
    const bytes = new Uint8Array(this.memory.buffer, this.places[`${model}_message`].value);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  /** @param {Kind} kind @param {number} address @param {number} count */
  viewMemory(kind, address, count) {
    const type = { u32: Uint32Array, i32: Int32Array, f64: Float64Array, u8: Uint8Array }[kind];
    return new type(this.memory.buffer, address, count);
  }

  /** Call with arrays in the memory, which are freed then. @template T @param {(buffers: Buffers) => T} run @returns {T} */
  withBuffers(run) {
    const buffers = new Buffers(this);
    try {
      return run(buffers);
    } finally {
      buffers.free();
    }
  }

  /** Numbers that have come. @param {number} address @param {number} count */
  copyNumbers(address, count) {
    return new Float64Array(/** @type {Float64Array} */ (this.viewMemory("f64", address, count)));
  }
}

/** Arrays and structures of C in a library's memory, freed together. */
export class Buffers {
  /** @param {Library} library */
  constructor(library) {
    this.library = library;
    this.taken = /** @type {number[]} */ ([]);
  }

  /** @param {number} bytes */
  allocate(bytes) {
    const address = this.library.calls.malloc(Math.max(bytes, 8));
    if (!address) throw new Error("out of memory");
    this.taken.push(address);
    return address;
  }

  /** An array of numbers, or of zeros where their count is given. @param {Kind} kind @param {ArrayLike<number> | number} values */
  array(kind, values) {
    const count = typeof values === "number" ? values : values.length;
    const address = this.allocate(count * WIDTH[kind]);
    const view = this.library.viewMemory(kind, address, count);
    if (typeof values === "number") view.fill(0);
    else view.set(values);
    return address;
  }

  /** A structure with some of its fields set, the others zero. @param {string} name @param {Record<string, number>} values */
  newStructure(name, values) {
    const { size, fields } = this.library.loops.structures[name];
    const address = this.array("u8", size);
    const view = new DataView(this.library.memory.buffer, address, size);
    for (const field in values) {
      const [kind, place] = fields[field];
      if (kind === "f64") view.setFloat64(place, values[field], true);
      else if (kind === "u8") view.setUint8(place, values[field]);
      else view.setUint32(place, values[field], true);
    }
    return address;
  }

  /** Value references as an array of C. @param {string[]} names */
  valueReferences(names, model = MODEL) {
    return this.array("u32", names.map((name) => this.library.variables[model][name]));
  }

  /** A row of what a structure under an excitation is for the loops. @param {Point} point */
  traitsRow({ structure, frequency, amplitude }) {
    const { loops, calls } = this.library;
    const pushed = Number(loadsOf(structure, loops).some(([, value]) => value !== 0));
    /** @type {Record<string, number>} */
    const known = { ...structure, omega: omegaOf(structure), frequency, amplitude, pushed };
    const row = this.array("f64", loops.traits.map((name) => known[name] ?? 0));
    calls.rest_and_threshold(row);
    return row;
  }

  free() {
    this.taken.forEach((address) => this.library.calls.free(address));
    this.taken = [];
  }
}

/** Loads other than the box's harmonic motion, by the FMU's inputs. @param {Structure} structure @param {Loops} loops @returns {[string, number][]} */
function loadsOf(structure, { pushes }) {
  /** @type {Record<string, number>} */
  const known = { ...structure };
  return Object.entries(pushes).map(([name, input]) => [input, known[name] ?? 0]);
}

/** An instance of `TwoMassImpactOscillator`, with the loops that run it; to be closed. */
export class Oscillator {
  /** @param {Library} library @param {boolean} [stops] whether steps end at its events */
  constructor(library, stops = false) {
    this.library = library;
    this.buffers = new Buffers(library);
    const { reals, booleans, read, series, capacity } = library.loops;
    this.own = this.buffers.newStructure("OscillatorCalls", {
      ...{ reals: this.buffers.valueReferences(reals), booleans: this.buffers.valueReferences(booleans), series: this.buffers.valueReferences(series) },
      ...{ real_count: reals.length, boolean_count: booleans.length, start: reals.indexOf("x1_start") },
      ...{ series_count: series.length, capacity, kept: this.buffers.array("f64", series.length * capacity) },
      ...Object.fromEntries(read.map((name) => [name, library.variables.oscillator[name]])),
    });
    if (!library.calls.oscillator_open_fmu(this.own, Number(stops))) throw new Error(library.lastMessage() || "out of memory");
  }

  close() {
    this.library.calls.oscillator_close_fmu(this.own);
    this.buffers.free();
  }

  /** Call a loop until it is done. @param {string} name @param {number[]} numbers @returns {Generator<undefined, void>} it pauses */
  *loop(name, ...numbers) {
    for (;;) {
      const answer = this.library.calls[name](...numbers);
      if (answer === BROKEN) throw new Error(this.library.lastMessage() || `${name} stopped`);
      if (answer !== PAUSED) return;
      yield;
    }
  }

  /** What there is to compute: one response. @param {Buffers} buffers @param {Point} point @param {Iterable<number>} start @param {Record<string, number>} more */
  responseTask(buffers, point, start, more) {
    const { loops } = this.library;
    const { set, reals, booleans } = loops;
    const { structure, frequency, amplitude } = point;
    const pushes = Object.fromEntries(loadsOf(structure, loops));
    /** @type {Record<string, number>} */
    const values = { ...set, ...structure, ...pushes, box_frequency: frequency, box_amplitude: amplitude };
    return buffers.newStructure("ResponseTask", {
      ...{ count: 1, piece: PIECE, traits: buffers.traitsRow(point), starts: buffers.array("f64", Array.from(start)) },
      reals: buffers.array("f64", reals.map((name) => values[name])),
      booleans: buffers.array("u8", booleans.map((name) => values[name])),
      periods: buffers.array("f64", [(2 * Math.PI) / frequency]),
      ...more,
    });
  }

  /** Begin at phase 0. @param {Point} point @param {Iterable<number>} start */
  initialize(point, start) {
    const begun = this.library.withBuffers((buffers) => this.library.calls.begin(this.own, this.responseTask(buffers, point, start, {}), 0));
    if (!begun) throw new Error(this.library.lastMessage());
  }

  /**
   * Amplitudes of mass 1's absolute acceleration, impulses included, of the motion that continues from where the instance stands.
   * @param {Point} point
   * @param {number} first periods since the start
   * @param {{periods: number, points: number, highest: number}} span
   * @returns {Generator<undefined, Spectrum>} it pauses
   */
  *spectrum(point, first, { periods, points, highest }) {
    const { library } = this;
    const buffers = new Buffers(library);
    const [period, count] = [(2 * Math.PI) / point.frequency, periods * points];
    try {
      const states = buffers.array("f64", 4 * count);
      for (let done = 0; done < periods; done += SAMPLED) {
        const [time, target] = [first + done, first + done + SAMPLED].map((periods) => periods * period);
        if (!library.calls.sample_evenly(this.own, time, target, points * SAMPLED, states + 32 * points * done)) throw new Error(library.lastMessage());
        yield;
      }
      const [memory, amplitudes] = [library.calls.spectrum_size(count), count / 2 + 1].map((size) => buffers.array("f64", size));
      library.calls.acceleration_spectrum(states, 4, count, periods, point.frequency, point.amplitude, memory, amplitudes);
      const amplitude = library.copyNumbers(amplitudes, highest * periods + 1);
      return { order: Float64Array.from(amplitude, (_, line) => line / periods), amplitude };
    } finally {
      buffers.free();
    }
  }

  /**
   * Play from event to event, from a time to the last of some times, of an instance that stops.
   * @param {number} from
   * @param {Float64Array} times
   * @param {string[]} outputs read at the times
   * @param {string[]} told read at impacts
   * @returns {Generator<undefined, {rows: Float64Array, contact: Uint8Array, impacts: number[][]}>} of each impact its time, what is told, and whether contact begins
   */
  *play(from, times, outputs, told) {
    const buffers = new Buffers(this.library);
    const width = told.length + 2;
    try {
      const player = buffers.newStructure("PlayerCalls", {
        ...{ outputs: buffers.valueReferences(outputs), impact_outputs: buffers.valueReferences(told), contact: buffers.valueReferences(["in_contact"]) },
        ...{ output_count: outputs.length, impact_output_count: told.length },
      });
      const { PlayerCalls, PlayProgress } = this.library.loops.structures;
      const fmi = PlayerCalls.fields.inputs[1]; // it comes first
      this.library.viewMemory("u8", player, fmi).set(this.library.viewMemory("u8", this.own, fmi));
      const places = {
        rows: buffers.array("f64", outputs.length * times.length),
        ...{ contacts: buffers.array("u8", times.length), impacts: buffers.array("f64", width * IMPACTS) },
      };
      const task = buffers.newStructure("PlayTask", {
        ...{ nodes: buffers.array("f64", [from, times[times.length - 1]]), samples: buffers.array("f64", times) },
        ...{ piece_count: 1, sample_count: times.length, impact_capacity: IMPACTS, max_steps: WORK, ...places },
      });
      const progress = buffers.newStructure("PlayProgress", { time: from });
      const kept = PlayProgress.fields.impact[1] / WIDTH.u32;
      /** @type {number[][]} */
      const impacts = [];
      const take = () => {
        const count = this.library.viewMemory("u32", progress, kept + 1)[kept];
        const rows = this.library.viewMemory("f64", places.impacts, width * count);
        for (let i = 0; i < count; i++) impacts.push(Array.from(rows.subarray(width * i, width * (i + 1))));
      };
      for (const _ of this.loop("play", player, task, progress)) {
        take();
        yield;
      }
      take();
      return {
        rows: this.library.copyNumbers(places.rows, outputs.length * times.length),
        contact: new Uint8Array(this.library.viewMemory("u8", places.contacts, times.length)),
        impacts,
      };
    } finally {
      buffers.free();
    }
  }

  /**
   * The largest Lyapunov exponent per unit of tau, of an instance that stops: over a number of periods, or twice as many
   * again and again while it is undecided.
   * @param {Point} point
   * @param {number[]} start on the attractor, at phase 0
   * @returns {Generator<undefined, Exponent | null>} nothing of too few impacts; it pauses
   */
  *exponent(point, start) {
    const { periods, longest, most, batches } = this.library.loops.exponent;
    const period = (2 * Math.PI) / point.frequency;
    /** @type {number[][]} */
    const impacts = [];
    this.initialize(point, start);
    for (let done = 0, end = periods; ; done = end, end *= 2) {
      const span = yield* this.play(done * period, Float64Array.of(end * period), [], DEVIATED);
      for (const impact of span.impacts) impacts.push(impact);
      if (impacts.length < 2 * batches) return null;
      const found = this.exponentOfImpacts(point, impacts, end * period);
      if (found.verdict || 2 * end > longest || impacts.length > most) return found;
    }
  }

  /** @param {Point} point @param {number[][]} impacts @param {number} end s @returns {Exponent} */
  exponentOfImpacts(point, impacts, end) {
    const { calls, loops } = this.library;
    const { blocks, batches, sigmas, wander } = loops.exponent;
    const buffers = new Buffers(this.library);
    /** @type {Record<string, number>} */
    const known = { ...point.structure };
    const numbers = buffers.array("f64", [...loops.deviating.map((name) => known[name] ?? 0), point.amplitude, point.frequency, ...loadsOf(point.structure, loops).map(([, value]) => value)]);
    const rows = buffers.array("f64", impacts.flat());
    const [memory, found] = [calls.exponent_size(impacts.length), 2].map((size) => buffers.array("f64", size));
    calls.largest_exponent(numbers, rows, impacts.length, end, blocks, batches, memory, found);
    const [value, error] = this.library.viewMemory("f64", found, 2);
    buffers.free();
    const floor = calls.wander_floor(wander, omegaOf(point.structure) * end);
    return { value, error, verdict: calls.classify_exponent(value, error, floor, sigmas) };
  }
}
