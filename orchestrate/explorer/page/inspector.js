/** The chosen response: its motion, section, spectrum, sound; each asked of the workers. */

import { Animation } from "./animation.js";
import { axisAround } from "./chart.js";
import { shownColumns, historyChart, motionPictures, phaseChart, sectionChart, spectrumChart } from "./motion_view.js";
import { openingLevelWords } from "./opening.js";
import { repeatPeriods } from "./response.js";
import { formatNumber } from "./scale.js";
import { Sound } from "./audio.js";
import { averageWords, exponentWords, responseNumbers, responseSentence } from "./response_words.js";

const POINTS = 200; // a period
const LONG = 20000; // periods of a section that runs on

export class Inspector {
  /** @param {(id: string) => HTMLElement} at @param {WorkerPool} pool @param {Measured | null} record @param {() => void} told */
  constructor(at, pool, record, told) {
    this.record = record;
    this.at = at;
    this.pool = pool;
    this.told = told;
    this.pictures = motionPictures(at);
    this.animation = new Animation(/** @type {HTMLCanvasElement} */ (at("animation")));
    this.sound = new Sound();
    this.periods = 10;
    this.pitch = 4; // periods a second that are heard
    this.choice = /** @type {Choice | null} */ (null);
    this.orders = /** @type {Order[]} */ ([]);
    this.found = /** @type {{response: Settled, motion: Motion} | null} */ (null);
    this.spectra = /** @type {any} */ (null);
    this.exponent = /** @type {Exponent | null | undefined} */ (undefined);
    this.bonded = /** @type {Motion | null} */ (null);
    /** @type {Float64Array} */
    this.section = new Float64Array(0);
  }

  /** Show the motion of a response. @param {Choice} choice */
  showMotion(choice) {
    this.awaitMotion();
    this.choice = choice;
    this.request("motion", { ...choice, periods: this.periods, points: POINTS }, ([found]) => this.receiveMotion(found), true);
  }

  /** Another motion is to come: the one before is no longer the chosen one. */
  awaitMotion() {
    this.orders.forEach((order) => order.cancel());
    this.orders = [];
    this.sound.stop(); // it belongs to the motion before
    Object.assign(this, { found: null, spectra: null, bonded: null, exponent: undefined, section: new Float64Array(0) });
    this.at("exponent").textContent = "…";
    this.setMotionState("coming");
  }

  /** Whether the chosen motion is there yet: until then what is seen of the one before pales. @param {"coming" | "there" | "failed"} state */
  setMotionState(state) {
    const page = this.at("motion").parentElement;
    if (page) page.dataset.motion = state;
  }

  /** The chosen motion cannot be computed: say so in place of the one before. @param {string} text */
  showFailure(text) {
    this.setMotionState("failed");
    this.at("sentence").textContent = `This motion cannot be computed: ${text}`;
    this.at("exponent").textContent = "–";
    this.listNumbers({});
  }

  /** @param {string} task @param {unknown} asked @param {(parts: any[]) => void} take @param {boolean} [urgent] */
  request(task, asked, take, urgent) {
    this.orders.push(this.pool.ask(task, asked, take, urgent));
  }

  /** @param {{response: Settled, motion: Motion}} found */
  receiveMotion(found) {
    this.found = found;
    this.setMotionState("there");
    this.section = found.response.states;
    const { point } = /** @type {Choice} */ (this.choice);
    if (!point.structure.wall) {
      // the same beam without its delamination, from rest; to a wall nothing can be glued
      const settings = { transient: 2000, samples: 1, tolerance: 1e-2 };
      const asked = { point: undamagedPoint(point), start: [0, 0, 0, 0], settings, periods: this.periods, points: POINTS };
      this.request("motion", asked, ([{ motion }]) => {
        this.bonded = motion;
        this.drawMotion();
      });
    }
    this.request("spectra", { point, start: found.response.end }, (parts) => parts.forEach((part) => this.receiveSpectraOrExponent(part)));
    if (this.sound.wanted) this.playImpacts(this.pitch);
    this.drawMotion();
    this.drawSection();
    this.animation.setMotion(found.motion, point);
    this.animation.picture.describe(`Animation of box and masses at frequency ratio ${formatNumber(point.eta, 6)}, ${found.motion.impactTime.length} impacts`);
    this.showNumbers();
    this.told();
  }

  showNumbers() {
    const { point, level } = /** @type {Choice} */ (this.choice);
    const { response, motion } = /** @type {{response: Settled, motion: Motion}} */ (this.found);
    this.at("sentence").textContent = responseSentence(response, this.exponent, motion.contact.some(Boolean), openingLevelWords(point, level));
    this.at("average").textContent = averageWords(response.gaps.length);
    this.at("average").classList.toggle("absent", repeatPeriods(response) > 0 || !response.impacts);
    this.listNumbers(responseNumbers(response, point, level, this.exponent));
  }

