/** The commands of `orchestrate` that compute what the page shows. */

import { omegaOf } from "./structure.js";

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {import("./structure.js").Point} Point
 * @typedef {import("./diagram.js").Diagram} Diagram
 */

const PROGRAM = "python -m orchestrate";
const GRAVITY = 9.80665; // m/s²

/** `--set NAME=VALUE` for what is not usual. @param {Structure} structure @param {Structure} usual */
function sets(structure, usual) {
  return differences(structure, usual).map(([name, value]) => ` --set ${name}=${value}`).join("");
}

/** @param {Structure} structure @param {Structure} usual @returns {[string, string][]} */
function differences(structure, usual) {
  return Object.entries(structure)
    .filter(([name, value]) => value !== usual[/** @type {keyof Structure} */ (name)])
    .map(([name, value]) => [name, name === "bonded" ? String(Boolean(value)) : String(value)]);
}

/** The diagram. @param {Diagram} diagram @param {Structure} usual */
export function diagramCommand(diagram, usual) {
  const { structure, direction, points, settings } = diagram;
  const { transient, samples } = settings;
  const starts = diagram.lanes.map(({ from, starts: known, direction: way }) => {
    if (from || !known) return from ?? [0, 0, 0, 0];
    const place = way === "up" ? 0 : known.length - 4;
    return Array.from(known.subarray(place, place + 4));
  });
  const options = optionsOf(points);
  if (options && starts.every((start) => start.every((value) => value === 0))) {
    const kept = `--direction ${direction} --transient ${transient} --samples ${samples}`;
    return `${PROGRAM} sweep ${options} ${kept}${sets(structure, usual)}`;
  }
  const given = differences(structure, usual).map(([name, value]) => `${name}=${value}`).join(", ");
  return diagram.lanes
    .map(({ direction: way }, i) => {
      const words = `${keywordsOf(points)}, direction="${way}", start=[${starts[i].join(", ")}]`;
      return `orchestrate.sweep(orchestrate.Structure(${given}), ${words}, transient=${transient}, samples=${samples})`;
    })
    .join("\n");
}

/** An excitation at the command line, where a range says it to the last bit; else nothing. @param {Point[]} points */
function optionsOf(points) {
  if (points.every(isPlain)) return rangeOf("--eta", points.map(({ eta }) => eta), (eta) => eta);
  const turns = points.map(({ frequency }) => frequency);
  const range = rangeOf("--hz", turns, (hz) => 2 * Math.PI * hz) || rangeOf("--frequency", turns, (value) => value);
  const { frequency, amplitude } = points[0];
  if (points.every((point) => point.amplitude === amplitude)) return range && `${range} --amplitude ${amplitude}`;
  const level = Number(((amplitude * frequency * frequency) / GRAVITY).toPrecision(9));
  const held = points.every((point) => point.amplitude === (level * GRAVITY) / (point.frequency * point.frequency));
  return held && range && `${range} --g ${level}`;
}

/** Values as a range of decimal numbers; nothing where they are none. @param {string} option @param {number[]} values @param {(value: number) => number} of what the option's number becomes */
function rangeOf(option, values, of) {
  const decimals = values.map((value) => Number((value / of(1)).toFixed(9)));
  const [first, last] = [decimals[0], decimals[decimals.length - 1]];
  const step = Number((decimals.length > 1 ? (last - first) / (decimals.length - 1) : 1).toPrecision(9));
  const even = values.every((value, i) => of(Number((first + i * step).toFixed(9))) === value);
  return even ? `${option} ${first}:${last}:${step}` : "";
}

/** An excitation as keywords of `orchestrate.sweep`. @param {Point[]} points */
function keywordsOf(points) {
  if (!points.every(isPlain)) {
    /** @param {"frequency" | "amplitude"} name */
    const list = (name) => `${name}=[${points.map((point) => point[name]).join(", ")}]`;
    return `${list("frequency")}, ${list("amplitude")}`;
  }
  const etas = points.map(({ eta }) => eta);
  const [, range] = rangeOf("", etas, (eta) => eta).split(" ");
  if (!range) return `eta=[${etas.join(", ")}]`;
  const [first, last, step] = range.split(":").map(Number);
  return `eta=[float(f"{i}e-9") for i in range(${nine(first)}, ${nine(last)} + 1, ${nine(step)})]`;
}

/** Whether an excitation is told by the frequency ratio alone. @param {Point} point */
function isPlain({ eta, amplitude }) {
  return amplitude === 1 / (eta * eta);
}

/** In units of 1e-9, as a whole number. @param {number} value */
function nine(value) {
  return Math.round(value * 1e9);
}

/** The motion that goes on from a response. @param {Point} point @param {number[]} start @param {{transient: number, periods: number, points: number}} asked @param {Structure} usual */
export function motionCommand(point, start, { transient, periods, points }, usual) {
  const { eta, frequency, amplitude } = point;
  // 1/eta^2 m says something of a structure of 1 rad/s only
  const paper = isPlain(point) && Math.abs(omegaOf(point.structure) - 1) < 1e-9;
  const where = paper ? `--eta ${eta}` : `--frequency ${frequency} --amplitude ${amplitude}`;
  const how = `--transient ${transient} --periods ${periods} --points ${points}`;
  return `${PROGRAM} simulate ${where} ${how} --start=${start.join(",")}${sets(point.structure, usual)}`;
}
