/** The commands that compute what the page shows, each to be pasted into a shell. */

import { hertzAsGiven, GRAVITY } from "./excitation.js";
import { omegaOf } from "./structure.js";
import { unitsOption } from "./units.js";

const PROGRAM = "python -m orchestrate";
const REST = [0, 0, 0, 0];
const FLAGS = ["bonded", "wall"];
const PUSHES = ["box_acceleration", "force1", "force2"]; // of the excitation

/** `--set NAME=VALUE`, or an option of the excitation, for what is not usual. @param {Structure} structure @param {Structure} usual */
function setOptions(structure, usual) {
  /** @param {[string, number]} one */
  const option = ([name, value]) => (PUSHES.includes(name) ? ` --${name.replace("_", "-")}=${value}` : ` --set ${name}=${FLAGS.includes(name) ? value === 1 : value}`);
  return changedParameters(structure, usual).map(option).join("");
}

/** @param {Structure} structure @param {Structure} usual @returns {[string, number][]} */
function changedParameters(structure, usual) {
  return Object.entries(structure).filter(([name, value]) => value !== usual[/** @type {keyof Structure} */ (name)]);
}

/** The diagram: a line, or one for each direction where they begin from other states than rest. @param {Diagram} diagram @param {Structure} usual */
export function diagramCommand(diagram, usual) {
  const { structure, direction, points, settings, lanes, level } = diagram;
  const starts = lanes.map(startOption);
  const how = `--transient ${settings.transient} --samples ${settings.samples}${setOptions(structure, usual)}${unitsOption(level)}`;
  const options = excitationOptions(points);
  if (options && starts.every(isRest)) return `${PROGRAM} sweep ${options} --direction ${direction} ${how}`;
  /** @param {number[]} start */
  const from = (start) => (isRest(start) ? "" : ` --start=${start.join(",")}`);
  return lanes
    .map(({ direction: way }, i) =>
      options ? `${PROGRAM} sweep ${options} --direction ${way}${from(starts[i])} ${how}` : pythonScript(diagram, way, starts[i], usual),
    )
    .join("\n");
}

/** Where the first response of a direction begins. @param {Lane} lane */
function startOption({ from, starts, direction }) {
  if (from || !starts) return from ?? REST;
  const place = direction === "up" ? 0 : starts.length - 4;
  return Array.from(starts.subarray(place, place + 4));
}

/** @param {number[]} start */
const isRest = (start) => start.every((value) => value === 0);

/** An excitation that the command line cannot say, as a line of Python. @param {Diagram} diagram @param {string} direction @param {number[]} start @param {Structure} usual */
function pythonScript({ structure, points, settings }, direction, start, usual) {
  const given = changedParameters(structure, usual).map(([name, value]) => [name, `${name}=${FLAGS.includes(name) ? (value ? "True" : "False") : value}`]);
  /** @param {boolean} pushes */
  const some = (pushes) => given.flatMap(([name, text]) => (PUSHES.includes(name) === pushes ? [text] : [])).join(", ");
  /** @param {"frequency" | "amplitude"} name */
  const list = (name) => `${name}=[${points.map((point) => point[name]).join(", ")}]`;
  const words = `${list("frequency")}, ${list("amplitude")}, direction="${direction}", start=[${start.join(", ")}]`;
  const how = `transient=${settings.transient}, samples=${settings.samples}`;
  const call = `orchestrate.sweep(orchestrate.Structure(${some(false)}), ${words}, ${[how, some(true)].filter(Boolean).join(", ")})`;
  return `python -c 'import orchestrate; ${call}.to_netcdf("sweep_${direction}.nc")'`;
}

/** An excitation at the command line: a range where it says it to the last bit, else a list; nothing where no number says how strong it is. @param {Point[]} points */
function excitationOptions(points) {
  if (points.every(isPaperExcitation)) {
    const etas = points.map(({ eta }) => eta);
    return rangeOption("--eta", etas, 1) || `--eta ${etas.join(",")}`;
  }
  const turns = points.map(({ frequency }) => frequency);
  const range = rangeOption("--hz", turns, 2 * Math.PI) || rangeOption("--frequency", turns, 1) || `--frequency ${turns.join(",")}`;
  const level = levelOption(points);
  return level && `${range} ${level}`;
}

/** How strongly all points are shaken; nothing where no number says it to the last bit. @param {Point[]} points */
function levelOption(points) {
  const { frequency, amplitude } = points[0];
  const level = Number(((amplitude * frequency * frequency) / GRAVITY).toPrecision(9));
  if (points.every((point) => point.amplitude === (level * GRAVITY) / (point.frequency * point.frequency))) return `--g ${level}`;
  return points.every((point) => point.amplitude === amplitude) ? `--amplitude ${amplitude}` : "";
}

/** Values as a range of decimal numbers; nothing if they are not. @param {string} option @param {number[]} values @param {number} unit of the option */
function rangeOption(option, values, unit) {
  const decimals = values.map((value) => Number((value / unit).toFixed(9)));
  const [first, last] = [decimals[0], decimals[decimals.length - 1]];
  const step = Number((decimals.length > 1 ? (last - first) / (decimals.length - 1) : 1).toPrecision(9));
  const even = values.every((value, i) => unit * Number((first + i * step).toFixed(9)) === value);
  return even ? `${option} ${first}:${last}:${step}` : "";
}

/** Whether an excitation is given by the frequency ratio alone. @param {Point} point */
function isPaperExcitation({ eta, amplitude }) {
  return amplitude === 1 / (eta * eta);
}

/** The motion that continues a response. @param {Point} point @param {number[]} start @param {{transient: number, periods: number, points: number}} asked @param {Structure} usual */
export function motionCommand(point, start, { transient, periods, points }, usual) {
  const how = `--transient ${transient} --periods ${periods} --points ${points}`;
  return `${PROGRAM} simulate ${excitationOption(point)} ${how} --start=${start.join(",")}${setOptions(point.structure, usual)}`;
}

/** The excitation of one motion. @param {Point} point */
function excitationOption(point) {
  const { eta, frequency, structure } = point;
  // 1/eta^2 m says something of a structure of 1 rad/s only
  if (isPaperExcitation(point) && Math.abs(omegaOf(structure) - 1) < 1e-9) return `--eta ${eta}`;
  const hertz = hertzAsGiven(point);
  const turns = 2 * Math.PI * hertz === frequency ? `--hz ${hertz}` : `--frequency ${frequency}`;
  return `${turns} ${levelOption([point])}`;
}
