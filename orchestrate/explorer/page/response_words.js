/** A response in words: its numbers, its exponent, and a sentence. */

import { inHertz } from "./excitation.js";
import { periodsOf, UNDECIDED } from "./response.js";
import { shown } from "./scale.js";
import { scaleAt, wordsOf } from "./units.js";

/**
 * @typedef {import("./response.js").Response} Response
 * @typedef {"chaotic" | "converging" | "undecided"} Kind
 */

const DIGITS = 3; // of a mean number of impacts, wherever it is shown
const UNDECIDED_MOTION = "Nearly repeats, or is still settling: undecided here";

/** What an exponent says. @param {Exponent} exponent @returns {Kind} */
export const kindOf = ({ verdict }) => (verdict > 0 ? "chaotic" : verdict < 0 ? "converging" : "undecided");

/** The same in words, with its standard error. @param {Exponent | null} exponent @param {number} repeats its period in those of the box, 0 if none */
export function exponentWords(exponent, repeats) {
  if (!exponent) return "none of so few impacts";
  const { value, error } = exponent;
  const within = error > 0 ? ` ± ${shown(error, 2)}` : "";
  const converging = `below 0: ${repeats ? "regular" : "it converges, but has not repeated yet"}`;
  const words = { chaotic: "above 0: chaotic", converging, undecided: "0 within its error: undecided here" }[kindOf(exponent)];
  return `${shown(value, 3)}${within} (${words})`;
}

/** @param {number} count */
const countedPeriods = (count) => `${count} period${count > 1 ? "s" : ""}`;

/** After how many periods a motion repeats, or how it does not: where there is an exponent, it decides. @param {{multiplicity: number, decided: number}} motion @param {Exponent | null} [exponent] */
export function repeatWords(motion, exponent) {
  const periods = periodsOf(motion);
  if (periods) return countedPeriods(periods);
  const undecided = exponent ? kindOf(exponent) !== "chaotic" : motion.decided === UNDECIDED;
  return undecided ? "undecided" : "irregular";
}

/** How a beam of one's own is shaken, and how far it opens. @param {number} peak @param {Point} point @param {Level} level @returns {Record<string, string>} */
function ownNumbers(peak, point, level) {
  const [scale, words] = [scaleAt(point, level), wordsOf(level)];
  const { eta, frequency, amplitude } = point;
  return {
    [words.frequency.replace("shaking ", "")]: shown(scale.line, 6),
    [words.place.replace("displacement", "amplitude of the box")]: shown(amplitude / scale.length),
    [words.acceleration.replace("acceleration", "acceleration of the box")]: shown((amplitude * frequency * frequency) / scale.acceleration),
    [`largest ${words.gap}`]: shown((peak * amplitude * eta * eta) / scale.length),
  };
}

/** Numbers of a response for people. @param {Response} response @param {Point} point @param {Level} level @param {Exponent | null} [exponent] @returns {Record<string, string>} */
export function numbersOf(response, point, level, exponent) {
  const { peak, impacts, contact } = response;
  /** @type {Record<string, string>} */
  const first = inHertz(level) ? ownNumbers(peak, point, level) : { "frequency ratio η": shown(point.eta, 6), "largest gap ξ": shown(peak, 6) };
  const count = shown(impacts, DIGITS);
  return {
    ...first,
    "impacts a period": periodsOf(response) === 1 ? count : `${count} on average`,
    "repeats after": repeatWords(response, exponent),
    "stick together": !contact ? "no" : staysShut(response) ? "always" : "for a while",
  };
}

/** How much a mean is worth, of a motion that does not repeat. @param {number} periods of the mean */
export const averageWords = (periods) => `averages over ${periods} periods; from another start they differ by some per cent`;

/** Whether the halves stay together, at either end of a play. @param {Response} response */
const staysShut = ({ peak, impacts, contact, gaps }) => peak === 0 || (contact && !impacts && gaps.every((gap) => peak - gap < 1e-9));

/** So many impacts a period, or a revolution. @param {number} impacts @param {string} [each] */
export function countOf(impacts, each = "a period") {
  const count = shown(impacts, DIGITS);
  return `${count} impact${count === "1" ? "" : "s"} ${each}`;
}

/** The same of a motion: of periods that differ it is the mean. @param {number} impacts @param {number} multiplicity */
export const meanCountOf = (impacts, multiplicity) => `${multiplicity === 1 ? "" : "on average "}${countOf(impacts)}`;

/** A response in a sentence. @param {Response} response @param {Exponent | null | undefined} exponent if it is known @param {boolean} seen whether contact is among what is shown @param {string} opening what is said of halves that stay closed */
export function sentenceOf(response, exponent, seen, opening) {
  const { impacts, contact } = response;
  const periods = periodsOf(response);
  if (!impacts) return staysShut(response) ? `The halves stay closed: no impact.${opening}` : "The halves never touch.";
  const count = meanCountOf(impacts, periods);
  if (periods) {
    const every = periods === 1 ? "every shaking period" : `after ${periods} shaking periods`;
    return `Repeats ${every}: ${count}${contact ? ", then the halves stick together for a while" : ""}.`;
  }
  const sticks = `; at times${seen ? "" : ", outside the periods shown,"} the halves stick together`;
  return `${withoutRepeating(response, exponent)}, ${count}${contact ? sticks : ""}.`;
}

/** Where there is an exponent, it decides. @param {Response} response @param {Exponent | null | undefined} exponent */
function withoutRepeating({ decided, multiplicity, gaps }, exponent) {
  const guess = multiplicity ? `, perhaps after ${countedPeriods(multiplicity)}` : "";
  const undecided = `Undecided whether it repeats${guess}`;
  if (!exponent) return decided === UNDECIDED ? undecided : `Irregular: does not repeat in ${gaps.length} periods`;
  return { chaotic: "Chaos: never repeats", converging: `${undecided}: it converges`, undecided: UNDECIDED_MOTION }[kindOf(exponent)];
}
