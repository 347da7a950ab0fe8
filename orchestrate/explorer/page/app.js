/** The page: joins the diagram, the chosen motion, the controls and the link. */

import { BasinPart } from "./basin_part.js";
import { diagramCommand, motionCommand } from "./command.js";
import { DrivePart } from "./drive_part.js";
import { Controls, hertz } from "./controls.js";
import { Crew } from "./crew.js";
import { nearest, scaled, startAt } from "./diagram.js";
import { listen } from "./diagram_input.js";
import { saveCsv } from "./files.js";
import { Inspector } from "./inspector.js";
import { fragmentOf, viewOf } from "./link.js";
import { overlayOf } from "./overlay.js";
import { load } from "./payload.js";
import { Regions } from "./regions.js";
import { USUAL } from "./response.js";
import { shown } from "./scale.js";
import { pointAt, sameStructure, titleOf } from "./structure.js";
import { diagramCsv, driveCsv, impactsCsv, motionCsv, sectionCsv, spectrumCsv } from "./tables.js";

/**
 * @typedef {import("./structure.js").Structure} Structure
 * @typedef {import("./diagram.js").Direction} Direction
 */

/** @param {string} id @returns {HTMLElement} */
const at = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const input = (id) => /** @type {HTMLInputElement} */ (at(id));

