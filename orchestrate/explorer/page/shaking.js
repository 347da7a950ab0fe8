/** The fields of how the box is shaken: frequency, level, and the units that numbers have. */

import { etaOf, hertzOf, inHertz, PAPER, pointAt } from "./excitation.js";
import { onNumber, showNumber } from "./field.js";
import { ETAS } from "./link.js";
import { shown } from "./scale.js";
import { lengthOf, rescaled } from "./structure.js";

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {import("./excitation.js").Level} Level
 * @typedef {{choose: (eta: number, exactly: boolean) => void,
 *   change: (structure: Structure, level: Level) => void}} Acts
 */

/** @type {Level} */
const FIRST = { unit: "g", value: 1 };
const DIGITS = 7; // of a frequency ratio that is shown
const OMEGA = 2 * Math.PI * 40; // of a first beam of one's own, rad/s

export class Shaking {
  /**
   * @param {(id: string) => HTMLElement} at
   * @param {import("./structure.js").Units} units
   * @param {Structure} structure
   * @param {Level} level
   * @param {Acts} acts
   */
  constructor(at, units, structure, level, acts) {
    /** @param {string} id */
    const input = (id) => /** @type {HTMLInputElement} */ (at(id));
    this.at = at;
    this.inputs = { eta: input("eta"), number: input("eta-number"), hertz: input("hertz"), level: input("level") };
    this.units = units;
    this.structure = structure;
    this.level = level;
    this.connect(acts);
  }

  /** @param {Acts} acts */
  connect({ choose, change }) {
    const { eta, number, hertz, level } = this.inputs;
    onNumber(eta, (value) => choose(value, false), "input");
    onNumber(number, (value) => choose(value, true));
    onNumber(hertz, (value) => {
      const ends = ETAS.map((end) => hertzOf(end, this.structure));
      if (value < ends[0] || value > ends[1]) return `expected ${ends.map((end) => shown(end)).join(" to ")} for this beam`;
      choose(etaOf(value, this.structure), true);
    });
    onNumber(level, (value) => change(this.structure, { ...this.level, value }));
    this.at("units").addEventListener("change", ({ target }) => {
      change(...this.converted(/** @type {HTMLSelectElement} */ (target).value === "own"));
    });
  }

  /** The same motions of a beam of one's own, or in the paper's units. @param {boolean} own @returns {[Structure, Level]} */
  converted(own) {
    const [omega, level] = own ? [OMEGA, FIRST] : [1, PAPER];
    const digits = own ? 17 : 12;
    const other = rescaled(this.structure, this.units, omega, 1, 1, digits);
    const [from, to] = [pointAt(this.structure, 1, this.level), pointAt(other, 1, level)].map(lengthOf);
    return [rescaled(this.structure, this.units, omega, 1, to / from, digits), level];
  }

  /** @param {Structure} structure @param {Level} level */
  show(structure, level) {
    Object.assign(this, { structure, level });
    const own = inHertz(level);
    for (const [id, hidden] of Object.entries({ "own-shaking": !own, "paper-number": own })) this.at(id).hidden = hidden;
    /** @type {HTMLSelectElement} */ (this.at("units")).value = own ? "own" : "paper";
    this.at("level-label").textContent = `level, ${level.unit}`;
    showNumber(this.inputs.level, level.value);
  }

  /** The chosen frequency. @param {number} eta */
  mark(eta) {
    const { eta: slider, number, hertz } = this.inputs;
    showNumber(slider, eta);
    showNumber(number, eta, DIGITS);
    showNumber(hertz, Number(hertzOf(eta, this.structure).toPrecision(9)));
  }

  /** Frequencies that the slider reaches. @param {number} low @param {number} high */
  reach(low, high) {
    const { eta } = this.inputs;
    Object.assign(eta, { min: low, max: high, step: (high - low) / 2000 });
  }
}
