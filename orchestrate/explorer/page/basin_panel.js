/** Other motions at the chosen frequency: where a plane of starts leads to, asked of all workers. */

import { attractorOf, isOtherAttractor, addOrFindAttractor } from "./basin.js";
import { BasinView, cellsCoarseFirst } from "./basin_view.js";
import { dealOut } from "./requests.js";
import { lengthOf } from "./structure.js";

const SIDE = 64; // cells
const FEW = [6, 19, 32, 45, 58]; // columns and rows of the cells that are tried for every motion

export class BasinPanel {
  /**
   * @param {(id: string) => HTMLElement} at
   * @param {WorkerPool} pool
   * @param {number} alike distance within which two motions are one
   * @param {{choose: (start: number[]) => void, seen: () => void, others: () => void}} acts
   *   `others`: it is known by now whether there are other motions
   */
  constructor(at, pool, alike, { choose, seen, others }) {
    this.alike = alike;
    this.at = at;
    this.pool = pool;
    this.choose = choose;
    this.view = new BasinView(/** @type {HTMLCanvasElement} */ (at("basin")), alike, choose);
    this.order = /** @type {Order | null} */ (null);
    this.told = others;
    this.shown = /** @type {Attractor | null} */ (null); // the motion on the page
    this.few = /** @type {Attractor[]} */ ([]); // to which a few starts lead
    this.trial = /** @type {Order | null} */ (null);
    this.tried = false; // whether all of the few have come
    this.point = ""; // that is shown
    this.mapped = false; // whether its picture is, or will be
    this.visible = false;
    this.wanted = false; // whether it was ever asked for
    /** @param {IntersectionObserverEntry[]} entries */
    const watch = ([{ isIntersecting }]) => {
      this.visible = isIntersecting;
      if (isIntersecting) seen();
    };
    new IntersectionObserver(watch, { threshold: 0.4 }).observe(at("basin-figure"));
  }

  /** Nothing is known of another point. @param {Point} point */
  forgetOtherPoint(point) {
    this.trial?.cancel();
    this.trial = null;
    if (!this.tried) this.few = [];
    this.shown = null;
    this.told();
    const text = JSON.stringify(point);
    if (this.point === text) return;
    this.point = text;
    this.forgetAttractors();
  }

  /** As when the page was opened. */
  reset() {
    this.wanted = false;
    this.at("basin-map").hidden = true;
    this.forgetAttractors();
  }

  /** Nothing is known. */
  forgetAttractors() {
    this.order?.cancel();
    this.mapped = false;
    this.few = [];
    this.tried = false;
    this.view.clearMap();
    this.at("basins").replaceChildren();
    this.told();
  }

  /** Whether a motion is known to which the one that is shown is another. */
  get hasOtherMotions() {
    const { shown } = this;
    return shown !== null && [...this.view.attractors, ...this.few].some((one) => isOtherAttractor(shown, one, this.alike));
  }

  /** What is known of other motions. */
  hintWords() {
    const complete = this.mapped && this.at("basins").dataset.complete === "true";
    if (this.hasOtherMotions) return complete ? "Other motions: the coloured map." : "There is another motion.";
    return complete ? `No other motion from ${SIDE * SIDE} starts.` : "";
  }

  /** A motion is shown: mark it, and try a few starts. @param {Choice} choice @param {Settled} response */
  setShownMotion({ point }, response) {
    this.shown = attractorOf(response, point);
    if (this.mapped) this.listAttractors(this.at("basins").dataset.complete === "true");
    this.told();
    if (this.mapped || this.few.length) return;
    const cells = FEW.flatMap((column) => FEW.map((row) => [column, row]));
    const trial = this.pool.ask("basin", { point, plane: planeAround(point, response), cells }, (parts) => {
      for (const part of parts) addOrFindAttractor(this.few, part, this.alike);
      this.told();
    });
    this.trial = trial;
    void trial.done.then(() => {
      if (this.trial !== trial) return;
      this.tried = true;
      this.told();
    });
  }

  /** Unless it is there. @param {Choice} choice @param {Settled} response */
  computeMap({ point, level }, response) {
    if (!this.wanted || this.mapped) return;
    this.order?.cancel();
    this.mapped = true;
    const plane = planeAround(point, response);
    this.view.startMap(point, plane, level);
    const asked = dealOut(cellsCoarseFirst(SIDE), this.pool.workers.length).map((cells) => ({ point, plane, cells }));
    const order = this.pool.askAll("basin", asked, (parts) => {
      parts.forEach((part) => this.view.addCell(part));
      this.listAttractors(false);
    });
    this.order = order;
    this.at("basins").dataset.complete = "false";
    void order.done.then(() => this.order === order && this.listAttractors(true));
  }

  /** @param {boolean} complete */
  listAttractors(complete) {
    const list = this.at("basins");
    const words = this.view.attractorWords(this.shown);
    list.replaceChildren(
      ...words.map(({ colour, text, now, start }) => {
        const [row, key, go] = ["li", "span", "button"].map((tag) => document.createElement(tag));
        key.className = "key";
        key.style.background = colour;
        go.textContent = "Show";
        go.ariaLabel = `show: ${text}`;
        go.addEventListener("click", () => this.choose(start));
        const words = Object.assign(document.createElement("span"), { textContent: text });
        row.append(key, words, now ? Object.assign(document.createElement("span"), { className: "now", textContent: "shown now" }) : go);
        return row;
      }),
    );
    list.dataset.complete = String(complete);
    if (complete || words.length > 1) this.at("basin-map").hidden = words.length < 2; // one colour says nothing
    this.told();
    this.view.picture.describe(`Where starts lead to: ${words.map(({ text }) => text).join("; ")}`);
  }
}

/** The plane of starts around a response. @param {Point} point @param {Settled} response @returns {Plane} */
function planeAround(point, { peak, end }) {
  const { eta, structure } = point;
  const reach = Math.max(peak, 1e-3) * 3;
  const gap = structure.stroke ? Math.min(reach, structure.stroke / lengthOf(point)) : reach;
  return { side: SIDE, gap, speed: reach * Math.max(eta, 1), mean: [(end[0] + end[1]) / 2, (end[2] + end[3]) / 2] };
}
