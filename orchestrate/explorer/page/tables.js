/** What is shown as tables: the diagram, of the motion, of a spectrum. */

import { accelerationsOf } from "./model.js";
import { DECIDED } from "./response.js";

/** Samples of all responses that have come. @param {Diagram} diagram */
export function diagramCsv({ points, lanes, settings }) {
  function* rows() {
    for (const { direction, found } of lanes) {
      for (const one of found) {
        if (one) yield [direction, points[one.index].eta, one.impacts, one.multiplicity, DECIDED[one.decided], one.peak, ...one.gaps];
      }
    }
  }
  const names = Array.from({ length: settings.samples }, (_, i) => `xi_rel_${i + 1}`);
  return { head: ["direction", "eta", "impacts_per_period", "multiplicity", "multiplicity_decided", "xi_rel_max", ...names], rows: rows() };
}

/** The motion in time. @param {Motion} motion @param {Point} point */
export function motionCsv(motion, point) {
  const { time, states, contact } = motion;
  const { wall, stroke, force1, force2 } = point.structure;
  // without accelerations where more than springs and contact of two halves makes them
  const felt = wall || stroke || force1 || force2 ? null : accelerationsOf(motion, point);
  const rows = Array.from(time, (t, i) => [t, ...states.subarray(4 * i, 4 * i + 4), ...(felt?.subarray(2 * i, 2 * i + 2) ?? []), contact[i]]);
  return { head: ["time", "x1", "x2", "v1", "v2", ...(felt ? ["a1_abs", "a2_abs"] : []), "in_contact"], rows };
}

/** Its impacts. @param {Motion} motion */
export function impactsCsv(motion) {
  const { impactTime, impactSpeed, impactEnergy } = motion;
  const rows = Array.from(impactTime, (t, i) => [t, impactSpeed[i], impactEnergy[i]]);
  return { head: ["impact_time", "impact_velocity", "energy"], rows };
}

/** Stroboscopic samples. @param {ArrayLike<number>} states */
export function sectionCsv(states) {
  const rows = Array.from({ length: states.length / 4 }, (_, i) => [0, 1, 2, 3].map((part) => states[4 * i + part]));
  return { head: ["x1", "x2", "v1", "v2"], rows };
}

/** @param {{delaminated: Spectrum, bonded: Spectrum | null}} found */
export function spectrumCsv({ delaminated, bonded }) {
  const rows = Array.from(delaminated.order, (order, i) => [order, delaminated.amplitude[i], ...(bonded ? [bonded.amplitude[i]] : [])]);
  return { head: ["order", "delaminated", ...(bonded ? ["bonded"] : [])], rows };
}

/** Revolutions of the motor. @param {Row[]} revolutions */
export function driveCsv(revolutions) {
  const rows = revolutions.map((row) => [row.time, row.voltage, row.speed, row.impacts]);
  return { head: ["time", "voltage", "speed", "impacts"], rows };
}
