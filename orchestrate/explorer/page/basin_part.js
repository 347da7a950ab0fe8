/** Other motions at the chosen frequency: where a plane of starts leads to, asked of all workers. */

import { BasinView, coarseFirst } from "./basin_view.js";
import { shares } from "./requests.js";

const SIDE = 64; // cells

export class BasinPart {
  /**
   * @param {(id: string) => HTMLElement} at
   * @param {import("./worker_pool.js").WorkerPool} pool
   * @param {{choose: (start: number[]) => void, seen: () => void}} acts
   */
  constructor(at, pool, { choose, seen }) {
    this.at = at;
    this.pool = pool;
    this.choose = choose;
    this.view = new BasinView(/** @type {HTMLCanvasElement} */ (at("basin")), choose);
    /** @type {import("./worker_pool.js").Order | null} */
    this.order = null;
    this.point = ""; // that it was computed at
    this.visible = false;
    /** @param {IntersectionObserverEntry[]} entries */
    const watch = ([{ isIntersecting }]) => {
      this.visible = isIntersecting;
      if (isIntersecting) seen();
    };
    new IntersectionObserver(watch, { threshold: 0.4 }).observe(at("basin"));
  }

  /** Nothing is known of another point. @param {import("./structure.js").Point} point */
  leave(point) {
    if (this.point === JSON.stringify(point)) return;
    this.order?.cancel();
    this.point = "";
    this.view.clear();
    this.at("basins").replaceChildren();
  }

  /** Unless it is there. @param {import("./inspector.js").Choice} choice @param {import("./response.js").Response} response */
  compute({ point, level }, { peak, end }) {
    if (this.point === JSON.stringify(point)) return;
    this.order?.cancel();
    this.point = JSON.stringify(point);
    const reach = Math.max(peak, 1e-3) * 3;
    const mean = /** @type {[number, number]} */ ([(end[0] + end[1]) / 2, (end[2] + end[3]) / 2]);
    const plane = { side: SIDE, gap: reach, speed: reach * Math.max(point.eta, 1), mean };
    this.view.begin(point, plane, level);
    const asked = shares(coarseFirst(SIDE), this.pool.workers.length).map((cells) => ({ point, plane, cells }));
    const order = this.pool.askAll("basin", asked, (parts) => {
      parts.forEach((part) => this.view.take(part));
      this.tell(false);
    });
    this.order = order;
    void order.done.then(() => this.order === order && this.tell(true));
  }

  /** @param {boolean} complete */
  tell(complete) {
    const list = this.at("basins");
    const words = this.view.words();
    list.replaceChildren(
      ...words.map(({ colour, text, start }) => {
        const [row, key, go] = ["li", "span", "button"].map((tag) => document.createElement(tag));
        key.className = "key";
        key.style.background = colour;
        go.textContent = "Show";
        go.ariaLabel = `show: ${text}`;
        go.addEventListener("click", () => this.choose(start));
        row.append(key, text, " ", go);
        return row;
      }),
    );
    list.dataset.complete = String(complete);
    this.view.picture.describe(`Where starts lead to: ${words.map(({ text }) => text).join("; ")}`);
  }
}
