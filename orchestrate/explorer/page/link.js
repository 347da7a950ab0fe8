/** The view as a link: what is behind the # restores it. */

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {{structure: Structure, low: number, high: number, direction: "up" | "down" | "both",
 *   eta: number | null, start: number[] | null}} View
 */

/** @param {View} view @param {Structure} usual numbers that need not be said */
export function fragmentOf({ structure, low, high, direction, eta, start }, usual) {
  const words = new URLSearchParams({ from: String(low), to: String(high), direction });
  for (const [name, value] of Object.entries(structure)) {
    if (value !== usual[/** @type {keyof Structure} */ (name)]) words.set(name, String(value));
  }
  if (eta !== null) words.set("eta", String(eta));
  if (start) words.set("start", start.join(","));
  return `#${words}`;
}

/** A view from a link; what it does not say, or says wrongly, is as in `view`. @param {string} fragment @param {View} view @param {Structure} usual @returns {View} */
export function viewOf(fragment, view, usual) {
  const words = new URLSearchParams(fragment.replace(/^#/, ""));
  /** @param {string} name @param {number} other */
  const number = (name, other) => {
    const value = words.get(name) ? Number(words.get(name)) : NaN;
    return Number.isFinite(value) ? value : other;
  };
  const structure = { ...usual };
  for (const name of /** @type {(keyof Structure)[]} */ (Object.keys(usual))) {
    structure[name] = number(name, usual[name]);
  }
  const direction = words.get("direction") ?? "";
  const start = (words.get("start") ?? "").split(",").map(Number);
  const low = number("from", view.low);
  const high = number("to", view.high);
  return {
    structure,
    ...(low > 0 && high > low ? { low, high } : { low: view.low, high: view.high }),
    direction: direction === "up" || direction === "down" || direction === "both" ? direction : view.direction,
    eta: words.get("eta") ? number("eta", 1) : null,
    start: start.length === 4 && start.every(Number.isFinite) ? start : null,
  };
}
