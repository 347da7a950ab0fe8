/** Structure and motor coupled as by the project's master, in fixed steps. */

/**
 * @typedef {[number, number, number, number]} Cubic value and three derivatives at the beginning
 * @typedef {Record<string, number>} Outputs
 * @typedef {{structure: Record<string, number>, drive: Record<string, number>, h: number}} Start
 * @typedef {{oscillator: Float64Array, shaker: Float64Array, told: Cubic | null,
 *   numbers: Record<string, number>, motion: Outputs, shaking: Outputs, h: number}} Run
 */

const MOTION = ["x1", "box_force", "box_impulse", "box_impulse_moment"];
const SHAKING = ["box_position", "box_velocity", "box_acceleration", "angle", "speed"];
const TOLD = ["box_acceleration", "box_jerk", "box_snap", "box_crackle"];
const FORCE = ["box_force", "box_force_1", "box_force_2", "box_force_3"];
const FIRST = 3; // passes of the first step
const TURN = 2 * Math.PI;

/** The cubic with given ends, mean and first moment. @param {number} first @param {number} last @param {number} mean @param {number} moment @param {number} h @returns {Cubic} */
export function matchedCubic(first, last, mean, moment, h) {
  const [a1, a2, a3] = [last - first, mean - first, moment - 0.5 * first];
  const b = 3 * a1 + 36 * a2 - 60 * a3;
  const c = -12 * a1 - 96 * a2 + 180 * a3;
  const d = 10 * a1 + 60 * a2 - 120 * a3;
  return [first, b / h, (2 * c) / (h * h), (6 * d) / (h * h * h)];
}

/** First derivative of a cubic at a step's end. @param {Cubic} cubic @param {number} h */
function endSlope([, f1, f2, f3], h) {
  return f1 + h * (f2 + 0.5 * h * f3);
}

/** @param {Instance} instance @param {string[]} names @returns {Outputs} */
function read(instance, names) {
  return Object.fromEntries(names.map((name) => [name, instance.get(name)]));
}

/**
 * The structure goes first with an extrapolated acceleration of the box, the shaker with the force
 * that came of it; then the structure goes back and once more with the acceleration found. What is
 * exchanged is a cubic with the ends, the mean and the first moment that both sides know exactly.
 */
export class Coupled {
  /** @param {Instance} oscillator @param {Instance} shaker @param {number} h communication step, s */
  constructor(oscillator, shaker, h) {
    this.oscillator = oscillator;
    this.shaker = shaker;
    this.h = h;
    this.numbers = {
      ...{ time: 0, voltage: NaN },
      ...{ turn: 0, turnTime: 0, impacts: 0, high: -Infinity, low: Infinity },
    };
    /** @type {Cubic | null} the acceleration over the last step */
    this.told = null;
    /** @type {Outputs} */
    this.motion = {};
    /** @type {Outputs} */
    this.shaking = {};
  }

  /** @param {Instance} oscillator @param {Instance} shaker @param {Start} start */
  static begun(oscillator, shaker, { structure, drive, h }) {
    const one = new Coupled(oscillator, shaker, h);
    oscillator.initialize({ ...structure, box_amplitude: 0, box_frequency: 0, x_rel_max_on: 0 });
    shaker.initialize(drive);
    one.motion = read(oscillator, MOTION);
    one.shaking = read(shaker, SHAKING);
    return one;
  }

  /** @param {Instance} oscillator @param {Instance} shaker @param {Run} run */
  static resumed(oscillator, shaker, run) {
    const one = new Coupled(oscillator, shaker, run.h);
    oscillator.memory.set(run.oscillator);
    shaker.memory.set(run.shaker);
    const { told, numbers, motion, shaking } = run;
    return Object.assign(one, { told, numbers: { ...numbers }, motion, shaking });
  }

  /** All that a run goes on from. @returns {Run} */
  memory() {
    const { told, numbers, motion, shaking, h } = this;
    const [oscillator, shaker] = [this.oscillator.memory.slice(), this.shaker.memory.slice()];
    return { oscillator, shaker, told, numbers, motion, shaking, h };
  }

