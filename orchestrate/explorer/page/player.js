/** Seeing and hearing the motion: play, hold, next impact, sound, how fast and how long. */

import { isInHertz } from "./excitation.js";
import { watchNumber, resetToDefault } from "./field.js";
import { formatNumber } from "./scale.js";

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
    at("play").addEventListener("click", () => this.toggleAnimation());
    at("impact").addEventListener("click", () => this.nextImpact());
    at("listen").addEventListener("click", () => this.toggleSound());
    at("beside").addEventListener("change", () => inspector.drawMotion());
    at("speed").addEventListener("input", () => this.setSpeed());
    watchNumber(this.input("periods"), (periods) => {
      inspector.periods = Math.round(periods);
      if (inspector.choice) inspector.showMotion(inspector.choice);
    });
    watchNumber(this.input("pitch"), (pitch) => {
      if (inspector.sound.wanted) inspector.playImpacts(pitch);
    });
  }

  /** All fields as when the page was opened; a motion that is chosen next is shown so. */
  reset() {
    for (const id of ["speed", "pitch", "periods", "beside"]) resetToDefault(this.input(id));
    this.inspector.periods = this.input("periods").valueAsNumber;
    this.inspector.sound.silence();
    this.setSpeed();
    this.startAnimation();
  }

  /** Move, where that is welcome. */
  startAnimation() {
    this.inspector.animation.setRunning(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** What the buttons do now. */
  updateButtons() {
    this.showSpeed();
    const { sound, animation } = this.inspector;
    this.at("listen-word").textContent = sound.wanted ? "Stop sound" : "Sound";
    this.at("play").textContent = animation.running ? "Pause" : "Play";
  }

  toggleAnimation() {
    const { animation } = this.inspector;
    animation.setRunning(!animation.running);
    this.changed();
  }

  nextImpact() {
    const turn = this.inspector.animation.moveToNextImpact();
    this.tell(turn === null ? "no impact in this motion" : `impact after ${turn.toFixed(4)} periods`);
    this.changed();
  }

  toggleSound() {
    const { sound } = this.inspector;
    if (sound.wanted) sound.silence();
    else this.inspector.playImpacts(this.input("pitch").valueAsNumber);
    this.changed();
  }

  setSpeed() {
    this.inspector.animation.speed = 2 ** this.input("speed").valueAsNumber;
    this.showSpeed();
  }

  /** How fast the motion is seen: against the true one, where there are seconds. */
  showSpeed() {
    const { animation, choice } = this.inspector;
    let words = `${formatNumber(animation.speed, 2)} periods a second`;
    if (choice && isInHertz(choice.level)) {
      const times = choice.point.frequency / (2 * Math.PI) / animation.speed;
      words = times >= 1 ? `${formatNumber(times, 2)} times slowed` : `${formatNumber(1 / times, 2)} times faster`;
    }
    this.at("speed-words").textContent = words;
  }
}
