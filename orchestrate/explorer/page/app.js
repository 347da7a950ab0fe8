/** The page: joins the diagram, the chosen motion, the controls, the tour and the link. */

import { BasinPanel } from "./basin_panel.js";
import { diagramCommand, motionCommand } from "./command.js";
import { Controls } from "./controls.js";
import { WorkerPool, workerCount } from "./worker_pool.js";
import { nearestIndex, startOfResponse } from "./diagram.js";
import { listenToDiagram } from "./diagram_input.js";
import { DrivePanel } from "./drive_panel.js";
import { isInHertz, PAPER, pointAt, isSameLevel } from "./excitation.js";
import { resetToDefault } from "./field.js";
import { Inspector } from "./inspector.js";
import { Library } from "./kernel.js";
import { ETAS, linkFragment, viewFromLink } from "./link.js";
import { openingWords } from "./opening.js";
import { branchOverlay } from "./overlay.js";
import { carryState, useLibrary } from "./model.js";
import { loadPayload } from "./payload.js";
import { Player } from "./player.js";
import { Regions } from "./regions.js";
import { USUAL } from "./response.js";
import { saveShown } from "./saving.js";
import { formatNumber } from "./scale.js";
import { Shaking } from "./shaking.js";
import { omegaOf, isSameStructure } from "./structure.js";
import { TourPanel } from "./tour_panel.js";
import { ratioUnit, setShownUnits, unitsOption, axisWords } from "./units.js";

const FIRST_ETA = 0.7; // of the motion that the page opens with, where its diagram has it
const REST = [0, 0, 0, 0];

/** @param {string} id @returns {HTMLElement} */
const at = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const input = (id) => /** @type {HTMLInputElement} */ (at(id));

export class App {
  /** @param {Awaited<ReturnType<typeof loadPayload>>} payload */
  constructor({ table, compiled, worker, diagram }) {
    this.table = table;
    setShownUnits(table.shown);
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
    this.pool = new WorkerPool(worker, compiled, workerCount());
    this.pool.onerror = (text, task) => (task === "motion" ? this.inspector.showFailure(text) : this.showStatus(text));
    this.regions = new Regions(/** @type {HTMLCanvasElement} */ (at("diagram")), this.pool, diagram, table, () => this.updateDiagramTexts());
    this.inspector = new Inspector(at, this.pool, table.record, () => this.updateMotionTexts());
    this.player = new Player(at, this.inspector, {
      tell: (text) => this.showStatus(text),
      changed: () => this.updateMotionTexts(),
    });
    this.basin = new BasinPanel(at, this.pool, table.alike, {
      choose: (start) => this.inspect(this.eta, start),
      seen: () => this.computeBasin(),
      others: () => this.showHint(),
    });
    this.drive = new DrivePanel(at, this.pool, table.drive);
    this.controls = new Controls(at, this.structure, table, (structure) => this.changeBeam(structure));
    this.shaking = new Shaking(at, table.units, this.structure, this.level, {
      choose: (eta, exactly) => this.choose(eta, exactly),
      change: (structure, level) => {
        const before = this.level;
        this.changeBeam(structure, level);
        this.carried = this.carried || isInHertz(before) !== isInHertz(level);
      },
    });
    this.tour = new TourPanel(at("tour"), table.tour);
    this.regions.view.overlay = (pen, picture, theme) => {
      if (input("branches").checked && isSameStructure(this.structure, table.structure)) {
        branchOverlay(table, this.regions.view)(pen, picture, theme);
      }
    };
    this.connectElements();
    this.first = location.hash; // with which the page was opened
    this.openLink(this.first);
    this.player.startAnimation();
    this.updateMotionTexts();
  }

