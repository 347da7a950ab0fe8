/** Amplitude spectra of mass 1's absolute acceleration, impulses included: the paper's Figure 3. */

import { periodOf } from "./structure.js";

/** @typedef {{order: Float64Array, amplitude: Float64Array}} Spectrum lines over the excitation's */

const PIECE = 4096; // samples

/**
 * Of the motion that goes on from where the instance stands. The square of the frequency times the
 * displacement's spectrum has the impulses too, which no sampled acceleration has. The mean place
 * is taken away: the window would spread it over the next lines, and it moves nothing.
 * @param {Oscillator} instance
 * @param {Point} point
 * @param {number} first periods since the start
 * @param {{periods: number, points: number, highest: number}} span powers of two
 * @returns {Generator<undefined, Spectrum>} it pauses, so that the instance may do other things
 */
export function* spectrumOf(instance, point, first, { periods, points, highest }) {
  const period = periodOf(point);
  const count = periods * points;
  const real = new Float64Array(count);
  for (let done = 0; done < count; done += PIECE) {
    const states = instance.sampled((first + done / points) * period, (first + (done + PIECE) / points) * period, PIECE);
    for (let k = 0; k < PIECE; k++) {
      const i = done + k;
      const box = point.amplitude * Math.sin((2 * Math.PI * ((i + 1) % points)) / points);
      real[i] = states[4 * k] + box;
    }
    yield;
  }
  windowed(real);
  const imaginary = new Float64Array(count);
  transform(real, imaginary);
  const shown = Math.floor(highest * periods) + 1;
  const order = Float64Array.from({ length: shown }, (_, line) => line / periods);
  const amplitude = order.map((turns, line) => {
    const frequency = turns * point.frequency;
    return ((frequency * frequency * Math.hypot(real[line], imaginary[line])) / count) * 4;
  });
  return { order, amplitude };
}

/** A Hann window over what differs from the mean, in place. @param {Float64Array} values */
export function windowed(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  values.forEach((value, i) => (values[i] = (value - mean) * (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / values.length))));
}

/** Fast Fourier transform in place; the length is a power of two. @param {Float64Array} real @param {Float64Array} imaginary */
function transform(real, imaginary) {
  const count = real.length;
  for (let i = 1, j = 0; i < count; i++) {
    let bit = count >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [real[i], real[j]] = [real[j], real[i]];
      [imaginary[i], imaginary[j]] = [imaginary[j], imaginary[i]];
    }
  }
  for (let size = 2; size <= count; size *= 2) butterflies(real, imaginary, size);
}

/** @param {Float64Array} real @param {Float64Array} imaginary @param {number} size */
function butterflies(real, imaginary, size) {
  const half = size / 2;
  for (let k = 0; k < half; k++) {
    const angle = (-2 * Math.PI * k) / size;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    for (let i = k; i < real.length; i += size) {
      const j = i + half;
      const a = real[j] * c - imaginary[j] * s;
      const b = real[j] * s + imaginary[j] * c;
      real[j] = real[i] - a;
      imaginary[j] = imaginary[i] - b;
      real[i] += a;
      imaginary[i] += b;
    }
  }
}
