/** The weak drive: a motor with an unbalance shakes the box; its speed may hang at the resonance. */

import { drawChart } from "./chart.js";
import { resetToDefault } from "./field.js";
import { impactCountWords } from "./response_words.js";
import { Picture } from "./picture.js";
import { formatNumber } from "./scale.js";

const KEPT = 6000; // revolutions of the trace
const PACE = 60; // ms between two requests
const STEPS = 1200; // communication steps in each
const SWEEP = 2e-4; // V/s of a ramp, times the largest voltage

export class DrivePanel {
  /** @param {(id: string) => HTMLElement} at @param {WorkerPool} pool @param {Start} start */
  constructor(at, pool, start) {
    this.at = at;
    this.pool = pool;
    this.start = start;
    this.voltage = /** @type {HTMLInputElement} */ (at("voltage"));
    this.bonded = /** @type {HTMLInputElement} */ (at("drive-bonded"));
    this.picture = new Picture(/** @type {HTMLCanvasElement} */ (at("drive")), (pen, size, theme) => this.draw(pen, size, theme));
    this.idle = at("drive-status").textContent; // what is said before it runs
    this.running = false;
    this.ramp = 0; // sign of the voltage's change
    this.state = /** @type {Run | null} */ (null);
    this.rows = /** @type {Row[]} */ ([]);
    this.order = /** @type {Order | null} */ (null);
    at("drive-go").addEventListener("click", () => this.setRunning(!this.running));
    at("ramp-up").addEventListener("click", () => this.startRamp(1));
    at("ramp-down").addEventListener("click", () => this.startRamp(-1));
    this.bonded.addEventListener("change", () => this.forgetRun());
    this.voltage.addEventListener("input", () => (this.ramp = 0));
  }

  /** As when the page was opened. */
  reset() {
    this.setRunning(false);
    this.ramp = 0;
    for (const input of [this.voltage, this.bonded]) resetToDefault(input);
    this.forgetRun();
    this.at("drive-status").textContent = this.idle;
  }

  /** Forget the run. */
  forgetRun() {
    this.state = null;
    this.rows = [];
    this.order?.cancel();
    this.order = null;
    this.picture.redraw();
  }

  /** @param {boolean} running */
  setRunning(running) {
    this.running = running;
    this.at("drive-go").textContent = running ? "Stop motor" : "Start motor";
    if (running && !this.order) this.requestSteps();
  }

  /** Let the voltage rise or fall slowly. @param {number} sign */
  startRamp(sign) {
    this.ramp = sign;
    this.setRunning(true);
  }

  /** Ask for the next steps, at the slider's voltage or on a ramp from it. */
  requestSteps() {
    const [low, high] = [Number(this.voltage.min), Number(this.voltage.max)];
    const first = this.voltage.valueAsNumber;
    const { oscillator, drive, h } = this.start;
    const change = this.ramp * SWEEP * high * h;
    const voltages = Array.from({ length: STEPS }, (_, i) => Math.min(Math.max(first + change * i, low), high));
    if (this.ramp) {
      const reached = voltages[STEPS - 1];
      this.voltage.value = String(reached + change);
      if (reached === (this.ramp > 0 ? high : low)) this.setRunning(false);
    }
    const start = {
      ...this.start,
      oscillator: { ...oscillator, bonded: Number(this.bonded.checked) },
      drive: { ...drive, voltage: voltages[0], speed_start: voltages[0] / drive.motor_constant },
    };
    const order = this.pool.ask("drive", { run: this.state, start, voltages }, ([part]) => this.showSteps(part));
    this.order = order;
    void order.done.then(() => {
      if (this.order === order) this.order = null;
      if (this.running && !this.order) setTimeout(() => this.running && !this.order && this.requestSteps(), PACE);
    });
  }

  /** @param {{rows: Row[], run: Run}} part */
  showSteps({ rows, run }) {
    this.state = run;
    this.rows = [...this.rows, ...rows].slice(-KEPT);
    const last = this.rows[this.rows.length - 1];
    if (last) {
      const unit = this.start.drive.motor_constant * this.start.omega;
      const words = `Voltage for a speed of ${formatNumber(last.voltage / unit, 3)}: speed ${formatNumber(last.speed / this.start.omega, 3)} of the beam's ω, ${impactCountWords(last.impacts, "a revolution")}`;
      this.at("drive-status").textContent = words;
      this.picture.describe(`Speed of the motor over its voltage. ${words}`);
    }
    this.picture.redraw();
  }

  /** @param {Pen} pen @param {Size} size @param {Theme} theme */
  draw(pen, size, theme) {
    const [low, high] = [Number(this.voltage.min), Number(this.voltage.max)];
    const unit = this.start.drive.motor_constant * this.start.omega;
    const x = this.rows.map((row) => row.voltage / unit);
    const y = this.rows.map((row) => row.speed / this.start.omega);
    const ends = [low / unit, high / unit];
    drawChart(pen, size, theme, {
      x: { low: ends[0], high: ends[1], label: "voltage, as the speed without load over ω" },
      y: { low: ends[0], high: ends[1], label: "speed over ω" },
      series: [
        { x: ends, y: ends, colour: "soft", label: "no load", alpha: 0.5 },
        { x, y, colour: "one", label: "speed" },
        { x: x.slice(-1), y: y.slice(-1), colour: "mark", dots: 4 },
      ],
    });
  }
}
