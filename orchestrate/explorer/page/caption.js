/** What stands below a saved picture: what it shows, of which beam, made by what. */

import { isInHertz } from "./excitation.js";
import { formatNumber } from "./scale.js";
import { fieldNumbers } from "./structure.js";
import { isRatioShown, levelInShownUnit, shownUnit, axisScale } from "./units.js";

const SIZE = 11; // px of a letter
const LINE = 16; // px
const LETTER = 6.2; // px, the mean width of one
const LEFT = 10; // px

/** @type {Record<string, (number: string) => string>} what is said where it is not 0 */
const LOADS = {
  stroke: (number) => `largest gap ${number} m`,
  box_acceleration: (number) => `box accelerated by ${number} m/s²`,
  force1: (number) => `force 1 of ${number} N`,
  force2: (number) => `force 2 of ${number} N`,
};

/** A beam and how it is shaken, in the units of the page. @param {Point} point @param {Level} level */
export function beamWords(point, level) {
  const { structure, eta } = point;
  const kind = structure.wall ? "One mass before a wall" : "Delaminated beam";
  const numbers = fieldNumbers(structure);
  const { e, mu, kappa, D, xi0, f1, f2, mass1, mass2, zeta, gap } = numbers;
  const more = Object.entries(LOADS).map(([name, text]) => (numbers[name] ? `, ${text(formatNumber(numbers[name]))}` : "")).join("");
  if (!isInHertz(level)) {
    const halves = structure.wall ? "" : `, μ = ${formatNumber(mu)}, κ = ${formatNumber(kappa)}`;
    return `${kind}: e = ${formatNumber(e)}${halves}, D = ${formatNumber(D)}, ξ₀ = ${formatNumber(xi0)}${more}; η = ${formatNumber(eta, 7)}`;
  }
  const [turns, lengths] = [shownUnit("frequency"), shownUnit("length")];
  const halves = structure.wall
    ? `${formatNumber(f1 / turns.size)} ${turns.name}, ${formatNumber(mass1)} kg`
    : `halves of ${formatNumber(f1 / turns.size)} and ${formatNumber(f2 / turns.size)} ${turns.name}, ${formatNumber(mass1)} and ${formatNumber(mass2)} kg`;
  const shaken = `${frequencyText(axisScale(point, level).line)}, ${levelInShownUnit(level).text}`;
  return `${kind}: ${halves}, damping ${formatNumber(zeta)} %, gap ${formatNumber(gap / lengths.size)} ${lengths.name}, e = ${formatNumber(e)}${more}; shaken at ${shaken}`;
}

/** @param {number} value of the axis */
const frequencyText = (value) => (isRatioShown() ? `η = ${formatNumber(value, 6)}` : `${formatNumber(value, 6)} ${shownUnit("frequency").name}`);

/** Texts in lines that fit. @param {string[]} texts @param {number} width px */
export function wrapLines(texts, width) {
  const most = Math.max(20, Math.floor((width - 2 * LEFT) / LETTER));
  return texts.flatMap((text) => {
    const lines = [""];
    for (const word of text.split(/\s+/)) {
      const last = lines[lines.length - 1];
      if (last && last.length + 1 + word.length > most) lines.push(word);
      else lines[lines.length - 1] = last ? `${last} ${word}` : word;
    }
    return lines;
  });
}

/** @param {string[]} lines */
export const captionHeight = (lines) => LINE * lines.length + LINE / 2;

/** @param {Pen} pen @param {string[]} lines @param {number} top @param {Theme} theme */
export function drawCaption(pen, lines, top, theme) {
  lines.forEach((line, i) => pen.text(LEFT, top + LINE * (i + 0.5), line, { anchor: "start", size: SIZE, fill: i ? theme.soft : theme.ink }));
}
