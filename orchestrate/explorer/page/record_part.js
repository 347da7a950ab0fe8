/** A record that is dropped on the page: read by a worker, its spectrum laid over the model's. */

import { shown } from "./scale.js";

const LARGEST = 60e6; // bytes

/**
 * Take files that are dropped anywhere on the page, or chosen.
 * @param {(id: string) => HTMLElement} at
 * @param {WorkerPool} pool
 * @param {(measured: Measured) => void} take
 */
export function acceptRecords(at, pool, take) {
  const chosen = /** @type {HTMLInputElement} */ (at("record"));
  /** @param {FileList | null | undefined} files */
  const open = (files) => files?.length && read(files[0], pool, take, (words) => (at("record-status").textContent = words));
  chosen.addEventListener("change", () => open(chosen.files));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    open(event.dataTransfer?.files);
  });
}

/** @param {File} file @param {WorkerPool} pool @param {(measured: Measured) => void} take @param {(words: string) => void} say */
function read(file, pool, take, say) {
  if (file.size > LARGEST) return say(`${file.name}: ${shown(file.size / 1e6, 3)} MB; expected at most ${LARGEST / 1e6}`);
  say(`${file.name} …`);
  pool.ask("record", { file }, ([reading]) => {
    if ("error" in reading) return say(`${file.name}: ${reading.error}`);
    const { column, unit, count, rate } = reading;
    say(`${file.name}: ${column} in ${unit}; ${count} values, ${shown(rate)} a second`);
    take(reading);
  });
}
