/** What is shown, as files to take home. */

import { saveCsv } from "./files.js";
import { diagramCsv, driveCsv, impactsCsv, motionCsv, sectionCsv, spectrumCsv } from "./tables.js";

/**
 * Save a picture or its numbers; says so.
 * @param {string} words what, and the kind of file
 * @param {import("./app.js").App} page
 */
export function saveShown(words, { eta, regions, inspector, basin, drive }) {
  const [name, kind] = words.split(".");
  const { found, choice, section, spectra, pictures, animation } = inspector;
  const file = `${name}_eta${Number.isFinite(eta) ? eta : ""}`;
  if (kind !== "csv") {
    /** @type {Record<string, import("./picture.js").Picture>} */
    const shown = { ...pictures.pictures, diagram: regions.view.picture, basin: basin.view.picture, drive: drive.picture, animation: animation.picture };
    if (kind === "png") shown[name].savePng(file);
    else shown[name].saveSvg(file);
    return `${file}.${kind} saved`;
  }
  /** @type {Record<string, () => import("./files.js").Table | null>} */
  const tables = {
    diagram: () => diagramCsv(regions.diagram),
    section: () => (section.length ? sectionCsv(section) : null),
    spectrum: () => spectra && spectrumCsv(spectra),
    history: () => found && choice && motionCsv(found.motion, choice.point),
    drive: () => driveCsv(drive.rows),
    impacts: () => found && impactsCsv(found.motion),
  };
  const table = tables[name]();
  if (!table) return "nothing to save yet";
  void saveCsv(file, table);
  return `${file}.csv saved`;
}