export class App {
  /** @param {Awaited<ReturnType<typeof load>>} payload */
  constructor({ table, compiled, worker, diagram }) {
    this.table = table;
    const size = Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1));
    this.crew = new Crew(worker, compiled, size);
    this.crew.onerror = (text) => this.tell(text);
    this.regions = new Regions(/** @type {HTMLCanvasElement} */ (at("diagram")), this.crew, diagram, table, () => this.refreshDiagram());
    this.inspector = new Inspector(at, this.crew, () => this.refreshMotion());
    this.basin = new BasinPart(at, this.crew, (start) => this.inspect(this.eta, start));
    this.drive = new DrivePart(at, this.crew, table.drive);
    this.structure = table.structure;
    this.controls = new Controls(at("sliders"), at("si"), table.ranges, (structure) => this.change(structure));
    /** @type {number} */
    this.eta = NaN;
    this.waiting = false; // for the start of the chosen response
    this.regions.view.overlay = (pen, picture, theme) => {
      if (input("branches").checked && sameStructure(this.structure, table.structure)) {
        overlayOf(table, this.regions.view)(pen, picture, theme);
      }
    };
    this.connect();
    this.restore(location.hash);
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
      play: () => this.play(),
      impact: () => this.nextImpact(),
      listen: () => this.listen(),
      "basin-go": () => inspector.found && inspector.choice && this.basin.compute(inspector.choice, inspector.found.response),
      link: () => this.copy(location.href, "link"),
      "command-copy": () => this.copy(at("command").textContent ?? "", "command"),
      "motion-command-copy": () => this.copy(at("motion-command").textContent ?? "", "command"),
      reset: () => this.change(this.table.structure, true),
    };
    for (const id in clicks) at(id).addEventListener("click", clicks[id]);
    at("direction").addEventListener("change", () => this.open(regions.diagram.low, regions.diagram.high));
    at("beside").addEventListener("change", () => inspector.drawMotion());
    at("branches").addEventListener("change", () => regions.view.refresh());
    at("speed").addEventListener("input", () => (inspector.animation.speed = 2 ** input("speed").valueAsNumber));
    at("periods").addEventListener("change", () => this.setPeriods());
    at("pitch").addEventListener("change", () => inspector.sound.playing && inspector.listen(input("pitch").valueAsNumber));
    this.connectFrequency();
    addEventListener("hashchange", () => this.restore(location.hash));
    document.querySelectorAll("button[data-save]").forEach((button) =>
      button.addEventListener("click", () => this.save(/** @type {HTMLElement} */ (button).dataset.save ?? "")),
    );
  }

  connectFrequency() {
    at("eta").addEventListener("input", () => this.choose(input("eta").valueAsNumber));
    at("eta-number").addEventListener("change", () => this.choose(input("eta-number").valueAsNumber, true));
    at("hertz").addEventListener("change", () =>
      this.choose(hertz.eta(input("hertz").valueAsNumber, this.structure), true),
    );
  }

  /** A view from a link. @param {string} fragment */
  restore(fragment) {
    const { table } = this;
    const usual = { structure: table.structure, low: table.low, high: table.high, direction: table.directions.length === 2 ? /** @type {const} */ ("both") : table.directions[0] ?? "up" };
    const view = viewOf(fragment, { ...usual, eta: null, start: null }, table.structure);
    this.structure = view.structure;
    this.controls.show(view.structure);
    input("direction").value = view.direction;
    this.regions.open(view.structure, view);
    if (view.eta !== null) this.choose(view.eta, true, view.start);
  }

  /** @param {number} low @param {number} high */
  open(low, high) {
    const direction = /** @type {Direction} */ (input("direction").value);
    const inside = [Math.max(low, 1e-3), Math.min(Math.max(high, 2e-3), 1000)];
    this.regions.open(this.structure, { low: inside[0], high: inside[1], direction });
  }

  /** @param {number} steps */
  go(steps) {
    this.regions.go(steps);
    const { diagram } = this.regions;
    input("direction").value = diagram.direction;
    this.structure = diagram.structure;
    this.controls.show(diagram.structure);
  }

  /** Other parameters. @param {Structure} structure @param {boolean} [shown] whether the controls are to be set */
  change(structure, shown = false) {
    this.structure = structure;
    if (shown) this.controls.show(structure);
    this.regions.follow(structure);
    if (Number.isFinite(this.eta)) this.waiting = true;
  }

  /** Choose a response: the nearest of the diagram, or exactly `eta`. @param {number} eta @param {boolean} [exactly] @param {number[] | null} [start] */
  choose(eta, exactly = false, start = null) {
    if (!(eta > 0)) return;
    const { diagram } = this.regions;
    const index = nearest(diagram, eta);
    const near = diagram.points[index];
    const point = exactly && Math.abs(near.eta - eta) > 1e-12 * eta ? pointAt(this.structure, eta) : near;
    const there = startAt(diagram.lanes[0], index);
    const known = start ?? (there && scaled(there, near, point));
    this.mark(point.eta);
    this.waiting = !known;
    if (known) this.inspect(point.eta, known);
    else this.tell(`η = ${point.eta}: waits for the responses before it`);
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
    input("eta").value = String(eta);
    input("eta-number").value = String(eta);
    input("hertz").value = String(Number(hertz.of(eta, this.structure).toPrecision(9)));
  }

  /** @param {number} eta @param {number[]} start */
  inspect(eta, start) {
    const { diagram } = this.regions;
    const near = diagram.points[nearest(diagram, eta)];
    const point = near.eta === eta ? near : pointAt(this.structure, eta);
    this.inspector.choose({ point, start, settings: diagram.settings.transient < USUAL.transient ? USUAL : diagram.settings });
    this.write();
  }

  /** The link of what is shown. */
  write() {
    const { low, high, direction } = this.regions.diagram;
    const { choice } = this.inspector;
    const eta = Number.isFinite(this.eta) ? this.eta : null;
    const view = { structure: this.structure, low, high, direction, eta, start: choice && eta === choice.point.eta ? choice.start : null };
    history.replaceState(null, "", fragmentOf(view, this.table.structure));
  }

  /** Something of the diagram has come. */
  refreshDiagram() {
    const { diagram, complete, took, place, seen } = this.regions;
    if (!diagram) return;
    const count = diagram.points.length * diagram.lanes.length;
    const { transient, samples } = diagram.settings;
    const time = complete && took ? ` in ${shown(took.all / 1000, 2)} s` : " …";
    this.tell(`${count} responses × ${transient + samples} periods, η ${shown(diagram.low, 6)} to ${shown(diagram.high, 6)}${time}`);
    at("diagram").dataset.complete = String(complete);
    Object.assign(input("back"), { disabled: place <= 0 });
    Object.assign(input("forth"), { disabled: place >= seen.length - 1 });
    Object.assign(input("eta"), { min: diagram.low, max: diagram.high, step: (diagram.high - diagram.low) / 2000 });
    if (Number.isFinite(this.eta)) input("eta").value = String(this.eta);
    at("structure").textContent = titleOf(this.structure);
    at("command").textContent = diagramCommand(diagram, this.table.usual);
    this.regions.view.picture.describe(`Orbit diagram, gap over frequency ratio from ${shown(diagram.low, 6)} to ${shown(diagram.high, 6)}, ${count} responses. Arrow keys choose a frequency, plus and minus zoom, b and f go back and forth.`);
    this.write();
    if (complete && this.waiting && !this.regions.quick) {
      this.waiting = false;
      this.choose(this.eta, true);
    }
  }

  /** The motion has come. */
  refreshMotion() {
    const { choice, periods } = this.inspector;
    if (!choice) return;
    const { transient, samples } = choice.settings;
    const asked = { transient: transient + samples, periods, points: 200 };
    at("motion-command").textContent = motionCommand(choice.point, choice.start, asked, this.table.usual);
    at("listen").textContent = this.inspector.sound.playing ? "Silence" : "Listen";
    at("motion").dataset.eta = String(choice.point.eta);
  }

  play() {
    const { animation } = this.inspector;
    animation.run(!animation.running);
    at("play").textContent = animation.running ? "Pause" : "Play";
  }

  nextImpact() {
    const turn = this.inspector.animation.nextImpact();
    at("play").textContent = "Play";
    this.tell(turn === null ? "no impact in this motion" : `impact at period ${turn.toFixed(4)} of the motion`);
  }

  listen() {
    const { sound } = this.inspector;
    if (sound.playing) sound.stop();
    else this.inspector.listen(input("pitch").valueAsNumber);
    this.refreshMotion();
  }

  setPeriods() {
    const periods = Math.round(input("periods").valueAsNumber);
    if (!(periods >= 1 && periods <= 200)) return;
    this.inspector.periods = periods;
    if (this.inspector.choice) this.inspector.choose(this.inspector.choice);
  }

  /** @param {string} words of a file: what, and the kind */
  save(words) {
    const [name, kind] = words.split(".");
    const { found, choice, section, spectra, pictures, animation } = this.inspector;
    /** @type {Record<string, import("./picture.js").Picture>} */
    const shownPictures = { ...pictures.pictures, diagram: this.regions.view.picture, basin: this.basin.view.picture, drive: this.drive.picture, animation: animation.picture };
    const file = `${name}_eta${Number.isFinite(this.eta) ? this.eta : ""}`;
    if (kind === "png") shownPictures[name].savePng(file);
    if (kind === "svg") shownPictures[name].saveSvg(file);
    if (kind !== "csv") return;
    if (name === "diagram") void saveCsv(file, diagramCsv(this.regions.diagram));
    if (name === "section" && section.length) void saveCsv(file, sectionCsv(section));
    if (name === "spectrum" && spectra) void saveCsv(file, spectrumCsv(spectra));
    if (name === "history" && found && choice) void saveCsv(file, motionCsv(found.motion, choice.point));
    if (name === "drive") void saveCsv(file, driveCsv(this.drive.rows));
    if (name === "impacts" && found) void saveCsv(file, impactsCsv(found.motion));
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
