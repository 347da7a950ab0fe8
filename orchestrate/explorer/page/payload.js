/** What the page carries: the compiled kernel, tables, and where the responses of a sweep begin. */

/** @param {string} id */
function elementText(id) {
  return document.getElementById(id)?.textContent ?? "";
}

/** Bytes of an element of the page. @param {string} id @returns {Promise<ArrayBuffer>} */
async function unpackedBytes(id) {
  const letters = atob(elementText(id).trim());
  const packed = new Uint8Array(letters.length);
  for (let i = 0; i < packed.length; i++) packed[i] = letters.charCodeAt(i);
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(unpacked).arrayBuffer();
}

/** Everything the page carries. */
export async function loadPayload() {
  /** @type {Table} */
  const table = JSON.parse(elementText("table"));
  const [code, data] = await Promise.all(["kernel", "data"].map(unpackedBytes));
  const compiled = { module: await WebAssembly.compile(code), variables: table.variables, loops: table.loops };
  return { table, compiled, worker: elementText("worker"), diagram: shippedDiagram(table, new Float64Array(data)) };
}

/**
 * The sweep that the page was made of; null where it was made of none.
 * @param {Table} table
 * @param {Float64Array} data eta, frequency, amplitude, then four numbers a start for each direction
 * @returns {Diagram | null}
 */
function shippedDiagram({ structure, settings, directions, count, low, high, level: [unit, value] }, data) {
  if (!count) return null;
  const [etas, frequencies, amplitudes] = [0, 1, 2].map((part) => data.subarray(part * count, (part + 1) * count));
  const points = Array.from(etas, (eta, i) => ({ structure, eta, frequency: frequencies[i], amplitude: amplitudes[i] }));
  const lanes = directions.map((direction, i) => {
    const starts = data.subarray((3 + 4 * i) * count, (7 + 4 * i) * count);
    return { direction, found: new Array(count), starts, from: null };
  });
  const direction = directions.length === 2 ? /** @type {const} */ ("both") : directions[0];
  return { structure, direction, level: { unit, value }, low, high, points, lanes, settings };
}
