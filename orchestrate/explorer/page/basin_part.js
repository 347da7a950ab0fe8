/** The basin at the chosen frequency: asked of all workers, shown as it comes. */

import { BasinView, coarseFirst } from "./basin_view.js";
import { shares } from "./orders.js";
import { lengthOf } from "./structure.js";

const SIDE = 64; // cells

export class BasinPart {
  /** @param {(id: string) => HTMLElement} at @param {import("./crew.js").Crew} crew @param {(start: number[]) => void} choose */
  constructor(at, crew, choose) {
    this.at = at;
    this.crew = crew;
    this.view = new BasinView(/** @type {HTMLCanvasElement} */ (at("basin")), choose);
    /** @type {import("./crew.js").Order | null} */
    this.order = null;
  }

  /** @param {import("./inspector.js").Choice} choice @param {import("./response.js").Response} response */
  compute({ point }, { peak, end }) {
    this.order?.cancel();
    const reach = Math.max(peak, 1e-3) * 3;
    const mean = /** @type {[number, number]} */ ([(end[0] + end[1]) / 2, (end[2] + end[3]) / 2]);
    const plane = { side: SIDE, gap: reach, speed: reach * Math.max(point.eta, 1), mean };
    this.view.begin(point, plane);
    const asked = shares(coarseFirst(SIDE), this.crew.workers.length).map((cells) => ({ point, plane, cells }));
    const order = this.crew.askAll("basin", asked, (parts) => {
      parts.forEach((part) => this.view.take(part));
      this.tell(false, lengthOf(point));
    });
    this.order = order;
    void order.done.then(() => this.order === order && this.tell(true, lengthOf(point)));
  }

  /** @param {boolean} complete @param {number} length */
  tell(complete, length) {
    const list = this.at("basins");
    list.replaceChildren(
      ...this.view.words().map(({ colour, text }) => {
        const row = document.createElement("li");
        const key = document.createElement("span");
        key.className = "key";
        key.style.background = colour;
        row.append(key, text);
        return row;
      }),
    );
    list.dataset.complete = String(complete);
    const words = this.view.words().map(({ text }) => text);
    this.view.picture.describe(`Basins of attraction, unit of the gap ${length} m: ${words.join("; ")}`);
  }
}
