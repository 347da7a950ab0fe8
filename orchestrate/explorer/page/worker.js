/** A worker: computes tasks in short slices, an urgent one first, else the newest and the one before in turn. */

import { Library } from "./kernel.js";
import { useLibrary } from "./model.js";
import { performTask } from "./tasks.js";

const SLICE = 8; // ms

/** @type {Library} */
let library;
/** @type {{id: number, urgent: boolean, run: Generator<unknown>}[]} */
const tasks = [];
const wake = new MessageChannel();
let awake = false;
let turn = 1;
const scope = /** @type {{onmessage: unknown, postMessage: (message: unknown) => void}} */ (
  /** @type {unknown} */ (self)
);

scope.onmessage = (/** @type {MessageEvent} */ { data }) => {
  if (data.compiled) {
    library = new Library(data.compiled);
    useLibrary(library);
  }
  if (data.task) tasks.push({ id: data.id, urgent: data.urgent, run: performTask(data.task, data.asked, library) });
  if (data.cancel !== undefined) dropTask(data.cancel);
  wakeUp();
};

/** @param {number} id */
function dropTask(id) {
  const place = tasks.findIndex((task) => task.id === id);
  if (place >= 0) tasks.splice(place, 1)[0].run.return(undefined);
}

function wakeUp() {
  if (!awake && tasks.length) {
    awake = true;
    wake.port2.postMessage(null); // lets messages that wait come first
  }
}

wake.port1.onmessage = () => {
  awake = false;
  turn = 1 - turn;
  const task = tasks.find(({ urgent }) => urgent) ?? tasks[tasks.length - 1 - turn] ?? tasks[0];
  if (!task) return;
  const message = runSlice(task);
  if (message.done) dropTask(task.id);
  scope.postMessage(message);
  wakeUp();
};

/** @param {{id: number, run: Generator<unknown>}} task */
function runSlice({ id, run }) {
  const end = performance.now() + SLICE;
  /** @type {unknown[]} */
  const parts = [];
  try {
    do {
      const { value, done } = run.next();
      if (done) return { id, parts, done: true };
      if (value !== undefined) parts.push(value); // else it only pauses
    } while (performance.now() < end);
    return { id, parts, done: false };
  } catch (error) {
    return { id, parts, done: true, error: String(error) };
  }
}
