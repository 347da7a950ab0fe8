/** Sliders with a number beside each: the paper's parameters, and the SI numbers. */

import { omegaOf, ratiosOf, withRatio } from "./structure.js";

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {{name: string, label: string, low: number, high: number, step: number}} Slider
 */

/** @type {Slider[]} */
const SLIDERS = [
  { name: "e", label: "restitution e", low: 0, high: 1, step: 0.01 },
  { name: "D", label: "damping D (both)", low: 0, high: 0.1, step: 0.001 },
  { name: "D1", label: "damping D₁", low: 0, high: 0.1, step: 0.001 },
  { name: "D2", label: "damping D₂", low: 0, high: 0.1, step: 0.001 },
  { name: "mu", label: "mass ratio μ", low: 0.2, high: 5, step: 0.01 },
  { name: "kappa", label: "stiffness ratio κ", low: 0.2, high: 5, step: 0.01 },
];
const SI = /** @type {const} */ ([
  ["m1", "kg"],
  ["m2", "kg"],
  ["k1", "N/m"],
  ["k2", "N/m"],
  ["d1", "N s/m"],
  ["d2", "N s/m"],
]);

export class Controls {
  /**
   * @param {HTMLElement} sliders
   * @param {HTMLElement} si
   * @param {Record<string, [number, number]>} ranges of the SI numbers
   * @param {(structure: Structure) => void} changed
   */
  constructor(sliders, si, ranges, changed) {
    this.changed = changed;
    /** @type {Structure | null} */
    this.structure = null;
    /** @type {Map<string, HTMLInputElement[]>} */
    this.inputs = new Map();
    for (const slider of SLIDERS) sliders.append(this.slider(slider));
    for (const [name, unit] of SI) si.append(this.entry(name, unit, ranges[name]));
  }

  /** @param {Slider} slider */
  slider({ name, label, low, high, step }) {
    const row = document.createElement("div");
    row.className = "slider";
    const inputs = [
      inputOf({ type: "range", id: name, min: low, max: high, step }),
      inputOf({ type: "number", id: `${name}-number`, min: low, max: high, step: "any" }),
    ];
    inputs[1].ariaLabel = `${label}, number`;
    row.append(labelOf(name, label), ...inputs);
    this.inputs.set(name, inputs);
    inputs[0].addEventListener("input", () => this.set(name, inputs[0], low, high));
    // not while it is typed: 1.7 begins with 1
    inputs[1].addEventListener("change", () => this.set(name, inputs[1], low, high));
    return row;
  }

  /** @param {"m1" | "m2" | "k1" | "k2" | "d1" | "d2"} name @param {string} unit @param {[number, number]} range */
  entry(name, unit, [low, high]) {
    const row = document.createElement("div");
    row.className = "entry";
    const index = document.createElement("sub");
    index.textContent = name[1];
    const input = inputOf({ type: "number", id: name, step: "any", min: low, max: high });
    row.append(labelOf(name, name[0], index, `, ${unit}`), input);
    this.inputs.set(name, [input]);
    input.addEventListener("change", () => this.set(name, input, low, high));
    return row;
  }

  /** @param {string} name @param {HTMLInputElement} input @param {number} low @param {number} high */
  set(name, input, low, high) {
    const value = input.valueAsNumber;
    const good = Number.isFinite(value) && value >= low && value <= high && this.structure;
    input.setCustomValidity(good ? "" : `expected ${low} to ${high}`);
    if (!good || !this.structure) {
      input.reportValidity();
      return;
    }
    const both = name === "D" ? ["D1", "D2"] : [name];
    const changed = both.reduce((structure, one) => withRatio(structure, one, value), this.structure);
    this.show(changed, input);
    this.changed(changed);
  }

  /** Show a structure's numbers; the input that is being typed into is left alone. @param {Structure} structure @param {HTMLInputElement} [typed] */
  show(structure, typed) {
    this.structure = structure;
    const ratios = ratiosOf(structure);
    /** @type {Record<string, number>} */
    const values = { ...structure, ...ratios, D: ratios.D1 };
    for (const [name, inputs] of this.inputs) {
      for (const input of inputs) {
        if (input !== typed) input.value = String(Number(values[name].toPrecision(12)));
      }
    }
  }
}

/** @param {Record<string, string | number>} attributes */
function inputOf(attributes) {
  const input = document.createElement("input");
  for (const [name, value] of Object.entries(attributes)) input.setAttribute(name, String(value));
  return input;
}

/** @param {string} name of its input @param {(string | Node)[]} parts */
function labelOf(name, ...parts) {
  const label = document.createElement("label");
  label.htmlFor = name;
  label.append(...parts);
  return label;
}

/** Frequency in Hz of a frequency ratio, and back. */
export const hertz = {
  /** @param {number} eta @param {Structure} structure */
  of: (eta, structure) => (eta * omegaOf(structure)) / (2 * Math.PI),
  /** @param {number} frequency @param {Structure} structure */
  eta: (frequency, structure) => (frequency * 2 * Math.PI) / omegaOf(structure),
};
