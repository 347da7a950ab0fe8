/** Mouse, finger and keyboard on the orbit diagram: choose a frequency, drag a region. */

/**
 * @typedef {{choose: (eta: number) => void, zoom: (low: number, high: number) => void,
 *   move: (steps: number) => void, back: () => void, forth: () => void, whole: () => void}} Acts
 */

const CLICK = 5; // px: what moves less is a click

/** @param {DiagramView} view @param {Acts} acts */
export function listenToDiagram(view, acts) {
  const { canvas } = view.picture;
  /** @type {number | null} */
  let from = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    from = event.offsetX;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (from === null) return;
    const wide = Math.abs(event.offsetX - from) > CLICK;
    view.marks.drag = wide ? [view.etaAt(from), view.etaAt(event.offsetX)] : null;
    view.picture.redraw();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (from === null) return;
    const ends = [view.etaAt(from), view.etaAt(event.offsetX)].sort((a, b) => a - b);
    const click = Math.abs(event.offsetX - from) <= CLICK;
    from = null;
    view.marks.drag = null;
    view.picture.redraw();
    if (click) acts.choose(ends[0]);
    else acts.zoom(ends[0], ends[1]);
  });
  canvas.addEventListener("pointercancel", () => {
    from = null;
    view.marks.drag = null;
  });
  canvas.addEventListener("keydown", (event) => actOnKey(event, view, acts));
}

/** @param {KeyboardEvent} event @param {DiagramView} view @param {Acts} acts */
function actOnKey(event, view, acts) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const { low, high } = view.axes.x;
  const middle = view.marks.eta ?? (low + high) / 2;
  /** @param {number} factor */
  const zoom = (factor) => {
    const half = ((high - low) * factor) / 2;
    acts.zoom(middle - half, middle + half);
  };
  /** @type {Record<string, () => void>} */
  const keys = {
    ArrowLeft: () => acts.move(event.shiftKey ? -20 : -1),
    ArrowRight: () => acts.move(event.shiftKey ? 20 : 1),
    Enter: () => acts.choose(middle),
    "+": () => zoom(0.3),
    "=": () => zoom(0.3),
    "-": () => zoom(3),
    Backspace: acts.back,
    b: acts.back,
    f: acts.forth,
    Home: acts.whole,
  };
  const act = keys[event.key];
  if (!act) return;
  event.preventDefault();
  act();
}
