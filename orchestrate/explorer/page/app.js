/** The page: joins the diagram, the chosen motion, the controls, the tour and the link. */

import { BasinPanel } from "./basin_panel.js";
import { diagramCommand, motionCommand } from "./command.js";
import { Controls } from "./controls.js";
import { WorkerPool } from "./worker_pool.js";
import { nearest, startAt } from "./diagram.js";
import { listen } from "./diagram_input.js";
import { DrivePanel } from "./drive_panel.js";
import { inHertz, PAPER, pointAt, sameLevel } from "./excitation.js";
import { toDefault } from "./field.js";
import { Inspector } from "./inspector.js";
import { Library } from "./kernel.js";
import { ETAS, fragmentOf, viewOf } from "./link.js";
import { openingOf } from "./opening.js";
import { overlayOf } from "./overlay.js";
import { carried, useLibrary } from "./model.js";
import { load } from "./payload.js";
import { Player } from "./player.js";
import { Regions } from "./regions.js";
import { USUAL } from "./response.js";
import { saveShown } from "./saving.js";
import { shown } from "./scale.js";
import { Shaking } from "./shaking.js";
import { omegaOf, sameStructure } from "./structure.js";
import { TourPanel } from "./tour_panel.js";
import { frequencyUnit, showIn, unitsOption, wordsOf } from "./units.js";

const FIRST_ETA = 0.7; // of the motion that the page opens with, where its diagram has it
const REST = [0, 0, 0, 0];

/** @param {string} id @returns {HTMLElement} */
const at = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const input = (id) => /** @type {HTMLInputElement} */ (at(id));

