/** A response in words: its numbers, its exponent, and a sentence. */

import { isInHertz } from "./excitation.js";
import { repeatPeriods, UNDECIDED } from "./response.js";
import { formatNumber } from "./scale.js";
import { axisScale, axisWords } from "./units.js";

const DIGITS = 3; // of a mean number of impacts, wherever it is shown

/** What an exponent says. @param {Exponent} exponent */
export const exponentKind = ({ verdict }) => (verdict > 0 ? "chaotic" : verdict < 0 ? "converging" : "undecided");

/** The same in words, with its standard error. @param {Exponent | null} exponent @param {number} repeats its period in those of the box, 0 if none */
export function exponentWords(exponent, repeats) {
  if (!exponent) return "none of so few impacts";
  const { value, error } = exponent;
  const within = error > 0 ? ` ± ${formatNumber(error, 2)}` : "";
  const converging = `below 0: ${repeats ? "regular" : "it converges, but has not repeated yet"}`;
  const words = { chaotic: "above 0: chaotic", converging, undecided: "0 within its error: undecided here" }[exponentKind(exponent)];
  return `${formatNumber(value, 3)}${within} (${words})`;
}

/** @param {number} count */
const periodCountWords = (count) => `${count} period${count > 1 ? "s" : ""}`;

/** After how many periods a motion repeats, or how it does not: where there is an exponent, it decides. @param {{multiplicity: number, decided: number}} motion @param {Exponent | null} [exponent] */
export function repeatWords(motion, exponent) {
  const periods = repeatPeriods(motion);
  if (periods) return periodCountWords(periods);
  const undecided = exponent ? exponentKind(exponent) !== "chaotic" : motion.decided === UNDECIDED;
  return undecided ? "undecided" : "irregular";
}

/** Numbers of a response for people. @param {Settled} response @param {Point} point @param {Level} level @param {Exponent | null} [exponent] @returns {Record<string, string>} */
export function responseNumbers(response, point, level, exponent) {
  const { peak, impacts, contact } = response;
  const { eta, frequency, amplitude } = point;
  /** @type {Record<string, string>} */
  let first = { "frequency ratio η": formatNumber(eta, 6), "largest gap ξ": formatNumber(peak, 6) };
  if (isInHertz(level)) {
    const [scale, words] = [axisScale(point, level), axisWords(level)];
    first = {
      [words.frequency.replace("shaking ", "")]: formatNumber(scale.line, 6),
      [words.place.replace("displacement", "amplitude of the box")]: formatNumber(amplitude / scale.length),
      [words.acceleration.replace("acceleration", "acceleration of the box")]: formatNumber((amplitude * frequency * frequency) / scale.acceleration),
      [`largest ${words.gap}`]: formatNumber((peak * amplitude * eta * eta) / scale.length),
    };
  }
  const count = formatNumber(impacts, DIGITS);
  return {
    ...first,
    "impacts a period": repeatPeriods(response) === 1 ? count : `${count} on average`,
    "repeats after": repeatWords(response, exponent),
    "stick together": !contact ? "no" : staysShut(response) ? "always" : "for a while",
  };
}

/** How much a mean is worth, of a motion that does not repeat. @param {number} periods of the mean */
export const averageWords = (periods) => `averages over ${periods} periods; from another start they differ by some per cent`;

/** Whether the halves stay together, at either end of a play. @param {Settled} response */
const staysShut = ({ peak, impacts, contact, gaps }) => peak === 0 || (contact && !impacts && gaps.every((gap) => peak - gap < 1e-9));

/** So many impacts a period, or a revolution. @param {number} impacts @param {string} [each] */
export function impactCountWords(impacts, each = "a period") {
  const count = formatNumber(impacts, DIGITS);
  return `${count} impact${count === "1" ? "" : "s"} ${each}`;
}

/** The same of a motion: of periods that differ it is the mean. @param {number} impacts @param {number} multiplicity */
export const meanImpactCountWords = (impacts, multiplicity) => `${multiplicity === 1 ? "" : "on average "}${impactCountWords(impacts)}`;

/** A response in a sentence. @param {Settled} response @param {Exponent | null | undefined} exponent if it is known @param {boolean} seen whether contact is among what is shown @param {string} opening what is said of halves that stay closed */
export function responseSentence(response, exponent, seen, opening) {
  const { impacts, contact } = response;
  const periods = repeatPeriods(response);
  if (!impacts) return staysShut(response) ? `The halves stay closed: no impact.${opening}` : "The halves never touch.";
  const count = meanImpactCountWords(impacts, periods);
  if (periods) {
    const every = periods === 1 ? "every shaking period" : `after ${periods} shaking periods`;
    return `Repeats ${every}: ${count}${contact ? ", then the halves stick together for a while" : ""}.`;
  }
  const sticks = `; at times${seen ? "" : ", outside the periods shown,"} the halves stick together`;
  return `${unrepeatedWords(response, exponent)}, ${count}${contact ? sticks : ""}.`;
}

/** Where there is an exponent, it decides. @param {Settled} response @param {Exponent | null | undefined} exponent */
function unrepeatedWords({ decided, multiplicity, gaps }, exponent) {
  const guess = multiplicity ? `, perhaps after ${periodCountWords(multiplicity)}` : "";
  const undecided = `Undecided whether it repeats${guess}`;
  if (!exponent) return decided === UNDECIDED ? undecided : `Irregular: does not repeat in ${gaps.length} periods`;
  const nearly = "Nearly repeats, or is still settling: undecided here";
  return { chaotic: "Chaos: never repeats", converging: `${undecided}: it converges`, undecided: nearly }[exponentKind(exponent)];
}
