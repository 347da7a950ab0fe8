/** Colours of the pictures: those of the style sheet, light or dark. */

/** @type {(keyof Theme)[]} */
const NAMES = ["paper", "ink", "soft", "grid", "one", "two", "hit", "contact", "mark", "up", "down"];

export function currentTheme() {
  const style = getComputedStyle(document.documentElement);
  return /** @type {Theme} */ (Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()])));
}

/** Red, green and blue of a colour `#rrggbb`. @param {string} colour @returns {[number, number, number]} */
export function rgbOf(colour) {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
