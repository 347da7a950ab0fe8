/** What a worker computes, each task a generator that yields its answer part by part. */

import { followToAttractor, startOfCell } from "./basin.js";
import { Coupled } from "./coupled.js";
import { Oscillator } from "./kernel.js";
import { recordMotion } from "./motion.js";
import { computeResponse } from "./response.js";
import { periodOf } from "./structure.js";
import { waveform } from "./waveform.js";

const REST = [0, 0, 0, 0];
const SPAN = { periods: 64, points: 1024, highest: 20 };

/**
 * Responses at points.
 * @param {Oscillator} instance
 * @param {{points: Point[], starts: Float64Array, indices: number[], settings: Settings}} asked
 *   `starts`: of each, or of the first, and each other from the end of the one before
 */
function* computeResponses(instance, { points, starts, indices, settings }) {
  /** @type {Iterable<number>} */
  let start = [];
  for (let i = 0; i < indices.length; i++) {
    if (4 * i < starts.length) start = starts.subarray(4 * i, 4 * i + 4);
    const { states, ...found } = yield* computeResponse(instance, points[i], start, settings);
    start = found.end;
    yield { index: indices[i], ...found };
  }
}

/**
 * What is computed on an instance of its own, which stops at its events.
 * @template T
 * @param {Oscillator} instance
 * @param {(own: Oscillator) => Generator<undefined, T>} run
 * @returns {Generator<undefined, T>}
 */
function* withStoppingInstance({ library }, run) {
  const own = new Oscillator(library, true);
  try {
    return yield* run(own);
  } finally {
    own.close();
  }
}

/**
 * The response at a start and how it continues.
 * @param {Oscillator} instance
 * @param {{point: Point, start: number[], settings: Settings, periods: number, points: number}} asked
 */
function* computeMotion(instance, { point, start, settings, periods, points }) {
  const first = settings.transient + settings.samples;
  const response = yield* computeResponse(instance, point, start, settings);
  yield { response, motion: yield* withStoppingInstance(instance, (own) => recordMotion(own, point, start, first, periods, points)) };
}

/**
 * Further stroboscopic samples of a response, 200 at a time.
 * @param {Oscillator} instance
 * @param {{point: Point, start: number[], periods: number}} asked
 */
function* computeSection(instance, { point, start, periods }) {
  for (let done = 0; done < periods; done += 200) {
    const found = yield* computeResponse(instance, point, start, { transient: 0, samples: 200, tolerance: 1e-2 }, false);
    start = found.end;
    yield found.states;
  }
}

/**
 * Spectra of mass 1, delaminated from a state on the attractor and bonded, and the exponent.
 * @param {Oscillator} instance
 * @param {{point: Point, start: number[]}} asked
 */
function* computeSpectraAndExponent(instance, { point, start }) {
  instance.initialize(point, start);
  const delaminated = yield* instance.spectrum(point, 0, SPAN);
  if (point.structure.wall) yield { delaminated, bonded: null }; // nothing can be glued to it
  else {
    const glued = { ...point, structure: { ...point.structure, bonded: 1 } };
    yield* computeResponse(instance, glued, REST, { transient: 2000, samples: 1, tolerance: 1e-2 }, false);
    yield { delaminated, bonded: yield* instance.spectrum(glued, 2001, SPAN) };
  }
  yield { exponent: yield* withStoppingInstance(instance, (own) => own.exponent(point, start)) };
}

/**
 * The impacts of many periods as a waveform.
 * @param {Oscillator} instance
 * @param {{point: Point, start: number[], periods: number, pitch: number, rate: number}} asked
 */
function* computeSound(instance, { point, start, periods, pitch, rate }) {
  const { impactTime, impactEnergy } = yield* withStoppingInstance(instance, (own) => recordMotion(own, point, start, 0, periods, 1));
  const time = impactTime.map((t) => t / periodOf(point));
  yield waveform({ time, energy: impactEnergy, turns: periods }, pitch, rate);
}

/**
 * Some steps of the motor and the structure in its box, from where they were left, and the revolutions completed in them.
 * @param {Oscillator} instance
 * @param {{run: Run | null, start: Start, voltages: number[]}} asked a voltage for each step
 */
function* runDrive({ library }, { run, start, voltages }) {
  const coupled = new Coupled(library, start, run);
  try {
    const rows = coupled.runSteps(voltages);
    yield { rows, run: coupled.stateOfRun() };
  } finally {
    coupled.close();
  }
}

/**
 * Where the cells of a plane lead to.
 * @param {Oscillator} instance
 * @param {{point: Point, plane: Plane, cells: [number, number][]}} asked
 */
function* computeBasin(instance, { point, plane, cells }) {
  for (const [column, row] of cells) {
    yield { column, row, ...(yield* followToAttractor(instance, point, startOfCell(point, plane, column, row))) };
  }
}

/** @type {Record<string, (instance: Oscillator, asked: any) => Generator<unknown>>} */
const TASKS = {
  ...{ responses: computeResponses, motion: computeMotion, section: computeSection },
  ...{ spectra: computeSpectraAndExponent, sound: computeSound, drive: runDrive, basin: computeBasin },
};

/**
 * Run a task on an instance of its own.
 * @param {string} task
 * @param {unknown} asked
 * @param {Library} library
 * @returns {Generator<unknown>}
 */
export function* performTask(task, asked, library) {
  const instance = new Oscillator(library);
  try {
    yield* TASKS[task](instance, asked);
  } finally {
    instance.close();
  }
}
