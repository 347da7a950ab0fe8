/** Axes: from numbers to pixels, and the ticks between. */

/** @param {Axis} axis @param {number} from @param {number} to @returns {(value: number) => number} */
export function axisToPixels({ low, high, log }, from, to) {
  if (!log) return (value) => from + ((value - low) / (high - low)) * (to - from);
  const [bottom, top] = [Math.log(low), Math.log(high)];
  return (value) => from + ((Math.log(value) - bottom) / (top - bottom)) * (to - from);
}

/** Round numbers between the ends, about `wanted` of them. @param {Axis} axis @param {number} wanted */
export function axisTicks({ low, high, log }, wanted) {
  return log ? powerOfTenTicks(low, high, wanted) : evenTicks(low, high, wanted);
}

/** @param {number} low @param {number} high @param {number} wanted */
function evenTicks(low, high, wanted) {
  const step = niceStep((high - low) / Math.max(wanted, 1));
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    found.push(Number((i * step).toPrecision(12)));
  }
  return found;
}

/** @param {number} low @param {number} high @param {number} wanted */
function powerOfTenTicks(low, high, wanted) {
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  if (last <= first) return evenTicks(low, high, wanted).filter((value) => value > 0);
  const every = Math.max(1, Math.ceil((last - first + 1) / wanted));
  const found = [];
  for (let power = first; power <= last; power += every) found.push(Number(`1e${power}`));
  return found;
}

/** The next of 1, 2, 5 times a power of ten. @param {number} least */
export function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  const factor = [1, 2, 5, 10].find((one) => one * power >= least * 0.999999) ?? 10;
  return factor * power;
}

/** A tick as people write it; powers of ten as such on a logarithmic axis. @param {number} value @param {Axis} axis */
export function tickText(value, { log }) {
  const power = Math.log10(value);
  if (!log || (power > -2.5 && power < 3.5) || !Number.isInteger(Math.round(power * 1e9) / 1e9)) return formatNumber(value, 6);
  const digits = [...String(Math.abs(Math.round(power)))].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]);
  return `10${power < 0 ? "⁻" : ""}${digits.join("")}`;
}

/** A number as people write it, in up to `digits` digits. @param {number} value @param {number} digits */
export function formatNumber(value, digits = 4) {
  if (!Number.isFinite(value)) return value < 0 ? "−∞" : value > 0 ? "∞" : "none";
  return String(Number(value.toPrecision(digits))).replace(/e\+?/, "e").replace("-", "−");
}
