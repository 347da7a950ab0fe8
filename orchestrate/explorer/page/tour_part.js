/** The guided tour: which of its stops is shown, and the step's text. */

export class TourPart {
  /** @param {HTMLElement} tour @param {Record<string, string>} stops the view of each, as a link has it */
  constructor(tour, stops) {
    this.stops = stops;
    this.links = tour.querySelectorAll("a");
    this.texts = /** @type {NodeListOf<HTMLElement>} */ (tour.querySelectorAll("[data-text]"));
    this.name = ""; // of the stop that is shown
  }

  /** The view of the stop that a link names, if it says no more; the stop is then marked. @param {string} fragment */
  follow(fragment) {
    const words = new URLSearchParams(fragment.replace(/^#/, ""));
    const name = words.get("tour") ?? "";
    const known = Object.hasOwn(this.stops, name);
    this.show(known ? name : "");
    return known && [...words].length === 1 ? this.stops[name] : null;
  }

  /** Mark a stop and its step; none where it is no longer what is shown. @param {string} name */
  show(name) {
    this.name = name;
    const step = [...this.links].find((link) => link.hash === `#tour=${name}`)?.dataset.step ?? "";
    for (const link of this.links) {
      const here = link.closest("ol") ? step === link.dataset.step : link.hash === `#tour=${name}`;
      link.ariaCurrent = here ? "step" : null;
    }
    for (const text of this.texts) text.hidden = text.dataset.text !== step;
  }
}
