/** The view as a link: what is behind the # restores it. */

import { isSameLevel, LEVELS } from "./excitation.js";

/** Frequency ratios that a view may have. @type {[number, number]} */
export const ETAS = [1e-3, 1000];

/** @param {View} view @param {View} usual what need not be said @param {string} [tour] stop of the tour */
export function linkFragment({ structure, level, low, high, direction, eta, start }, usual, tour) {
  const words = new URLSearchParams(tour ? { tour } : {});
  for (const [name, value] of Object.entries({ from: low, to: high, direction })) words.set(name, String(value));
  for (const [name, value] of Object.entries(structure)) {
    if (value !== usual.structure[/** @type {keyof Structure} */ (name)]) words.set(name, String(value));
  }
  if (!isSameLevel(level, usual.level)) words.set(level.unit, String(level.value));
  if (eta !== null) words.set("eta", String(eta));
  if (start) words.set("start", start.join(","));
  return `#${words}`;
}

/** A view from a link; what it does not say, or says wrongly, is as in `view`. @param {string} fragment @param {View} view @param {Ranges} ranges @returns {View} */
export function viewFromLink(fragment, view, ranges) {
  const words = new URLSearchParams(fragment.replace(/^#/, ""));
  /** @param {string} name @param {[number, number]} range */
  const number = (name, [least, most]) => {
    const value = Number(words.get(name) || NaN);
    return value >= least && value <= most ? value : undefined;
  };
  const structure = { ...view.structure };
  for (const name of /** @type {(keyof Structure)[]} */ (Object.keys(structure))) {
    structure[name] = number(name, ranges[name]) ?? structure[name];
  }
  const unit = /** @type {const} */ (["g", "mm", "paper"]).find((one) => number(one, LEVELS[one]) !== undefined);
  const direction = /** @type {const} */ (["up", "down", "both"]).find((one) => one === words.get("direction"));
  const start = (words.get("start") ?? "").split(",").map((text) => (text ? Number(text) : NaN));
  const [low, high] = [number("from", ETAS) ?? view.low, number("to", ETAS) ?? view.high];
  return {
    structure,
    level: unit ? { unit, value: Number(words.get(unit)) } : view.level,
    ...(high > low ? { low, high } : { low: view.low, high: view.high }),
    direction: direction ?? view.direction,
    eta: number("eta", ETAS) ?? view.eta,
    start: start.length === 4 && start.every(Number.isFinite) ? start : null,
  };
}
