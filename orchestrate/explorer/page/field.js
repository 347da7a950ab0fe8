/** A field for a number: what is expected stands next to it, and anything else changes nothing. */

/**
 * Watch a field.
 * @param {HTMLInputElement} input with its ends in `min` and `max`
 * @param {(value: number) => string | void} take what to do with a number that is inside; it may
 *   say what it expects
 * @param {"change" | "input"} [event] a typed number counts when it is complete: 1.7 begins with 1
 */
export function watchNumber(input, take, event = "change") {
  input.addEventListener(event, () => {
    const { valueAsNumber: value } = input;
    const good = Number.isFinite(value) && value >= Number(input.min) && value <= Number(input.max);
    showComplaint(input, (good ? take(value) : `expected ${input.min} to ${input.max}`) ?? "");
  });
}

/** Show a number in a field, unless one is being typed there. @param {HTMLInputElement} input @param {number} value @param {number} [digits] */
export function showNumber(input, value, digits = 12) {
  if (document.activeElement === input && input.type === "number") return;
  input.value = String(Number(value.toPrecision(digits)));
  showComplaint(input, "");
}

/** As the page has it when it is opened. @param {HTMLInputElement} input */
export function resetToDefault(input) {
  input.value = input.defaultValue;
  input.checked = input.defaultChecked;
  showComplaint(input, "");
}

/** Say next to a field what is expected; nothing where all is well. @param {HTMLInputElement} input @param {string} words */
function showComplaint(input, words) {
  if (input.validationMessage === words) return;
  input.setCustomValidity(words);
  input.setAttribute("aria-invalid", String(Boolean(words)));
  const id = `${input.id}-wrong`;
  const note = document.getElementById(id) ?? document.createElement("span");
  Object.assign(note, { id, className: "wrong", textContent: words, hidden: !words });
  note.setAttribute("role", "alert");
  input.setAttribute("aria-describedby", id);
  if (!note.isConnected) input.after(note);
}