export class App {
  /** @param {Awaited<ReturnType<typeof load>>} payload */
  constructor({ table, compiled, worker, diagram }) {
    this.table = table;
    showIn(table.shown);
    useLibrary(new Library(compiled));
    const [unit, value] = table.level;
    /** @type {View} */
    this.usual = {
      ...{ structure: table.structure, level: { unit, value }, low: table.low, high: table.high, start: null },
      direction: table.directions.length === 2 ? "both" : table.directions[0] ?? "up",
      eta: table.low < FIRST_ETA && FIRST_ETA < table.high ? FIRST_ETA : (table.low + table.high) / 2,
    };
    this.structure = table.structure;
    this.level = this.usual.level;
    this.eta = NaN;
    this.carried = false; // whether the frequency comes from the beam before, in other units
    this.waiting = false; // for the start of the chosen response
    const size = Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1));
    this.pool = new WorkerPool(worker, compiled, size);
    this.pool.onerror = (text, task) => (task === "motion" ? this.inspector.fail(text) : this.tell(text));
    this.regions = new Regions(/** @type {HTMLCanvasElement} */ (at("diagram")), this.pool, diagram, table, () => this.refreshDiagram());
    this.inspector = new Inspector(at, this.pool, table.record, () => this.refreshMotion());
    this.player = new Player(at, this.inspector, {
      tell: (text) => this.tell(text),
      changed: () => this.refreshMotion(),
    });
    this.basin = new BasinPanel(at, this.pool, table.alike, {
      choose: (start) => this.inspect(this.eta, start),
      seen: () => this.computeBasin(),
      others: () => this.hint(),
    });
    this.drive = new DrivePanel(at, this.pool, table.drive);
    this.controls = new Controls(at, this.structure, table, (structure) => this.change(structure));
    this.shaking = new Shaking(at, table.units, this.structure, this.level, {
      choose: (eta, exactly) => this.choose(eta, exactly),
      change: (structure, level) => {
        const before = this.level;
        this.change(structure, level);
        this.carried = this.carried || inHertz(before) !== inHertz(level);
      },
    });
    this.tour = new TourPanel(at("tour"), table.tour);
    this.regions.view.overlay = (pen, picture, theme) => {
      if (input("branches").checked && sameStructure(this.structure, table.structure)) {
        overlayOf(table, this.regions.view)(pen, picture, theme);
      }
    };
    this.connect();
    this.first = location.hash; // with which the page was opened
    this.restore(this.first);
    this.player.animate();
    this.refreshMotion();
  }

  /** Buttons, keys and inputs. */
  connect() {
    const { regions, inspector } = this;
    listen(regions.view, {
      choose: (eta) => this.choose(eta),
      zoom: (low, high) => this.open(low, high),
      move: (steps) => this.move(steps),
      back: () => this.go(-1),
      forth: () => this.go(1),
      whole: () => this.open(this.table.low, this.table.high),
    });
    const half = () => (regions.diagram.high - regions.diagram.low) / 2;
    const middle = () => (Number.isFinite(this.eta) ? this.eta : regions.diagram.low + half());
    /** @type {Record<string, () => void>} */
    const clicks = {
      back: () => this.go(-1),
      forth: () => this.go(1),
      whole: () => this.open(this.table.low, this.table.high),
      closer: () => this.open(middle() - 0.3 * half(), middle() + 0.3 * half()),
      "run-on": () => inspector.runOn(),
      others: () => this.showOthers(),
      link: () => this.copy(location.href, "link"),
      "command-copy": () => this.copy(at("command").textContent ?? "", "command"),
      "motion-command-copy": () => this.copy(at("motion-command").textContent ?? "", "command"),
      reset: () => this.reset(),
    };
    for (const id in clicks) at(id).addEventListener("click", clicks[id]);
    at("direction").addEventListener("change", () => this.open(regions.diagram.low, regions.diagram.high));
    at("branches").addEventListener("change", () => regions.view.refresh());
    addEventListener("hashchange", () => this.restore(location.hash));
    addEventListener("keydown", (event) => this.pressed(event));
    document.querySelectorAll("button[data-save]").forEach((button) =>
      button.addEventListener("click", () => this.tell(saveShown(/** @type {HTMLElement} */ (button).dataset.save ?? "", this))),
    );
  }

  /** Keys that count wherever one is, but in a field. @param {KeyboardEvent} event */
  pressed(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const typing = event.target instanceof HTMLInputElement && event.target.type !== "range";
    if (event.key.toLowerCase() === "s" && !typing && !(event.target instanceof HTMLSelectElement)) this.player.listen();
  }

  /** A view from a link. @param {string} fragment */
  restore(fragment) {
    const { table, usual } = this;
    const stop = this.tour.follow(fragment);
    const paper = { ...usual, structure: table.usual, level: PAPER };
    const view = viewOf(stop ?? fragment, stop === null ? usual : paper, table.ranges);
    this.set(view.structure, view.level);
    this.carried = false;
    input("direction").value = view.direction;
    this.regions.open(view.structure, view);
    const { name } = this.tour;
    // of a diagram that is still to come, the motion from rest
    if (view.eta !== null) this.choose(view.eta, true, view.start ?? (this.known(view.eta) ? null : REST));
    this.tour.show(name);
    this.write();
  }

  /** All as it was when the page was opened; what was seen is still behind Back. */
  reset() {
    toDefault(input("branches"));
    this.player.reset();
    this.drive.reset();
    this.basin.reset();
    this.restore(this.first);
    this.refreshMotion();
  }

  /** Whether it is known where the response at a frequency begins. @param {number} eta */
  known(eta) {
    const { diagram } = this.regions;
    return startAt(diagram.lanes[0], nearest(diagram, eta)) !== null;
  }

  /** @param {Structure} structure @param {Level} level */
  set(structure, level) {
    Object.assign(this, { structure, level });
    this.controls.show(structure, level);
    this.shaking.show(structure, level);
  }

  /** @param {number} low @param {number} high */
  open(low, high) {
    const direction = /** @type {View["direction"]} */ (input("direction").value);
    const inside = [Math.max(low, ETAS[0]), Math.min(Math.max(high, 2 * ETAS[0]), ETAS[1])];
    this.regions.open(this.structure, { low: inside[0], high: inside[1], direction, level: this.level });
  }

  /** @param {number} steps */
  go(steps) {
    this.regions.go(steps);
    const { diagram } = this.regions;
    input("direction").value = diagram.direction;
    const other = !sameStructure(this.structure, diagram.structure) || !sameLevel(this.level, diagram.level);
    this.set(diagram.structure, diagram.level);
    if (other) this.carryOn();
  }

  /** Other parameters: the diagram follows, the motion continues from where it was; frequencies stay, in Hz those in Hz once one was chosen there. @param {Structure} structure @param {Level} [level] */
  change(structure, level = this.level) {
    this.tour.leave();
    const hertz = inHertz(level) && inHertz(this.level) && !this.carried;
    const held = hertz ? omegaOf(this.structure) / omegaOf(structure) : 1;
    this.eta *= held;
    this.set(structure, level);
    this.regions.follow(structure, level, held);
    this.carryOn();
  }

  /** The chosen motion with the parameters of now. */
  carryOn() {
    const { choice, found } = this.inspector;
    if (!Number.isFinite(this.eta)) return;
    const point = pointAt(this.structure, this.eta, this.level);
    this.mark(point.eta);
    this.inspect(point.eta, choice ? carried(found?.response.end ?? choice.start, choice.point, point) : REST);
  }

  /** Choose a response: the nearest of the diagram, or exactly `eta`. @param {number} eta @param {boolean} [exactly] @param {number[] | null} [start] */
  choose(eta, exactly = false, start = null) {
    if (!(eta > 0)) return;
    this.carried = false;
    const { diagram } = this.regions;
    const index = nearest(diagram, eta);
    const near = diagram.points[index];
    const point = exactly && Math.abs(near.eta - eta) > 1e-9 * eta ? pointAt(this.structure, eta, this.level) : near;
    const there = startAt(diagram.lanes[0], index);
    const known = start ?? (there && carried(there, near, point));
    this.tour.leave();
    this.mark(point.eta);
    this.waiting = !known;
    if (known) this.inspect(point.eta, known);
    else {
      this.inspector.expect();
      this.tell("waits for the responses before it");
      this.write();
    }
  }

  /** @param {number} steps to the next frequencies of the diagram */
  move(steps) {
    const { points } = this.regions.diagram;
    const from = Number.isFinite(this.eta) ? nearest(this.regions.diagram, this.eta) : Math.floor(points.length / 2);
    this.choose(points[Math.min(Math.max(from + steps, 0), points.length - 1)].eta);
  }

  /** @param {number} eta */
  mark(eta) {
    this.eta = eta;
    this.regions.view.marks.eta = eta;
    this.regions.view.picture.redraw();
    this.shaking.mark(eta);
  }

  /** @param {number} eta @param {number[]} start */
  inspect(eta, start) {
    const { diagram } = this.regions;
    const near = diagram.points[nearest(diagram, eta)];
    const shownThere = near.eta === eta && sameStructure(near.structure, this.structure) && sameLevel(diagram.level, this.level);
    const point = shownThere ? near : pointAt(this.structure, eta, this.level);
    const settings = diagram.settings.transient < USUAL.transient ? USUAL : diagram.settings;
    this.basin.leave(point);
    this.inspector.choose({ point, start, settings, level: this.level });
    this.write();
  }

  /** The link of what is shown. */
  write() {
    const { low, high, direction } = this.regions.diagram;
    const { choice } = this.inspector;
    const eta = Number.isFinite(this.eta) ? this.eta : null;
    const start = choice && eta === choice.point.eta ? choice.start : null;
    const view = { structure: this.structure, level: this.level, low, high, direction, eta, start };
    history.replaceState(null, "", fragmentOf(view, this.usual, this.tour.name));
  }

  /** Something of the diagram has come. */
  refreshDiagram() {
    const { diagram, complete, place, seen } = this.regions;
    if (!diagram) return;
    const count = diagram.points.length * diagram.lanes.length;
    const ways = diagram.lanes.length > 1 ? ", up and down" : "";
    this.tell(`${diagram.points.length} frequencies${ways}: ${complete ? `all computed${openingOf(diagram)}` : "computing …"}`);
    at("diagram").dataset.complete = String(complete);
    Object.assign(input("back"), { disabled: place <= 0 });
    Object.assign(input("forth"), { disabled: place >= seen.length - 1 });
    this.shaking.reach(diagram.low, diagram.high);
    if (Number.isFinite(this.eta)) this.shaking.mark(this.eta);
    at("command").textContent = diagramCommand(diagram, this.table.usual);
    const [low, high] = [diagram.low, diagram.high].map((eta) => eta * frequencyUnit(diagram.structure, diagram.level));
    this.regions.view.picture.describe(`Orbit diagram, gap over ${wordsOf(diagram.level).frequency.replace(", ", " in ")} from ${shown(low, 6)} to ${shown(high, 6)}, ${count} responses. Arrow keys choose a frequency, plus and minus zoom, b and f go back and forth.`);
    this.write();
    this.hint();
    if (complete && this.waiting && !this.regions.quick) {
      this.waiting = false;
      this.choose(this.eta, true);
    }
  }

  /** The motion has come. */
  refreshMotion() {
    const { choice, found, periods } = this.inspector;
    this.player.refresh();
    if (!choice) return;
    const { transient, samples } = choice.settings;
    const asked = { transient: transient + samples, periods, points: 200 };
    at("motion-command").textContent = motionCommand(choice.point, choice.start, asked, this.table.usual) + unitsOption(choice.level);
    at("motion").dataset.eta = String(choice.point.eta);
    if (found && !this.basin.shown) this.basin.meet(choice, found.response);
    if (this.basin.visible) this.computeBasin();
  }

  /** Say so where other motions are known at this frequency. */
  hint() {
    const words = this.basin.hint();
    if (words) at("hint").textContent = words;
    at("hint").classList.toggle("absent", !words);
  }

  computeBasin() {
    const { found, choice } = this.inspector;
    if (found && choice) this.basin.compute(choice, found.response);
  }

  showOthers() {
    this.basin.wanted = true;
    this.computeBasin();
  }

  /** @param {string} text @param {string} what */
  copy(text, what) {
    navigator.clipboard?.writeText(text).then(
      () => this.tell(`${what} copied`),
      () => this.tell(`${what}: ${text}`),
    );
  }

  /** @param {string} text */
  tell(text) {
    at("status").textContent = text;
  }
}
