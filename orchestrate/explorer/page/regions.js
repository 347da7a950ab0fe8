/** The diagrams that were looked at: the whole, dragged regions, other parameters; back and forth. */

import { emptyDiagram } from "./diagram.js";
import { DiagramView } from "./diagram_view.js";
import { requestDiagram } from "./requests.js";
import { USUAL } from "./response.js";
import { isSameLevel } from "./excitation.js";
import { isSameStructure } from "./structure.js";

const QUICK = { transient: 100, samples: 40, tolerance: 1e-2 };
const FINE = 7900; // steps over the paper's range, as `orchestrate sweep` has them
const LEAST = 1e-6; // width of a region

export class Regions {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WorkerPool} pool
   * @param {Diagram | null} shipped
   * @param {{low: number, high: number}} whole
   * @param {() => void} told when something has come
   */
  constructor(canvas, pool, shipped, whole, told) {
    this.pool = pool;
    this.whole = whole;
    this.shipped = shipped;
    this.told = told;
    this.view = new DiagramView(canvas);
    this.seen = /** @type {Diagram[]} */ ([]);
    this.place = -1;
    this.complete = false;
    this.order = /** @type {Order | null} */ (null);
    this.timer = 0;
    this.coarse = /** @type {Diagram | null} */ (null); // to be refined once it is complete
    this.quick = false; // whether the present diagram is one of low resolution
  }

  get diagram() {
    return this.seen[this.place];
  }

  /** Frequencies that a diagram may have: as many as the screen shows apart. */
  get count() {
    return Math.max(300, Math.min(800, Math.round(this.view.picture.size.width)));
  }

  /** Look at a region of a structure's responses. @param {Structure} structure @param {Region} region @param {boolean} [quick] at low resolution, in place of the last quick one */
  open(structure, region, quick = false) {
    const { shipped, whole } = this;
    const { low, high, direction } = region;
    const covered = shipped && isOfSameBeam(shipped, structure, region) && low <= shipped.low && high >= shipped.high;
    if (covered && shipped.direction === direction) return this.showNext(shipped, null, false);
    const parent = this.diagram && isOfSameBeam(this.diagram, structure, region) ? this.diagramToStartFrom(region) : null;
    const middle = (low + high) / 2;
    const half = Math.max((high - low) / 2, LEAST / 2);
    const widened = { ...region, low: Math.max(middle - half, LEAST), high: middle + half };
    const diagram = emptyDiagram(structure, widened, quick ? 160 : this.count, quick ? QUICK : USUAL);
    this.showNext(diagram, parent, quick);
    this.coarse = !quick && !shipped && low === whole.low && high === whole.high ? diagram : null;
  }

  /** The diagram whose states a new one may begin from. @param {Region} region */
  diagramToStartFrom(region) {
    const known = [this.diagram, this.shipped].find(
      (one) => one && one.low <= region.low && one.high >= region.high && isOfSameBeam(one, this.diagram.structure, region),
    );
    return known ?? this.diagram;
  }

  /** @param {Diagram} diagram @param {Diagram | null} parent @param {boolean} quick */
  showNext(diagram, parent, quick) {
    clearTimeout(this.timer);
    if (this.quick) this.seen.splice(this.place--, 1);
    this.quick = quick;
    this.seen.splice(this.place + 1, this.seen.length, diagram);
    if (this.seen.length > 30) this.seen.shift();
    this.place = this.seen.length - 1;
    this.compute(diagram, parent);
  }

  /** @param {Diagram} diagram @param {Diagram | null} parent */
  compute(diagram, parent) {
    this.order?.cancel();
    this.complete = false;
    this.view.showDiagram(diagram, parent);
    const order = requestDiagram(this.pool, diagram, parent, (lane, found) => this.view.addResponse(lane, found));
    this.order = order;
    void order.done.then(() => {
      if (this.order !== order) return;
      this.complete = true;
      this.view.dropDiagramBelow();
      this.told();
      if (this.coarse !== diagram) return;
      // the whole again, as fine as the paper's Figure 6
      this.coarse = null;
      this.seen[this.place] = emptyDiagram(diagram.structure, diagram, FINE, USUAL);
      this.compute(this.diagram, diagram);
    });
    this.told();
  }

  /** What was seen before, or after. @param {number} steps */
  stepThroughSeen(steps) {
    const place = Math.min(Math.max(this.place + steps, 0), this.seen.length - 1);
    if (place === this.place) return;
    this.place = place;
    this.quick = false;
    const { diagram } = this;
    const whole = diagram.lanes.every(({ found }) => diagram.points.every((_, i) => found[i]));
    if (!whole) return this.compute(diagram, null);
    this.order?.cancel();
    this.order = null;
    this.complete = true;
    this.view.showDiagram(diagram, null);
    this.told();
  }

  /** Follow parameters that are being changed: quickly now, in full once they rest. @param {Structure} structure @param {Level} level @param {number} held factor of frequency ratios */
  followParameters(structure, level, held) {
    const { direction } = this.diagram;
    const [low, high] = [this.diagram.low * held, this.diagram.high * held];
    this.open(structure, { low, high, direction, level }, true);
    this.timer = window.setTimeout(() => this.open(structure, { low, high, direction, level }), 400);
  }
}

/** Whether a diagram is of a structure that is shaken as a region says. @param {Diagram} diagram @param {Structure} structure @param {Region} region */
function isOfSameBeam(diagram, structure, { level }) {
  return isSameStructure(diagram.structure, structure) && isSameLevel(diagram.level, level);
}
