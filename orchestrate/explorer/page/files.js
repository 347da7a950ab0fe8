/** Files that the user takes home: CSV, PNG, SVG. */

/** @param {string} name @param {Blob} blob */
export function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/**
 * A table as CSV; numbers in the shortest form that reads back the same.
 * @param {string[]} head
 * @param {Iterable<(number | string)[]>} rows
 */
export function csv(head, rows) {
  const lines = [head.join(",")];
  for (const row of rows) lines.push(row.join(","));
  return `${lines.join("\n")}\n`;
}

/** @param {string} name @param {string} text */
export function saveCsv(name, text) {
  save(`${name}.csv`, new Blob([text], { type: "text/csv" }));
}