  /** Show numbers by name in place of those before. @param {Record<string, string>} numbers */
  listNumbers(numbers) {
    const list = this.at("numbers");
    list.querySelectorAll(".told").forEach((row) => row.remove());
    for (const [name, value] of Object.entries(numbers).reverse()) {
      const row = Object.assign(document.createElement("div"), { className: "told" });
      if (/[ξη]/.test(name)) row.title = this.at(name.includes("ξ") ? "help-xi" : "help-eta").textContent ?? "";
      const parts = Object.entries({ dt: name, dd: value });
      row.append(...parts.map(([tag, textContent]) => Object.assign(document.createElement(tag), { textContent })));
      list.prepend(row);
    }
  }

  drawMotion() {
    if (!this.found || !this.choice) return;
    const { motion } = this.found;
    const { point, level } = this.choice;
    const history = historyChart(motion, point, level);
    const phase = phaseChart(motion, point, level);
    const beside = /** @type {HTMLInputElement} */ (this.at("beside")).checked;
    if (beside && this.bonded) {
      const { x1, v1 } = shownColumns(this.bonded, undamagedPoint(point), level);
      const { turns } = shownColumns(motion, point, level);
      const look = /** @type {const} */ ({ colour: "soft", label: "undamaged", width: 2, alpha: 0.8 });
      history.series.unshift({ x: turns, y: x1, ...look });
      phase.series.unshift({ x: x1, y: v1, ...look });
      for (const chart of [history, phase]) {
        const curves = chart.series.filter(({ dots }) => !dots);
        chart.y = axisAround(curves.map(({ y }) => y), chart.y.label ?? "");
      }
      phase.x = axisAround(phase.series.map(({ x }) => x), phase.x.label ?? "");
    }
    const words = `at frequency ratio ${formatNumber(point.eta, 6)}`;
    this.pictures.show("history", history, `Time histories of both masses ${words}: ${motion.impactTime.length} impacts in ${this.periods} periods, permanent contact in ${history.spans?.length ?? 0} spans`);
    this.pictures.show("phase", phase, `Phase curves of both masses ${words}`);
  }

  drawSection() {
    const { point, level } = /** @type {Choice} */ (this.choice);
    const count = this.section.length / 4;
    this.pictures.show("section", sectionChart(this.section, point, level), `Stroboscopic section at frequency ratio ${formatNumber(point.eta, 6)}: ${count} samples of gap and gap velocity`);
    this.at("section-count").textContent = `${count} periods`;
  }

  /** Let the section grow. */
  extendSection() {
    if (!this.choice || !this.found) return;
    const { point } = this.choice;
    const end = Array.from(this.section.subarray(this.section.length - 4));
    this.request("section", { point, start: end, periods: LONG }, (parts) => {
      const joined = new Float64Array(this.section.length + parts.reduce((sum, part) => sum + part.length, 0));
      joined.set(this.section);
      let place = this.section.length;
      for (const part of parts) {
        joined.set(part, place);
        place += part.length;
      }
      this.section = joined;
      this.drawSection();
    });
  }

  /** @param {any} part */
  receiveSpectraOrExponent(part) {
    if (part.exponent !== undefined) {
      this.exponent = part.exponent;
      this.at("exponent").textContent = exponentWords(part.exponent, this.found ? repeatPeriods(this.found.response) : 0);
      if (this.found) this.showNumbers();
      return;
    }
    this.spectra = part;
    this.drawSpectrum();
  }

  drawSpectrum() {
    if (!this.spectra || !this.choice) return;
    const chart = spectrumChart(this.spectra, this.choice.point, this.choice.level, this.record);
    const words = chart.series.map(({ label }) => label).join(", ");
    this.pictures.show("spectrum", chart, `Amplitude spectrum of the acceleration of half 1: ${words}`);
  }

  /** Play the impacts of many periods as they come from the kernel. @param {number} pitch periods a second */
  playImpacts(pitch) {
    this.pitch = pitch;
    this.sound.wanted = true;
    if (!this.choice || !this.found) return;
    const periods = Math.max(1, Math.round(pitch * (pitch < 8 ? 4 : 2)));
    const { rate } = this.sound;
    const asked = { point: this.choice.point, start: this.found.response.end, periods, pitch, rate };
    this.request("sound", asked, ([wave]) => {
      this.sound.play(wave);
      this.told();
    });
  }
}

/** The same without its delamination. @param {Point} point @returns {Point} */
const undamagedPoint = (point) => ({ ...point, structure: { ...point.structure, bonded: 1 } });
