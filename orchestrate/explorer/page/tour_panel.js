/** The guided tour: which of its stops is shown, and the step's text. */

export class TourPanel {
  /** @param {HTMLElement} tour @param {Record<string, string>} stops the view of each, as a link has it */
  constructor(tour, stops) {
    this.stops = stops;
    this.links = tour.querySelectorAll("a");
    this.texts = /** @type {NodeListOf<HTMLElement>} */ (tour.querySelectorAll("[data-text]"));
    this.name = ""; // of the stop that is shown
    tour.querySelector("#words-link")?.addEventListener("click", openWordList);
    for (const button of tour.querySelectorAll("[data-close]")) button.addEventListener("click", () => this.markStop(""));
  }

  /** The view of the stop that a link names, if it says no more; the stop is then marked. @param {string} fragment */
  openStopOfLink(fragment) {
    const words = new URLSearchParams(fragment.replace(/^#/, ""));
    const name = words.get("tour") ?? "";
    const known = Object.hasOwn(this.stops, name);
    this.markStop(known ? name : "");
    return known && [...words].length === 1 ? this.stops[name] : null;
  }

  /** Mark a stop and show the text of its step; without a name the tour is closed. @param {string} name */
  markStop(name) {
    this.name = name;
    const step = [...this.links].find((link) => link.hash === `#tour=${name}`)?.dataset.step ?? "";
    for (const link of this.links) {
      const here = link.closest("ol") ? step === link.dataset.step : link.hash === `#tour=${name}`;
      link.ariaCurrent = here ? "step" : null;
    }
    for (const text of this.texts) text.hidden = text.dataset.text !== step;
  }

  /** Something else than the stop is shown now; its step's text and links stay. */
  unmarkStop() {
    this.name = "";
    for (const link of this.links) if (!link.closest("ol")) link.ariaCurrent = null;
  }
}

/** Open the list of words; the link's hash stays the view's. @param {Event} event */
function openWordList(event) {
  event.preventDefault();
  const words = /** @type {HTMLDetailsElement} */ (document.getElementById("words"));
  words.open = true;
  words.scrollIntoView();
  words.querySelector("summary")?.focus();
}
