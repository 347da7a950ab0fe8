/** A measured record: columns of text with a time and an acceleration, and its spectrum. */

import { GRAVITY } from "./excitation.js";
import { transform } from "./spectrum.js";

/**
 * @typedef {{frequency: Float64Array, amplitude: Float64Array, column: string, unit: string,
 *   count: number, rate: number}} Measured spectrum in Hz and m/s2, and what it was read from
 * @typedef {{error: string} | Measured} Reading
 */

const SEPARATORS = [";", "\t", ",", /\s+/];
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const LONGEST = 2 ** 21; // values
const FEWEST = 16;
const MANY = 2 ** 19; // lines of a spectrum
const UNEVEN = 0.05; // of a step
/** @type {Record<string, number>} */
const ACCELERATIONS = { "m/s2": 1, "m/s/s": 1, g: GRAVITY, mg: 1e-3 * GRAVITY, "mm/s2": 1e-3 };
/** @type {Record<string, number>} */
const TIMES = { s: 1, sec: 1, ms: 1e-3, us: 1e-6, "µs": 1e-6 };
const TIME_NAMES = ["time", "t", "zeit"];
const NAMES = ["acceleration1", "mass1", "a1", "acc1", "accel1", "a1abs"]; // else the first column
const EXPECTED = "expected columns of numbers under a heading such as t [s], a1 [g]";

/** What a text says, or in one line why it cannot be read. @param {string} text @returns {Reading} */
export function readRecord(text) {
  const lines = text.split(/\r\n|\r|\n/).filter((line) => line.trim());
  const found = tableOf(lines);
  if (!found) return { error: `no columns of numbers in it; ${EXPECTED}` };
  const { heading, rows, first } = found;
  if (rows.length > LONGEST) return { error: `${rows.length} rows; expected at most ${LONGEST}` };
  if (rows.length < FEWEST) return { error: `${rows.length} rows of numbers; expected ${FEWEST} at least` };
  const bad = rows.findIndex((row) => row.length !== rows[0].length || row.some((value) => !Number.isFinite(value)));
  if (bad >= 0) return { error: `line ${first + bad + 1} "${lines[first + bad].slice(0, 40)}" has no ${rows[0].length} numbers` };
  const time = Math.max(heading.findIndex(({ name }) => TIME_NAMES.includes(name)), 0);
  const named = heading.findIndex(({ name }) => NAMES.includes(name));
  const column = named >= 0 ? named : time === 0 ? 1 : 0;
  const scales = [TIMES[heading[time].unit || "s"], ACCELERATIONS[heading[column].unit || "m/s2"]];
  const wrong = [time, column][scales.indexOf(/** @type {any} */ (undefined))];
  if (wrong !== undefined) {
    const known = Object.keys(wrong === time ? TIMES : ACCELERATIONS).join(", ");
    return { error: `unit "${heading[wrong].unit}" of column ${wrong + 1}; expected one of ${known}` };
  }
  const times = rows.map((row) => row[time] * scales[0]);
  const step = (times[times.length - 1] - times[0]) / (times.length - 1);
  const uneven = times.findIndex((t, i) => Math.abs(t - times[0] - i * step) > UNEVEN * Math.abs(step));
  if (!(step > 0) || uneven >= 0) return { error: `column ${time + 1} is no time in equal steps, line ${first + Math.max(uneven, 0) + 1}` };
  const values = Float64Array.from(rows, (row) => row[column] * scales[1]);
  const unit = heading[column].unit || "m/s2, as no unit is in its heading";
  return { ...amplitudes(values, step), column: heading[column].text || `column ${column + 1}`, unit, count: rows.length, rate: 1 / step };
}

/** The largest amplitude in each of `count` parts up to a frequency: what a picture can show. @param {Measured} measured @param {number} high Hz @param {number} count */
export function peaksUpTo({ frequency, amplitude }, high, count) {
  const used = Math.min(frequency.length, Math.ceil(high / frequency[1]) + 1);
  const wide = Math.max(1, Math.ceil(used / count));
  /** @type {number[][]} */
  const [x, y] = [[], []];
  for (let i = 0; i < used; i += wide) {
    let top = i;
    for (let k = i; k < Math.min(i + wide, used); k++) if (amplitude[k] > amplitude[top]) top = k;
    x.push(frequency[top]);
    y.push(amplitude[top]);
  }
  return { x: Float64Array.from(x), y: Float64Array.from(y) };
}

/** Numbers of a text, what stands above them, and the line of the first. @param {string[]} lines */
function tableOf(lines) {
  for (let first = 0; first < Math.min(lines.length, 200); first++) {
    for (const separator of SEPARATORS) {
      const comma = separator !== "," && /\d,\d/.test(lines[first]) && !lines[first].includes(".");
      /** @param {string} line */
      const fields = (line) => line.trim().split(separator).map((field) => field.trim()).filter((field, i, all) => field || i < all.length - 1);
      /** @param {string} field */
      const number = (field) => {
        const plain = comma ? field.replace(",", ".") : field;
        return NUMBER.test(plain) ? Number(plain) : NaN;
      };
      const numbers = fields(lines[first]).map(number);
      if (numbers.length < 2 || !numbers.every(Number.isFinite)) continue;
      const above = first ? fields(lines[first - 1].replace(/^[#%]\s*/, "")) : [];
      const heading = numbers.map((_, i) => headingOf(above.length === numbers.length ? above[i] : ""));
      return { heading, first, rows: lines.slice(first).map((line) => fields(line).map(number)) };
    }
  }
  return null;
}

/** @param {string} text such as `Acc 1 [g]` */
function headingOf(text) {
  const [, name, unit] = /^"?(.*?)(?:[\s_]*[[(]([^\])]*)[\])])?"?$/.exec(text) ?? ["", text, ""];
  const plain = (unit ?? "").trim().toLowerCase().replace("²", "2").replace(/[\^*_. ·]/g, "");
  return { text: name.trim(), name: name.toLowerCase().replace(/[^a-z0-9]/g, ""), unit: plain };
}

/** Amplitude spectrum with a Hann window, filled with zeros so that no line falls between two. @param {Float64Array} values @param {number} step s */
function amplitudes(values, step) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const whole = 2 ** Math.ceil(Math.log2(values.length));
  const size = Math.max(whole, Math.min(8 * whole, MANY));
  const [real, imaginary] = [new Float64Array(size), new Float64Array(size)];
  values.forEach((value, i) => (real[i] = (value - mean) * (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / values.length))));
  transform(real, imaginary);
  const half = size / 2;
  const frequency = Float64Array.from({ length: half }, (_, line) => line / (size * step));
  // the window's mean is a half, and half of a line is at the negative frequency
  const amplitude = frequency.map((_, line) => (4 * Math.hypot(real[line], imaginary[line])) / values.length);
  return { frequency, amplitude };
}