  /** Buttons, keys and inputs. */
  connectElements() {
    const { regions, inspector } = this;
    const views = {
      back: () => this.stepThroughDiagrams(-1),
      forth: () => this.stepThroughDiagrams(1),
      whole: () => this.open(this.table.low, this.table.high),
    };
    listenToDiagram(regions.view, {
      choose: (eta) => this.choose(eta),
      zoom: (low, high) => this.open(low, high),
      move: (steps) => {
        const { points } = regions.diagram;
        const from = Number.isFinite(this.eta) ? nearestIndex(regions.diagram, this.eta) : Math.floor(points.length / 2);
        this.choose(points[Math.min(Math.max(from + steps, 0), points.length - 1)].eta);
      },
      ...views,
    });
    const half = () => (regions.diagram.high - regions.diagram.low) / 2;
    const middle = () => (Number.isFinite(this.eta) ? this.eta : regions.diagram.low + half());
    /** @type {Record<string, () => void>} */
    const clicks = {
      ...views,
      closer: () => this.open(middle() - 0.3 * half(), middle() + 0.3 * half()),
      "run-on": () => inspector.extendSection(),
      others: () => {
        this.basin.wanted = true;
        this.computeBasin();
      },
      link: () => this.copyText(location.href, "link"),
      "command-copy": () => this.copyText(at("command").textContent ?? "", "command"),
      "motion-command-copy": () => this.copyText(at("motion-command").textContent ?? "", "command"),
      reset: () => this.reset(),
    };
    for (const id in clicks) at(id).addEventListener("click", clicks[id]);
    at("direction").addEventListener("change", () => this.open(regions.diagram.low, regions.diagram.high));
    at("branches").addEventListener("change", () => regions.view.redrawAll());
    addEventListener("hashchange", () => this.openLink(location.hash));
    addEventListener("keydown", (event) => this.actOnKey(event));
    document.querySelectorAll("button[data-save]").forEach((button) =>
      button.addEventListener("click", () => this.showStatus(saveShown(/** @type {HTMLElement} */ (button).dataset.save ?? "", this))),
    );
  }

