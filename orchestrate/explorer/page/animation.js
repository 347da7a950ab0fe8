/** The box, both masses and their springs in motion; impacts flash. */

import { Picture } from "./picture.js";
import { traitsOf } from "./model.js";
import { secondName } from "./motion_view.js";

const FLASH = 0.04; // of a period

export class Animation {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.motion = /** @type {Motion | null} */ (null);
    this.point = /** @type {Point | null} */ (null);
    this.turn = 0; // periods since the motion's beginning
    this.offset = 0; // m: the gap of unloaded springs
    this.speed = 2 ** -1.5; // periods a second
    this.running = false;
    this.last = 0;
    this.picture = new Picture(canvas, (pen, size, theme) => this.draw(pen, size, theme));
  }

  /** @param {Motion} motion @param {Point} point */
  setMotion(motion, point) {
    Object.assign(this, { motion, turn: 0, offset: traitsOf(point).gap_offset, point });
    this.largest = motion.states.reduce((most, value, i) => (i % 4 < 2 ? Math.max(most, Math.abs(value)) : most), 0);
    this.picture.redraw();
  }

  /** Run, or hold. @param {boolean} running */
  setRunning(running) {
    const began = running && !this.running;
    this.running = running;
    this.last = performance.now();
    if (began) requestAnimationFrame((now) => this.moveTo(now));
  }

  /** @param {number} now */
  moveTo(now) {
    if (!this.running) return;
    if (this.motion) {
      const length = (this.motion.time.length - 1) / this.motion.points;
      this.turn = (this.turn + (Math.max(now - this.last, 0) / 1000) * this.speed) % length;
      this.picture.drawNow();
    }
    this.last = now;
    requestAnimationFrame((next) => this.moveTo(next));
  }

  /** Continue to the next impact; the turn it happens at, null where there is none. */
  moveToNextImpact() {
    if (!this.motion) return null;
    this.running = false;
    const { impactTime, period, first } = this.motion;
    const turns = Array.from(impactTime, (time) => time / period - first);
    const found = turns.find((turn) => turn > this.turn + 1e-9) ?? turns[0];
    if (found === undefined) return null;
    this.turn = found;
    this.picture.redraw();
    return found;
  }

  /** Displacements now, between the recorded states by a cubic. @param {Motion} motion */
  displacementsNow(motion) {
    const place = Math.min(this.turn * motion.points, motion.time.length - 1.000001);
    const i = Math.floor(place);
    const u = place - i;
    const h = motion.time[i + 1] - motion.time[i];
    return [0, 1].map((part) => {
      const [x, y] = [motion.states[4 * i + part], motion.states[4 * i + 4 + part]];
      const [v, w] = [motion.states[4 * i + 2 + part] * h, motion.states[4 * i + 6 + part] * h];
      return x + u * (v + u * (3 * (y - x) - 2 * v - w + u * (v + w - 2 * (y - x))));
    });
  }

  /** @param {Pen} pen @param {Size} size @param {Theme} theme */
  draw(pen, { width, height }, theme) {
    const { motion, point } = this;
    if (!motion || !point) return;
    const { wall, stroke } = point.structure;
    const half = Math.min(width * 0.42, 260);
    const shift = 18 * Math.sin(2 * Math.PI * this.turn);
    const middle = width / 2 + shift;
    const [top, tall] = [22, height - 50];
    pen.text(width / 2, 10, "← the box is shaken →", { fill: theme.soft });
    pen.box(middle - half, top, 2 * half, tall, { stroke: theme.ink, width: 3 });
    const scale = (half * 0.33) / (this.largest || 1);
    const [first, second] = this.displacementsNow(motion);
    const [x1, x2] = [first, second + this.offset].map((x) => middle + scale * x);
    const [wide, high] = [half * 0.3, tall * 0.42];
    const level = top + tall / 2;
    spring(pen, middle - half, x1 - wide, level, theme.soft);
    if (!wall) spring(pen, x2 + wide, middle + half, level, theme.soft);
    pen.box(x1 - wide, level - high / 2, wide, high, { fill: theme.one });
    if (wall) pen.box(x2, top, middle + half - x2, tall, { fill: theme.two });
    else pen.box(x2, level - high / 2, wide, high, { fill: theme.two });
    if (stroke && !point.structure.bonded) {
      // the other end: a hook of half 2, or of the wall, that half 1 strikes with its back
      const [back, over] = [x2 - scale * stroke - wide, level - high / 2 - 6];
      pen.line([x2 + wide / 2, x2 + wide / 2, back - 3, back - 3], [level - high / 2, over, over, level], { stroke: theme.two, width: 5 });
    }
    const flash = this.flashBrightness(motion);
    if (flash > 0) pen.dots([(x1 + x2) / 2], [level], 6 + 16 * flash, { fill: theme.hit, alpha: flash });
    pen.text(x1 - wide / 2, level, "half 1", { fill: theme.paper });
    pen.text(x2 + wide / 2, level, secondName(point), { fill: theme.paper });
    pen.text(width / 2, height - 12, `period ${this.turn.toFixed(2)}`, { fill: theme.ink });
  }

  /** How bright the last impact still is, 0 to 1. @param {Motion} motion */
  flashBrightness({ impactTime, impactSpeed, period, first }) {
    let bright = 0;
    const fastest = impactSpeed.reduce((most, speed) => Math.max(most, speed), 0);
    for (let i = 0; i < impactTime.length; i++) {
      const age = this.turn - (impactTime[i] / period - first);
      if (age >= -1e-9 && age < FLASH) bright = Math.max(bright, (1 - age / FLASH) * (0.3 + (0.7 * impactSpeed[i]) / fastest));
    }
    return bright;
  }
}

/** @param {Pen} pen @param {number} from @param {number} to @param {number} y @param {string} colour */
function spring(pen, from, to, y, colour) {
  const xs = [from];
  const ys = [y];
  for (let i = 0; i <= 12; i++) {
    xs.push(from + ((to - from) * (i + 1)) / 14);
    ys.push(i === 0 || i === 12 ? y : y + (i % 2 ? -7 : 7));
  }
  pen.line([...xs, to], [...ys, y], { stroke: colour, width: 1.5 });
}
