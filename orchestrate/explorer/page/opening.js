/** When the halves of a pressed beam open: from which level on, and at which frequencies of a diagram. */

import { GRAVITY, isInHertz } from "./excitation.js";
import { traitsOf } from "./model.js";
import { formatNumber } from "./scale.js";
import { isRatioShown, ratioUnit, levelInShownUnit, shownUnit } from "./units.js";

const MOST = 3; // ranges that are named

/** From which level on a beam that stays closed opens; nothing of one whose halves are not pressed. @param {Point} point @param {Level} level */
export function openingLevelWords(point, level) {
  const { gap_offset, threshold: amplitude } = traitsOf(point);
  const { wall, stroke, box_acceleration, force1, force2 } = point.structure;
  // the level is that of the box's shaking alone
  if (!isInHertz(level) || gap_offset >= 0 || wall || stroke || box_acceleration || force1 || force2) return "";
  const value = level.unit === "g" ? (amplitude * point.frequency * point.frequency) / GRAVITY : 1e3 * amplitude;
  const threshold = { unit: level.unit, value };
  return Number.isFinite(value) ? ` At this frequency they open from ${levelInShownUnit(threshold).text} on.` : "";
}

/** Where a complete diagram's beam opens, or that it does so unseen. @param {Diagram} diagram */
export function openingWords(diagram) {
  const ranges = traitsOf(diagram.points[0]).gap_offset < 0 ? `. The halves open ${openingRanges(diagram)}` : "";
  // whether a response knocks though all of its samples are shut
  const unseen = diagram.lanes.some(({ found }) => found.some((one) => one && one.impacts > 0 && one.gaps.every((gap) => gap <= 0)));
  return ranges + (unseen ? ". A dot at 0 where there are impacts: they open at other moments of the period" : "");
}

/** At which frequencies of a diagram the halves open, in words. @param {Diagram} diagram */
function openingRanges({ points, lanes, structure, level }) {
  const open = points.map((_, i) => lanes.some(({ found }) => (found[i]?.impacts ?? 0) > 0));
  if (open.every(Boolean)) return "at every frequency of the diagram";
  if (!open.some(Boolean)) return "at no frequency of the diagram";
  const unit = ratioUnit(structure, level);
  /** @param {number} i */
  const place = (i) => formatNumber(points[i].eta * unit, 4);
  const starts = open.flatMap((now, i) => (now && !open[i - 1] ? [i] : []));
  const ends = open.flatMap((now, i) => (now && !open[i + 1] ? [i] : []));
  if (starts.length > MOST) return `in ${starts.length} ranges of frequencies`;
  const asRatio = !isInHertz(level) || isRatioShown();
  const ranges = starts.map((start, i) => `from ${place(start)} to ${place(ends[i])}`).join(" and ");
  return asRatio ? `only ${ranges.replaceAll("from ", "from η = ")}` : `only ${ranges} ${shownUnit("frequency").name}`;
}
