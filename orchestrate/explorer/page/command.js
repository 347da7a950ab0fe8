/** The commands of `orchestrate` that compute what the page shows. */

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {import("./structure.js").Point} Point
 * @typedef {import("./diagram.js").Diagram} Diagram
 */

const PROGRAM = "python -m orchestrate";

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
  const etas = points.map((point) => point.eta);
  const [first, last] = [etas[0], etas[etas.length - 1]];
  const step = Number((etas.length > 1 ? (last - first) / (etas.length - 1) : 1).toPrecision(9));
  const even = etas.every((eta, i) => Number((first + i * step).toFixed(9)) === eta);
  if (diagram.origin && !(even && points.every(isPlain))) return diagram.origin;
  const { transient, samples } = settings;
  const kept = `--transient ${transient} --samples ${samples}`;
  const starts = diagram.lanes.map(({ from, starts: known, direction: way }) => {
    if (from || !known) return from ?? [0, 0, 0, 0];
    const place = way === "up" ? 0 : known.length - 4;
    return Array.from(known.subarray(place, place + 4));
  });
  if (starts.every((start) => start.every((value) => value === 0))) {
    const range = `--eta ${first}:${last}:${step} --direction ${direction}`;
    return `${PROGRAM} sweep ${range} ${kept}${sets(structure, usual)}`;
  }
  const given = differences(structure, usual).map(([name, value]) => `${name}=${value}`).join(", ");
  const list = `[float(f"{i}e-9") for i in range(${nine(first)}, ${nine(last)} + 1, ${nine(step)})]`;
  return diagram.lanes
    .map(({ direction: way }, i) => {
      const words = `eta=${list}, direction="${way}", start=[${starts[i].join(", ")}]`;
      return `orchestrate.sweep(orchestrate.Structure(${given}), ${words}, transient=${transient}, samples=${samples})`;
    })
    .join("\n");
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
  const where = isPlain(point) ? `--eta ${eta}` : `--frequency ${frequency} --amplitude ${amplitude}`;
  const how = `--transient ${transient} --periods ${periods} --points ${points}`;
  return `${PROGRAM} simulate ${where} ${how} --start=${start.join(",")}${sets(point.structure, usual)}`;
}
