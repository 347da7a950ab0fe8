/** The workers: tasks are handed to them, parts of answers come back, tasks can be called off. */

/** As many workers as cores, less one for the page, and at most four. */
export function workerCount() {
  return Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1));
}

export class WorkerPool {
  /** @param {string} source of the worker @param {Compiled} compiled @param {number} size */
  constructor(source, compiled, size) {
    const place = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.number = 0;
    /** @type {Map<number, (message: any) => void>} */
    this.waiting = new Map();
    /** @type {(text: string, task: string) => void} */
    this.onerror = () => {};
    this.workers = Array.from({ length: size }, () => {
      const worker = new Worker(place);
      worker.postMessage({ compiled });
      worker.onmessage = ({ data }) => this.waiting.get(data.id)?.(data);
      return worker;
    });
  }

  /** Worker least recently given something to do. */
  nextWorker() {
    this.workers.push(/** @type {Worker} */ (this.workers.shift()));
    return this.workers[this.workers.length - 1];
  }

  /**
   * Have a task computed.
   * @param {string} task
   * @param {unknown} asked
   * @param {(parts: any[]) => void} onparts
   * @param {boolean} [urgent] whether someone waits for it: it comes before all that is not
   * @returns {Order}
   */
  ask(task, asked, onparts, urgent = false) {
    const id = ++this.number;
    const worker = this.nextWorker();
    worker.postMessage({ id, task, asked, urgent });
    /** @type {() => void} */
    let finish = () => {};
    const done = /** @type {Promise<void>} */ (new Promise((resolve) => (finish = () => resolve())));
    const leave = () => {
      this.waiting.delete(id);
      finish();
    };
    this.waiting.set(id, (message) => {
      if (message.parts.length) onparts(message.parts);
      if (message.error) this.onerror(message.error, task);
      if (message.done) leave();
    });
    const cancel = () => {
      if (this.waiting.has(id)) worker.postMessage({ cancel: id });
      leave();
    };
    return { cancel, done };
  }

  /** Have several tasks computed as one. @param {string} task @param {unknown[]} shares @param {(parts: any[]) => void} onparts */
  askAll(task, shares, onparts) {
    return joinOrders(shares.map((asked) => this.ask(task, asked, onparts)));
  }
}

/** Several orders as one. @param {Order[]} orders @returns {Order} */
export function joinOrders(orders) {
  return {
    cancel: () => orders.forEach((order) => order.cancel()),
    done: Promise.all(orders.map((order) => order.done)).then(() => {}),
  };
}
