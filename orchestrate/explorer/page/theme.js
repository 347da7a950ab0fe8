/** Colours of the pictures: those of the style sheet, light or dark. */

/** @typedef {Record<"paper" | "ink" | "soft" | "grid" | "one" | "two" | "hit" | "contact" | "mark" | "up" | "down", string>} Theme */

/** @returns {Theme} */
export function currentTheme() {
  const style = getComputedStyle(document.documentElement);
  /** @param {string} name */
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    paper: colour("paper"),
    ink: colour("ink"),
    soft: colour("soft"),
    grid: colour("grid"),
    one: colour("one"),
    two: colour("two"),
    hit: colour("hit"),
    contact: colour("contact"),
    mark: colour("mark"),
    up: colour("up"),
    down: colour("down"),
  };
}

/** Red, green and blue of a colour `#rrggbb`. @param {string} colour @returns {[number, number, number]} */
export function rgbOf(colour) {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
