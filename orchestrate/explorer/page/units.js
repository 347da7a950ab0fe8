/** In which units a motion is shown: the paper's; of a beam of one's own Hz, mm, g and seconds, or what the page was asked for. */

import { GRAVITY, isInHertz } from "./excitation.js";
import { formatNumber } from "./scale.js";
import { lengthOf, omegaOf, periodOf } from "./structure.js";

const SIZES = { Hz: 2 * Math.PI, rpm: (2 * Math.PI) / 60, "rad/s": 1, m: 1, mm: 1e-3, um: 1e-6, g: GRAVITY, "m/s2": 1 };
/** @type {Record<string, string>} */
const SPELLED = { um: "µm", "m/s2": "m/s²" };
const TIMES = { s: "time, s", periods: "time, shaking periods" };
/** @type {{frequency: "Hz", length: "mm", acceleration: "g", time: ""}} */
const USUAL = { frequency: "Hz", length: "mm", acceleration: "g", time: "" };
const RATIO = "shaking frequency η = Ω/ω";

/** @type {Asked} of the whole page, once it is open */
let asked = USUAL;

/** Say, once, in which units a beam of one's own is shown. @param {Asked} units */
export const setShownUnits = (units) => (asked = units);

/** Whether frequencies of a beam of one's own are shown as ratios. */
export const isRatioShown = () => asked.frequency === "eta";

/** The unit of a kind of numbers of a beam of one's own: its name, and how many Hz, mm or g it is. @param {"frequency" | "length" | "acceleration"} kind */
export function shownUnit(kind) {
  const word = asked[kind] === "eta" ? "Hz" : asked[kind];
  return { name: SPELLED[word] ?? word, size: SIZES[/** @type {keyof SIZES} */ (word)] / SIZES[USUAL[kind]] };
}

/** All units of a beam of one's own. */
export const shownUnitNames = () => [isRatioShown() ? "η" : shownUnit("frequency").name, shownUnit("length").name, shownUnit("acceleration").name].join(", ");

/** How strongly the box is shaken. @param {Level} level */
export function levelInShownUnit({ unit, value }) {
  const { name, size } = shownUnit(unit === "mm" ? "length" : "acceleration");
  const number = size === 1 ? value : Number((value / size).toPrecision(7));
  return { name, value: number, text: `${formatNumber(number)} ${name}` };
}

/** The level of a number that was typed; digits that a command's option keeps. @param {number} value @param {Level} level @returns {Level} */
export function levelOfTyped(value, { unit }) {
  const { size } = shownUnit(unit === "mm" ? "length" : "acceleration");
  return { unit, value: size === 1 ? value : Number((value * size).toPrecision(9)) };
}

/** The option of a command that answers in these units, where they are not the usual ones. @param {Level} level */
export function unitsOption(level) {
  const names = [asked.frequency, asked.length, asked.acceleration, asked.time].filter(Boolean).join(",");
  return !isInHertz(level) || names === "Hz,mm,g" ? "" : ` --units ${names}`;
}

/** @param {Level} level */
export function axisWords(level) {
  if (!isInHertz(level)) return { ...PAPER, time: TIMES[asked.time || "periods"] };
  const [length, frequency] = [shownUnit("length").name, shownUnit("frequency").name];
  return {
    frequency: isRatioShown() ? RATIO : `shaking frequency, ${frequency}`,
    gap: `gap, ${length}`,
    gapSpeed: `gap velocity, ${length}/s`,
    place: `displacement, ${length}`,
    speed: `velocity, ${length}/s`,
    time: TIMES[asked.time || "s"],
    line: isRatioShown() ? "frequency / ω" : `frequency, ${frequency}`,
    acceleration: `acceleration, ${shownUnit("acceleration").name}`,
  };
}

const PAPER = {
  frequency: RATIO,
  gap: "gap ξ",
  gapSpeed: "gap velocity ξ′",
  place: "displacement ξ",
  speed: "velocity ξ′",
  line: "frequency / Ω",
  acceleration: "acceleration ξ″",
};

/** What the shaking's frequency is in rad/s where the axis has 1. @param {Structure} structure @param {Level} level */
function frequencyOfOne(structure, level) {
  if (!isInHertz(level) || asked.frequency === "eta") return omegaOf(structure);
  return SIZES[asked.frequency];
}

/** What is one on the axes, in m, m/s, s and m/s²; `line`: what the excitation's frequency is there. @param {Point} point @param {Level} level */
export function axisScale(point, level) {
  const period = periodOf(point);
  if (isInHertz(level)) {
    const length = SIZES[asked.length];
    const time = asked.time === "periods" ? period : 1;
    return { length, speed: length, time, line: point.frequency / frequencyOfOne(point.structure, level), acceleration: SIZES[asked.acceleration] };
  }
  const length = lengthOf(point);
  const omega = omegaOf(point.structure);
  return { length, speed: length * omega, time: asked.time === "s" ? 1 : period, line: 1, acceleration: length * omega * omega };
}

/** What a frequency ratio of one is on the axis. @param {Structure} structure @param {Level} level */
export const ratioUnit = (structure, level) => omegaOf(structure) / frequencyOfOne(structure, level);

/** A frequency on the axis as the ratio. @param {number} value @param {Structure} structure @param {Level} level */
export const ratioOfShown = (value, structure, level) => (value * frequencyOfOne(structure, level)) / omegaOf(structure);

/** What a gap of one a eta^2 is on the axis. @param {Point} point @param {Level} level */
export const gapUnit = (point, level) => lengthOf(point) / axisScale(point, level).length;
