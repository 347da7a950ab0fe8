/** Impacts as a waveform: each a click by its energy. */

const DECAY = 0.0025; // s
const RING = 1800; // Hz

/**
 * Clicks as a waveform.
 * @param {{time: ArrayLike<number>, energy: ArrayLike<number>, turns: number}} clicks time in periods
 * @param {number} pitch periods a second
 * @param {number} rate samples a second
 * @returns {Float32Array}
 */
export function waveform({ time, energy, turns }, pitch, rate) {
  const wave = new Float32Array(Math.ceil((turns / pitch) * rate));
  let most = 0;
  for (let i = 0; i < energy.length; i++) most = Math.max(most, energy[i]);
  const length = Math.min(Math.ceil(6 * DECAY * rate), wave.length);
  for (let i = 0; i < time.length; i++) {
    const loud = Math.sqrt(energy[i] / most);
    if (!(loud > 1e-3)) continue;
    const first = Math.floor((time[i] / pitch) * rate);
    for (let k = 0; k < length; k++) {
      const t = k / rate;
      wave[(first + k) % wave.length] += loud * Math.exp(-t / DECAY) * Math.sin(2 * Math.PI * RING * t);
    }
  }
  const peak = wave.reduce((high, value) => Math.max(high, Math.abs(value)), 0);
  return peak > 0 ? wave.map((value) => (0.5 * value) / peak) : wave;
}