  /** Keys that count wherever one is, but in a field. @param {KeyboardEvent} event */
  actOnKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const typing = event.target instanceof HTMLInputElement && event.target.type !== "range";
    if (event.key.toLowerCase() === "s" && !typing && !(event.target instanceof HTMLSelectElement)) this.player.toggleSound();
  }

  /** A view from a link. @param {string} fragment */
  openLink(fragment) {
    const { table, usual } = this;
    const stop = this.tour.openStopOfLink(fragment);
    const paper = { ...usual, structure: table.usual, level: PAPER };
    const view = viewFromLink(stop ?? fragment, stop === null ? usual : paper, table.ranges);
    this.showBeam(view.structure, view.level);
    this.carried = false;
    input("direction").value = view.direction;
    this.regions.open(view.structure, view);
    const { name } = this.tour;
    if (view.eta !== null) {
      const { diagram } = this.regions;
      const known = startOfResponse(diagram.lanes[0], nearestIndex(diagram, view.eta));
      // of a diagram that is still to come, the motion from rest
      this.choose(view.eta, true, view.start ?? (known ? null : REST));
    }
    this.tour.markStop(name);
    this.writeLink();
  }

  /** All as it was when the page was opened; what was seen is still behind Back. */
  reset() {
    resetToDefault(input("branches"));
    this.player.reset();
    this.drive.reset();
    this.basin.reset();
    this.openLink(this.first);
    this.updateMotionTexts();
  }

  /** @param {Structure} structure @param {Level} level */
  showBeam(structure, level) {
    Object.assign(this, { structure, level });
    this.controls.showStructure(structure, level);
    this.shaking.showBeam(structure, level);
  }

  /** @param {number} low @param {number} high */
  open(low, high) {
    const direction = /** @type {View["direction"]} */ (input("direction").value);
    const inside = [Math.max(low, ETAS[0]), Math.min(Math.max(high, 2 * ETAS[0]), ETAS[1])];
    this.regions.open(this.structure, { low: inside[0], high: inside[1], direction, level: this.level });
  }

  /** @param {number} steps */
  stepThroughDiagrams(steps) {
    this.regions.stepThroughSeen(steps);
    const { diagram } = this.regions;
    input("direction").value = diagram.direction;
    const other = !isSameStructure(this.structure, diagram.structure) || !isSameLevel(this.level, diagram.level);
    this.showBeam(diagram.structure, diagram.level);
    if (other) this.continueMotion();
  }

  /** Other parameters: the diagram follows, the motion continues from where it was; frequencies stay, in Hz those in Hz once one was chosen there. @param {Structure} structure @param {Level} [level] */
  changeBeam(structure, level = this.level) {
    this.tour.unmarkStop();
    const hertz = isInHertz(level) && isInHertz(this.level) && !this.carried;
    const held = hertz ? omegaOf(this.structure) / omegaOf(structure) : 1;
    this.eta *= held;
    this.showBeam(structure, level);
    this.regions.followParameters(structure, level, held);
    this.continueMotion();
  }

  /** The chosen motion with the parameters of now. */
  continueMotion() {
    const { choice, found } = this.inspector;
    if (!Number.isFinite(this.eta)) return;
    const point = pointAt(this.structure, this.eta, this.level);
    this.markFrequency(point.eta);
    this.inspect(point.eta, choice ? carryState(found?.response.end ?? choice.start, choice.point, point) : REST);
  }

  /** Choose a response: the nearest of the diagram, or exactly `eta`. @param {number} eta @param {boolean} [exactly] @param {number[] | null} [start] */
  choose(eta, exactly = false, start = null) {
    if (!(eta > 0)) return;
    this.carried = false;
    const { diagram } = this.regions;
    const index = nearestIndex(diagram, eta);
    const near = diagram.points[index];
    const point = exactly && Math.abs(near.eta - eta) > 1e-9 * eta ? pointAt(this.structure, eta, this.level) : near;
    const there = startOfResponse(diagram.lanes[0], index);
    const known = start ?? (there && carryState(there, near, point));
    this.tour.unmarkStop();
    this.markFrequency(point.eta);
    this.waiting = !known;
    if (known) this.inspect(point.eta, known);
    else {
      this.inspector.awaitMotion();
      this.showStatus("waits for the responses before it");
      this.writeLink();
    }
  }

  /** @param {number} eta */
  markFrequency(eta) {
    this.eta = eta;
    this.regions.view.marks.eta = eta;
    this.regions.view.picture.redraw();
    this.shaking.showFrequency(eta);
  }

  /** @param {number} eta @param {number[]} start */
  inspect(eta, start) {
    const { diagram } = this.regions;
    const near = diagram.points[nearestIndex(diagram, eta)];
    const shownThere = near.eta === eta && isSameStructure(near.structure, this.structure) && isSameLevel(diagram.level, this.level);
    const point = shownThere ? near : pointAt(this.structure, eta, this.level);
    const settings = diagram.settings.transient < USUAL.transient ? USUAL : diagram.settings;
    this.basin.forgetOtherPoint(point);
    this.inspector.showMotion({ point, start, settings, level: this.level });
    this.writeLink();
  }

  /** The link of what is shown. */
  writeLink() {
    const { low, high, direction } = this.regions.diagram;
    const { choice } = this.inspector;
    const eta = Number.isFinite(this.eta) ? this.eta : null;
    const start = choice && eta === choice.point.eta ? choice.start : null;
    const view = { structure: this.structure, level: this.level, low, high, direction, eta, start };
    history.replaceState(null, "", linkFragment(view, this.usual, this.tour.name));
  }

  /** Something of the diagram has come. */
  updateDiagramTexts() {
    const { diagram, complete, place, seen } = this.regions;
    if (!diagram) return;
    const count = diagram.points.length * diagram.lanes.length;
    const ways = diagram.lanes.length > 1 ? ", up and down" : "";
    this.showStatus(`${diagram.points.length} frequencies${ways}: ${complete ? `all computed${openingWords(diagram)}` : "computing …"}`);
    at("diagram").dataset.complete = String(complete);
    Object.assign(input("back"), { disabled: place <= 0 });
    Object.assign(input("forth"), { disabled: place >= seen.length - 1 });
    this.shaking.setSliderRange(diagram.low, diagram.high);
    if (Number.isFinite(this.eta)) this.shaking.showFrequency(this.eta);
    at("command").textContent = diagramCommand(diagram, this.table.usual);
    const [low, high] = [diagram.low, diagram.high].map((eta) => eta * ratioUnit(diagram.structure, diagram.level));
    this.regions.view.picture.describe(`Orbit diagram, gap over ${axisWords(diagram.level).frequency.replace(", ", " in ")} from ${formatNumber(low, 6)} to ${formatNumber(high, 6)}, ${count} responses. Arrow keys choose a frequency, plus and minus zoom, b and f go back and forth.`);
    this.writeLink();
    this.showHint();
    if (complete && this.waiting && !this.regions.quick) {
      this.waiting = false;
      this.choose(this.eta, true);
    }
  }

  /** The motion has come. */
  updateMotionTexts() {
    const { choice, found, periods } = this.inspector;
    this.player.updateButtons();
    if (!choice) return;
    const { transient, samples } = choice.settings;
    const asked = { transient: transient + samples, periods, points: 200 };
    at("motion-command").textContent = motionCommand(choice.point, choice.start, asked, this.table.usual) + unitsOption(choice.level);
    at("motion").dataset.eta = String(choice.point.eta);
    if (found && !this.basin.shown) this.basin.setShownMotion(choice, found.response);
    if (this.basin.visible) this.computeBasin();
  }

  /** Say so where other motions are known at this frequency. */
  showHint() {
    const words = this.basin.hintWords();
    if (words) at("hint").textContent = words;
    at("hint").classList.toggle("absent", !words);
  }

  computeBasin() {
    const { found, choice } = this.inspector;
    if (found && choice) this.basin.computeMap(choice, found.response);
  }

  /** @param {string} text @param {string} what */
  copyText(text, what) {
    navigator.clipboard?.writeText(text).then(
      () => this.showStatus(`${what} copied`),
      () => this.showStatus(`${what}: ${text}`),
    );
  }

  /** @param {string} text */
  showStatus(text) {
    at("status").textContent = text;
  }
}