  /** @param {Cubic} cubic */
  put([f0, f1, f2, f3]) {
    const values = { voltage: this.numbers.voltage };
    this.shaker.set({ ...values, [FORCE[0]]: f0, [FORCE[1]]: f1, [FORCE[2]]: f2, [FORCE[3]]: f3 });
  }

  /** The shaker's outputs under a force. @param {number} force */
  look(force) {
    this.put([force, 0, 0, 0]);
    this.shaker.call("kernel_refresh", this.shaker.get("TIME"));
    return read(this.shaker, SHAKING);
  }

  /** One communication step. @param {number} voltage */
  step(voltage) {
    const { numbers, oscillator, shaker, h } = this;
    if (voltage !== numbers.voltage) {
      numbers.voltage = voltage;
      this.shaking = this.look(this.motion.box_force);
    }
    const [kept, other] = [oscillator.memory.slice(), shaker.memory.slice()];
    let told = this.extrapolated();
    for (let i = 0; i < (this.told ? 1 : FIRST); i++) {
      if (i) {
        oscillator.memory.set(kept);
        shaker.memory.set(other);
      }
      const motion = this.oscillate(told);
      this.put(this.forceOf(motion));
      shaker.stepBy(numbers.time, h);
      told = this.found(this.look(motion.box_force));
    }
    oscillator.memory.set(kept);
    this.motion = this.oscillate(told);
    this.shaking = this.look(this.motion.box_force);
    this.told = told;
    numbers.time += h;
  }

  /** The structure's motion after a step. @param {Cubic} told */
  oscillate(told) {
    TOLD.forEach((name, i) => this.oscillator.set({ [name]: told[i] }));
    this.oscillator.stepBy(this.numbers.time, this.h);
    return read(this.oscillator, MOTION);
  }

  /** The force over a step to `motion`. @param {Outputs} motion */
  forceOf(motion) {
    const { h } = this;
    const [mean, moment] = [motion.box_impulse / h, motion.box_impulse_moment / (h * h)];
    return matchedCubic(this.motion.box_force, motion.box_force, mean, moment, h);
  }

  /** The acceleration over a step that the shaker has done. @param {Outputs} after */
  found(after) {
    const { h, shaking: now } = this;
    const mean = (after.box_velocity - now.box_velocity) / h;
    const moment = mean - ((after.box_position - now.box_position) / h - now.box_velocity) / h;
    return matchedCubic(now.box_acceleration, after.box_acceleration, mean, moment, h);
  }

  /** The last step's cubic goes on from the present value. @returns {Cubic} */
  extrapolated() {
    const value = this.shaking.box_acceleration;
    if (!this.told) return [value, 0, 0, 0];
    const [, , f2, f3] = this.told;
    return [value, endSlope(this.told, this.h), f2 + this.h * f3, f3];
  }

  /** When a revolution is complete: its end, the voltage, mean speed, half range of x1 at the communication points, impacts. */
  revolution() {
    const { numbers, shaking, motion } = this;
    numbers.high = Math.max(numbers.high, motion.x1);
    numbers.low = Math.min(numbers.low, motion.x1);
    const angle = shaking.angle / TURN;
    let turn = Math.floor(angle);
    if (turn <= numbers.turn) {
      turn = Math.ceil(angle);
      if (turn >= numbers.turn) return null;
    }
    const time = numbers.time - (shaking.angle - turn * TURN) / shaking.speed;
    const impacts = this.oscillator.get("impact_count");
    const row = {
      ...{ time, voltage: numbers.voltage, speed: ((turn - numbers.turn) * TURN) / (time - numbers.turnTime) },
      ...{ amplitude: 0.5 * (numbers.high - numbers.low), impacts: impacts - numbers.impacts },
    };
    Object.assign(numbers, { turn, turnTime: time, impacts, high: motion.x1, low: motion.x1 });
    return row;
  }
}
