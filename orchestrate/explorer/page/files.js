/** Files that the user takes home: CSV, PNG, SVG. */

/** @param {string} name @param {Blob} blob */
export function saveFile(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/**
 * A table as CSV, numbers in the shortest form that reads back the same; the page stays alive.
 * @param {string} name
 * @param {Sheet} table
 */
export async function saveCsv(name, { head, rows }) {
  const lines = [`${head.join(",")}\n`];
  let end = performance.now() + 12;
  for (const row of rows) {
    lines.push(`${row.join(",")}\n`);
    if (performance.now() < end) continue;
    await new Promise((resolve) => setTimeout(resolve));
    end = performance.now() + 12;
  }
  saveFile(`${name}.csv`, new Blob(lines, { type: "text/csv" }));
}
