/** The structure and the motor that shakes it, by the compiled loop of the project's master. */

import { Buffers } from "./kernel.js";

const WARNING = 1; // status of FMI
const MODELS = { oscillator: "oscillator", drive: "motor_shaker" };
const SIDES = /** @type {Side[]} */ (Object.keys(MODELS));

/** Both instances, with the loop that couples them; to be closed. */
export class Coupled {
  /** @param {Library} library @param {Start} start @param {Run | null} run where it resumes */
  constructor(library, start, run) {
    this.library = library;
    this.start = start;
    this.buffers = new Buffers(library);
    const { pair, columns, names } = start;
    this.kept = { oscillator: this.buffers.array("u32", 1), drive: this.buffers.array("u32", 1) };
    const scratch = this.buffers.array("f64", 2 * names.drive.inputs.length);
    this.pair = this.buffers.newStructure("Pair", { ...pair, scratch, ...this.sideFields("oscillator"), ...this.sideFields("drive") });
    for (const side of SIDES) {
      if (!library.calls[`${MODELS[side]}_open_fmu`](this.instanceAddress(side), 0)) throw new Error("out of memory");
      if (run) {
        this.callFmi(side, "fmi3DeserializeFMUState", this.buffers.array("u8", run[side]), run[side].length, this.kept[side]);
        this.callFmi(side, "fmi3SetFMUState", library.viewMemory("u32", this.kept[side], 1)[0]);
      } else this.initializeSide(side, start[side]);
    }
    this.row = this.buffers.array("f64", run?.row ?? columns.map(() => NaN));
    this.last = this.buffers.array("f64", run?.last ?? 3);
    if (run) return;
    // the first row: of the step nothing, and the motion; the loop looks at the drive
    const [place, { outputs }] = [columns.indexOf("x1"), names.oscillator];
    library.viewMemory("f64", this.row, place).fill(0);
    this.callFmi("oscillator", "fmi3GetFloat64", this.buffers.valueReferences(outputs), outputs.length, this.row + 8 * place, outputs.length);
  }

  close() {
    for (const side of SIDES) {
      this.callFmi(side, "fmi3FreeFMUState", this.kept[side]);
      this.library.calls[`${MODELS[side]}_close_fmu`](this.instanceAddress(side));
    }
    this.buffers.free();
  }

  /** Fields of a side. @param {Side} side */
  sideFields(side) {
    const model = MODELS[side];
    const { inputs, outputs } = this.start.names[side];
    const [save, restore, release] = this.library.viewMemory("u32", this.library.places[`${model}_state_functions`].value, 3);
    const fields = {
      ...{ save, restore, release, kept: this.kept[side], answer: this.buffers.newStructure("StepAnswer", {}) },
      ...{ inputs: this.buffers.valueReferences(inputs, model), outputs: this.buffers.valueReferences(outputs, model) },
      impacts: this.buffers.valueReferences(side === "oscillator" ? ["impact_count"] : [], model),
    };
    return Object.fromEntries(Object.entries(fields).map(([name, value]) => [`${side}.${name}`, value]));
  }

  /** Where a side's FMU is. @param {Side} side */
  instanceAddress(side) {
    return this.pair + this.library.loops.structures.Pair.fields[`${side}.fmi.instance`][1];
  }

  /** Call a function of FMI. @param {Side} side @param {string} name @param {number[]} numbers */
  callFmi(side, name, ...numbers) {
    const [instance] = this.library.viewMemory("u32", this.instanceAddress(side), 1);
    const status = this.library.calls[`${MODELS[side]}_${name}`](instance, ...numbers);
    if (status > WARNING) throw new Error(this.library.lastMessage(MODELS[side]) || name);
  }

  /** @param {Side} side @param {Record<string, number>} values */
  initializeSide(side, values) {
    const { buffers, library } = this;
    const [booleans, reals] = [true, false].map((is) => Object.keys(values).filter((name) => library.loops.booleans.includes(name) === is));
    for (const [type, kind, names] of /** @type {[string, Kind, string[]][]} */ ([["Float64", "f64", reals], ["Boolean", "u8", booleans]])) {
      const numbers = buffers.array(kind, names.map((name) => values[name]));
      this.callFmi(side, `fmi3Set${type}`, buffers.valueReferences(names, MODELS[side]), names.length, numbers, names.length);
    }
    this.callFmi(side, "fmi3EnterInitializationMode", 0, 0, 0, 0, 0);
    this.callFmi(side, "fmi3ExitInitializationMode");
  }

  /** @param {Side} side */
  saveSide(side) {
    const size = this.buffers.array("u32", 1);
    this.callFmi(side, "fmi3GetFMUState", this.kept[side]);
    const [state] = this.library.viewMemory("u32", this.kept[side], 1);
    this.callFmi(side, "fmi3SerializedFMUStateSize", state, size);
    const [count] = this.library.viewMemory("u32", size, 1);
    const bytes = this.buffers.allocate(count);
    this.callFmi(side, "fmi3SerializeFMUState", state, bytes, count);
    return new Uint8Array(/** @type {Uint8Array} */ (this.library.viewMemory("u8", bytes, count)));
  }

  /** All that a run resumes from. */
  stateOfRun() {
    const [oscillator, drive] = SIDES.map((side) => this.saveSide(side));
    const [row, last] = [this.library.copyNumbers(this.row, this.start.columns.length), this.library.copyNumbers(this.last, 3)];
    return { oscillator, drive, row, last };
  }

  /** Steps under given voltages; the revolutions that they complete. @param {number[]} voltages */
  runSteps(voltages) {
    const { library, buffers, start, row } = this;
    const [width, count] = [start.columns.length, voltages.length];
    const rows = buffers.array("f64", (1 + count) * width);
    /** @type {Float64Array} */ (library.viewMemory("f64", rows, width)).set(library.viewMemory("f64", row, width));
    const ends = buffers.array("i32", count);
    const done = library.calls.couple(this.pair, row, rows, ends, buffers.array("f64", voltages), count, start.h);
    if (done < count) throw new Error(SIDES.map((side) => library.lastMessage(MODELS[side])).join(" ").trim() || "the coupled run stopped");
    const found = buffers.array("f64", 4 * count);
    const turns = library.calls.find_revolutions(rows, width, 1, ends, count, this.last, found);
    const [table, voltage] = [this.library.copyNumbers(rows, (1 + count) * width), start.columns.indexOf("voltage")];
    return Array.from({ length: turns }, (_, i) => {
      const [place, time, speed, impacts] = this.library.copyNumbers(found + 32 * i, 4);
      return { time, voltage: table[place * width + voltage], speed, impacts };
    });
  }
}
