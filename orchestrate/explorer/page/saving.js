/** What is shown, as files to take home. */

import { beamWords } from "./caption.js";
import { saveCsv } from "./files.js";
import { diagramCsv, driveCsv, impactsCsv, motionCsv, sectionCsv, spectrumCsv } from "./tables.js";

const NOTHING = "nothing to save yet";

/** @type {Record<string, string>} */
const TITLES = {
  diagram: "Orbit diagram: the gap once a shaking period; below, impacts a period",
  frame: "The halves in their box, at one moment",
  history: "Displacements of both halves in time",
  phase: "Phase curves of both halves",
  section: "Stroboscopic section: gap and gap velocity once a shaking period",
  spectrum: "Spectrum of the acceleration of half 1",
  basin: "Where starts lead to: each colour a motion",
  drive: "A weak motor shakes the box: its speed over its voltage",
};

/** Save a picture or its numbers; says so. @param {string} words what, and the kind of file @param {App} page */
export function saveShown(words, { eta, regions, inspector, basin, drive }) {
  const [name, kind] = words.split(".");
  const { found, choice, section, spectra, pictures, animation } = inspector;
  const file = `${name}_eta${Number.isFinite(eta) ? Number(eta.toPrecision(7)) : ""}`;
  if (!found && (name === "frame" || name in pictures.pictures)) return NOTHING; // what is seen is the motion before
  if (kind !== "csv") {
    /** @type {Record<string, Picture>} */
    const shown = { ...pictures.pictures, diagram: regions.view.picture, basin: basin.view.picture, drive: drive.picture, frame: animation.picture };
    const caption = [TITLES[name]];
    if (name === "drive") caption.push("A lighter beam, the parameter set quick");
    else if (choice) caption.push(beamWords(choice.point, choice.level));
    const swept = name === "diagram" && regions.diagram === regions.shipped ? ["swept"] : []; // the sweep that it came with
    caption.push(["source", ...swept].flatMap((id) => document.getElementById(id)?.textContent ?? []).join("; "));
    if (kind === "png") shown[name].savePng(file, caption);
    else shown[name].saveSvg(file, caption);
    return `${file}.${kind} saved`;
  }
  /** @type {Record<string, () => Sheet | null>} */
  const tables = {
    diagram: () => diagramCsv(regions.diagram),
    section: () => (section.length ? sectionCsv(section) : null),
    spectrum: () => spectra && spectrumCsv(spectra),
    history: () => found && choice && motionCsv(found.motion, choice.point),
    drive: () => driveCsv(drive.rows),
    impacts: () => found && impactsCsv(found.motion),
  };
  const table = tables[name]();
  if (!table) return NOTHING;
  void saveCsv(file, table);
  return `${file}.csv saved`;
}
