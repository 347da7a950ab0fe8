/** Sliders with a number next to each: the paper's parameters, or those of a beam of one's own, and the SI numbers. */

import { isInHertz } from "./excitation.js";
import { watchNumber, showNumber } from "./field.js";
import { fieldNumbers, withNumber, contradictionIn } from "./structure.js";
import { shownUnit } from "./units.js";

/**
 * @typedef {[name: string, label: string, low: number, high: number, step?: number]} Entry
 *   with a slider where there is a step
 */

/** @type {Entry[]} */
const RESTITUTION = [["e", "restitution e", 0, 1, 0.01]];
/** @type {Entry[]} */
const PAPER = [
  ["D", "damping D", 0, 0.1, 0.001],
  ["mu", "mass ratio μ", 0.2, 5, 0.01],
  ["kappa", "stiffness ratio κ", 0.2, 5, 0.01],
  ["xi0", "gap at rest ξ₀", -2, 2, 0.01],
];
/** @type {Entry[]} */
const OWN = [
  ["f1", "natural frequency 1, Hz", 0.1, 1e4],
  ["f2", "natural frequency 2, Hz", 0.1, 1e4],
  ["mass1", "mass of half 1, kg", 1e-6, 1e4],
  ["mass2", "mass of half 2, kg", 1e-6, 1e4],
  ["zeta", "damping, %", 0, 20, 0.01],
  ["gap", "gap at rest, mm", -0.5, 0.5, 0.005],
];
/** @type {Entry[]} */
const PAPER_LOADS = [
  ["play", "largest gap ξ, 0: any", 0, 5, 0.01],
  ["push1", "force on half 1", -2, 2, 0.01],
  ["push2", "force on half 2", -2, 2, 0.01],
  ["push", "constant push of the box", -2, 2, 0.01],
];
/** @type {Entry[]} */
const OWN_LOADS = [["most", "largest gap, mm, 0: any", 0, 1e4]];
const OF_HALF_2 = ["mu", "kappa", "f2", "mass2", "push2", "force2"]; // which a wall has not

const DIGITS = 7;
/** @type {Record<string, "frequency" | "length">} of numbers with a unit that is chosen */
const KINDS = { f1: "frequency", f2: "frequency", gap: "length", most: "length" };

/** How many Hz or mm the unit of a field is. @param {string} name */
const unitSize = (name) => (name in KINDS ? shownUnit(KINDS[name]).size : 1);

/** An entry in the units that the page shows. @param {Entry} entry */
function entryInShownUnits([name, label, ...numbers]) {
  const words = name in KINDS ? label.replace(/Hz|mm/, shownUnit(KINDS[name]).name) : label;
  return /** @type {Entry} */ ([name, words, ...numbers.map((value = 0) => Number((value / unitSize(name)).toPrecision(DIGITS)))]);
}

export class Controls {
  /**
   * @param {(id: string) => HTMLElement} at
   * @param {Structure} structure
   * @param {{ranges: Record<string, [number, number]>, units: Units, loops: Loops}} table
   *   of the SI numbers
   * @param {(structure: Structure) => void} changed
   */
  constructor(at, structure, { ranges, units, loops }, changed) {
    this.at = at;
    this.changed = changed;
    this.ranges = ranges;
    this.structure = structure;
    /** @type {Map<string, HTMLInputElement[]>} */
    this.inputs = new Map();
    const parts = { sliders: RESTITUTION, "paper-sliders": PAPER, "own-sliders": OWN, "paper-loads": PAPER_LOADS, "own-loads": OWN_LOADS };
    for (const [id, entries] of Object.entries(parts)) at(id).append(...entries.map((entry) => this.makeRow(entryInShownUnits(entry))));
    for (const [name, { label }] of Object.entries(units)) {
      at(name in loops.pushes ? "own-loads" : "si").append(this.makeRow([name, `${name}, ${label}`.replace("_", " "), ...ranges[name]]));
    }
    this.wall = /** @type {HTMLInputElement} */ (at("wall"));
    this.wall.addEventListener("change", () => this.setNumber("wall", Number(this.wall.checked), this.wall));
    at("si").append(this.makeRow(["D1", "D₁", 0, 1e3]), this.makeRow(["D2", "D₂", 0, 1e3]));
  }

  /** @param {Entry} entry */
  makeRow([name, label, min, max, step]) {
    const row = document.createElement("div");
    row.className = "slider";
    row.title = document.getElementById(`help-${name}`)?.textContent ?? "";
    const words = document.createElement("label");
    Object.assign(words, { htmlFor: name, textContent: label });
    row.append(words);
    const number = Object.assign(document.createElement("input"), { type: "number", id: step ? `${name}-number` : name, min, max, step: "any" });
    const inputs = [number];
    if (step) {
      inputs.unshift(Object.assign(document.createElement("input"), { type: "range", id: name, min, max, step }));
      number.ariaLabel = `${label}, number`;
      watchNumber(inputs[0], (value) => this.setNumber(name, value, inputs[0]), "input");
    }
    watchNumber(number, (value) => this.setNumber(name, value, number));
    row.append(...inputs);
    this.inputs.set(name, inputs);
    return row;
  }

  /** What is expected, if the number leads to no structure. @param {string} name @param {number} value @param {HTMLInputElement} typed is left as it is */
  setNumber(name, value, typed) {
    const structure = withNumber(this.structure, name, value * unitSize(name));
    for (const [other, [low, high]] of Object.entries(this.ranges)) {
      const number = structure[/** @type {keyof Structure} */ (other)] ?? low;
      if (!(number >= low && number <= high)) return `makes ${other} ${number}; expected ${low} to ${high}`;
    }
    const wrong = contradictionIn(structure);
    if (wrong) return wrong;
    this.structure = structure;
    this.changed(structure);
    this.showNumbers(typed);
  }

  /** Show a structure's numbers, in the units of how it is shaken. @param {Structure} structure @param {Level} level */
  showStructure(structure, level) {
    this.structure = structure;
    for (const id of ["paper-sliders", "paper-loads"]) this.at(id).hidden = isInHertz(level);
    for (const id of ["own-sliders", "own-loads", "own-note"]) this.at(id).hidden = !isInHertz(level);
    this.showNumbers();
  }

  /** @param {HTMLInputElement} [typed] */
  showNumbers(typed) {
    const values = fieldNumbers(this.structure);
    this.wall.checked = this.structure.wall === 1;
    for (const name of OF_HALF_2) /** @type {HTMLElement} */ (this.inputs.get(name)?.[0].parentElement).hidden = this.wall.checked;
    for (const [name, inputs] of this.inputs) {
      for (const input of inputs) if (input !== typed) showNumber(input, values[name] / unitSize(name), DIGITS);
    }
  }
}
