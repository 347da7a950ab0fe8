/** The fields of how the box is shaken: frequency, level, and the units that numbers have. */

import { isInHertz, LEVELS, PAPER, pointAt } from "./excitation.js";
import { watchNumber, showNumber } from "./field.js";
import { ETAS } from "./link.js";
import { formatNumber } from "./scale.js";
import { lengthOf, rescaled } from "./structure.js";
import { isRatioShown, ratioUnit, levelOfTyped, levelInShownUnit, shownUnitNames, shownUnit, ratioOfShown } from "./units.js";

/** @typedef {{choose: (eta: number, exactly: boolean) => void, change: (structure: Structure, level: Level) => void}} Acts */

/** @type {Level} */
const FIRST = { unit: "g", value: 1 };
const DIGITS = 7; // of a frequency ratio that is shown
const FINE = 9; // of a frequency in Hz
const OMEGA = 2 * Math.PI * 40; // of a first beam of one's own, rad/s

export class Shaking {
  /** @param {(id: string) => HTMLElement} at @param {Units} units @param {Structure} structure @param {Level} level @param {Acts} acts */
  constructor(at, units, structure, level, { choose, change }) {
    /** @param {string} id */
    const input = (id) => /** @type {HTMLInputElement} */ (at(id));
    this.at = at;
    this.inputs = { eta: input("eta"), number: input("eta-number"), hertz: input("hertz"), level: input("level") };
    this.units = units;
    this.structure = structure;
    this.level = level;
    at("hertz-label").textContent = isRatioShown() ? "as ratio η = Ω/ω" : `in ${shownUnit("frequency").name}`;
    at("own").textContent = `your own: ${shownUnitNames()}`;
    watchNumber(this.inputs.eta, (value) => choose(value, false), "input");
    watchNumber(this.inputs.number, (value) => choose(value, true));
    watchNumber(this.inputs.hertz, (value) => {
      const ends = ETAS.map((end) => end * ratioUnit(this.structure, this.level));
      if (value < ends[0] || value > ends[1]) return `expected ${ends.map((end) => formatNumber(end)).join(" to ")} for this beam`;
      choose(ratioOfShown(value, this.structure, this.level), true);
    });
    watchNumber(this.inputs.level, (value) => change(this.structure, levelOfTyped(value, this.level)));
    at("own-beam").addEventListener("click", () => {
      if (!isInHertz(this.level)) change(...this.beamInOtherUnits(true));
      const first = input("f1"); // ready to be typed into
      first.scrollIntoView({ block: innerWidth > 900 ? "nearest" : "center" });
      first.select();
    });
    at("units").addEventListener("change", ({ target }) => {
      change(...this.beamInOtherUnits(/** @type {HTMLSelectElement} */ (target).value === "own"));
    });
  }

  /** The same motions of a beam of one's own, or in the paper's units. @param {boolean} own @returns {[Structure, Level]} */
  beamInOtherUnits(own) {
    const [omega, level] = own ? [OMEGA, FIRST] : [1, PAPER];
    const digits = own ? 17 : 12;
    const other = rescaled(this.structure, this.units, omega, 1, digits);
    const [from, to] = [pointAt(this.structure, 1, this.level), pointAt(other, 1, level)].map(lengthOf);
    return [rescaled(this.structure, this.units, omega, to / from, digits), level];
  }

  /** @param {Structure} structure @param {Level} level */
  showBeam(structure, level) {
    Object.assign(this, { structure, level });
    const own = isInHertz(level);
    for (const [id, hidden] of Object.entries({ "own-shaking": !own, "paper-number": own })) this.at(id).hidden = hidden;
    /** @type {HTMLSelectElement} */ (this.at("units")).value = own ? "own" : "paper";
    const { name, value } = levelInShownUnit(level);
    const [least, most] = LEVELS[level.unit].map((end) => levelInShownUnit({ ...level, value: end }).value);
    Object.assign(this.inputs.level, { min: least, max: most });
    this.at("level-label").textContent = `level, ${name}${name === "g" ? " (of gravity)" : ""}`;
    showNumber(this.inputs.level, value);
  }

  /** The chosen frequency. @param {number} eta */
  showFrequency(eta) {
    const { eta: slider, number, hertz } = this.inputs;
    showNumber(slider, eta);
    showNumber(number, eta, DIGITS);
    // other units have a digit less: the frequency is one in Hz of nine digits
    showNumber(hertz, eta * ratioUnit(this.structure, this.level), shownUnit("frequency").size === 1 ? FINE : FINE - 1);
  }

  /** Frequencies that the slider reaches. @param {number} low @param {number} high */
  setSliderRange(low, high) {
    const { eta } = this.inputs;
    Object.assign(eta, { min: low, max: high, step: (high - low) / 2000 });
  }
}
