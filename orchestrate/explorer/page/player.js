/** Seeing and hearing the motion: play, hold, next impact, sound, how fast and how long. */

import { inHertz } from "./excitation.js";
import { onNumber, toDefault } from "./field.js";
import { shown } from "./scale.js";

const FIELDS = ["speed", "pitch", "periods", "beside"];

export class Player {
  /**
   * @param {(id: string) => HTMLElement} at
   * @param {Inspector} inspector
   * @param {{tell: (text: string) => void, changed: () => void}} acts
   */
  constructor(at, inspector, { tell, changed }) {
    /** @param {string} id */
    this.input = (id) => /** @type {HTMLInputElement} */ (at(id));
    this.at = at;
    this.inspector = inspector;
    this.tell = tell;
    this.changed = changed;
    at("play").addEventListener("click", () => this.play());
    at("impact").addEventListener("click", () => this.nextImpact());
    at("listen").addEventListener("click", () => this.listen());
    at("beside").addEventListener("change", () => inspector.drawMotion());
    at("speed").addEventListener("input", () => this.setSpeed());
    onNumber(this.input("periods"), (periods) => this.setPeriods(periods));
    onNumber(this.input("pitch"), (pitch) => {
      if (inspector.sound.wanted) inspector.listen(pitch);
    });
  }

  /** All fields as when the page was opened; a motion that is chosen next is shown so. */
  reset() {
    for (const id of FIELDS) toDefault(this.input(id));
    this.inspector.periods = this.input("periods").valueAsNumber;
    this.inspector.sound.silence();
    this.setSpeed();
    this.animate();
  }

  /** Move, where that is welcome. */
  animate() {
    this.inspector.animation.run(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** What the buttons do now. */
  refresh() {
    this.showSpeed();
    const { sound, animation } = this.inspector;
    this.at("listen-word").textContent = sound.wanted ? "Stop sound" : "Sound";
    this.at("play").textContent = animation.running ? "Pause" : "Play";
  }

  play() {
    const { animation } = this.inspector;
    animation.run(!animation.running);
    this.changed();
  }

  nextImpact() {
    const turn = this.inspector.animation.nextImpact();
    this.tell(turn === null ? "no impact in this motion" : `impact after ${turn.toFixed(4)} periods`);
    this.changed();
  }

  listen() {
    const { sound } = this.inspector;
    if (sound.wanted) sound.silence();
    else this.inspector.listen(this.input("pitch").valueAsNumber);
    this.changed();
  }

  setSpeed() {
    this.inspector.animation.speed = 2 ** this.input("speed").valueAsNumber;
    this.showSpeed();
  }

  /** How fast the motion is seen: against the true one, where there are seconds. */
  showSpeed() {
    const { animation, choice } = this.inspector;
    const turns = `${shown(animation.speed, 2)} periods a second`;
    this.at("speed-words").textContent =
      choice && inHertz(choice.level) ? slowed(choice.point.frequency / (2 * Math.PI) / animation.speed) : turns;
  }

  /** @param {number} periods */
  setPeriods(periods) {
    this.inspector.periods = Math.round(periods);
    if (this.inspector.choice) this.inspector.choose(this.inspector.choice);
  }
}

/** @param {number} times */
const slowed = (times) => (times >= 1 ? `${shown(times, 2)} times slowed` : `${shown(1 / times, 2)} times faster`);
