// What modules of the page hand to each other, each type by one name for the JSDoc of all modules.

type App = import("./app.js").App;
type DiagramView = import("./diagram_view.js").DiagramView;
type Inspector = import("./inspector.js").Inspector;
type Library = import("./kernel.js").Library;
type Oscillator = import("./kernel.js").Oscillator;
type Picture = import("./picture.js").Picture;
type WorkerPool = import("./worker_pool.js").WorkerPool;

// -- a structure, what pushes it besides, and how the box is shaken

type Structure = Record<
  | ("m1" | "m2" | "k1" | "k2" | "d1" | "d2" | "e" | "gamma" | "bonded" | "clearance" | "stroke" | "wall")
  | ("box_acceleration" | "force1" | "force2"),
  number
>;
type Units = Record<string, { label: string; kg: number; m: number; s: number }>; // names and exponents
type Ranges = Record<string, [number, number]>; // of the numbers of a structure
type Level = { unit: "paper" | "g" | "mm"; value: number }; // acceleration in g, or amplitude in mm
type Point = { structure: Structure; eta: number; frequency: number; amplitude: number };
// of a beam of one's own; a time that is named is for the paper's beam too
type Asked = {
  frequency: "Hz" | "rpm" | "rad/s" | "eta"; length: "m" | "mm" | "um";
  acceleration: "g" | "m/s2"; time: "" | "s" | "periods";
};

// -- what is computed; four numbers a state, gaps and peak over a eta^2

type Settings = { transient: number; samples: number; tolerance: number };
type Settled = { // where it is undecided the multiplicity is a guess
  states: Float64Array; gaps: Float64Array; peak: number; impacts: number; contact: boolean;
  multiplicity: number; decided: number; start: number[]; end: number[];
};
type Found = Omit<Settled, "states"> & { index: number };
type Choice = { point: Point; start: number[]; settings: Settings; level: Level };
type Motion = {
  time: Float64Array; states: Float64Array; contact: Uint8Array; period: number; first: number; points: number;
  // of each impact: closing speed, the common displacement of both masses, energy lost in J
  impactTime: Float64Array; impactSpeed: Float64Array; impactPlace: Float64Array; impactEnergy: Float64Array;
};
type Spectrum = { order: Float64Array; amplitude: Float64Array }; // lines over the excitation's
// per unit of tau, with its standard error; 1 chaotic, −1 converging, 0 undecided
type Exponent = { value: number; error: number; verdict: number };
// gap from 0 and gap velocity to both sides, over a eta^2; means of displacements, velocities
type Plane = { side: number; gap: number; speed: number; mean: [number, number] };
type Attractor = { multiplicity: number; decided: number; samples: Float64Array; impacts: number; frequency: number; gap: number };
type Row = { time: number; voltage: number; speed: number; impacts: number }; // a revolution of the motor
// in Hz and m/s²; a row for each order
type Measured = Record<"orders", { frequency: number[]; amplitude: number[][] } | undefined> &
  Record<"lines", { frequency: number[]; amplitude: number[] } | undefined> & { title: string };

// -- diagrams, over frequency ratios

type Direction = "up" | "down" | "both";
type Region = { low: number; high: number; direction: Direction; level: Level };
type Lane = {
  direction: "up" | "down"; found: (Found | undefined)[];
  starts: Float64Array | null; // where each response begins, if that is known beforehand
  from: number[] | null; // where a chain does
};
type Diagram = Region & { structure: Structure; points: Point[]; lanes: Lane[]; settings: Settings };
type View = Region & { structure: Structure; eta: number | null; start: number[] | null };
type Take = (lane: Lane, found: Found) => void;

// -- pictures

type Theme = Record<"paper" | "ink" | "soft" | "grid" | "one" | "two" | "hit" | "contact" | "mark" | "up" | "down", string>;
type Pen = import("./pen.js").CanvasPen | import("./pen.js").SvgPen;
type Style = { stroke?: string; fill?: string; width?: number; dash?: number[]; alpha?: number };
type Lettering = { anchor?: "start" | "middle" | "end"; turn?: boolean; size?: number; fill?: string };
type Size = { width: number; height: number };
type Place = [number, number, number, number]; // x, y, width, height
type Draw = (pen: Pen, size: Size, theme: Theme) => void;
type Axis = { low: number; high: number; log?: boolean; label?: string };
type Series = {
  x: ArrayLike<number>; y: ArrayLike<number>; colour: keyof Theme;
  dots?: number; label?: string; alpha?: number; width?: number;
};
type Chart = { x: Axis; y: Axis; series: Series[]; spans?: [number, number][] }; // spans of contact

// -- the compiled loops, and what the page carries

type Order = { cancel: () => void; done: Promise<void> };
type Kind = "u32" | "i32" | "f64" | "u8";
type Loops = Record<"booleans" | "counts" | "deviating" | "read" | "reals" | "series" | "traits", string[]> & {
  structures: Record<string, { size: number; fields: Record<string, [Kind, number]> }>; // kind and place
  set: Record<string, number>; pushes: Record<string, string>; exponent: Record<string, number>;
  capacity: number; // states that a step keeps
};
// references of variables, by model
type Compiled = { module: WebAssembly.Module; variables: Record<string, Record<string, number>>; loops: Loops };
type Side = "oscillator" | "drive";
type Start = Record<Side | "pair", Record<string, number>> & { // start values, the loop's structure
  names: Record<Side, { inputs: string[]; outputs: string[] }>; columns: string[]; h: number; omega: number;
};
// saved states and last row, and what there was when the revolution began
type Run = Record<Side, Uint8Array> & { row: Float64Array; last: Float64Array };
type Sheet = { head: string[]; rows: Iterable<(number | string)[]> }; // a table to save
type Table = Pick<Compiled, "variables" | "loops"> & {
  structure: Structure; usual: Structure; ranges: Ranges; units: Units; shown: Asked; settings: Settings;
  directions: ("up" | "down")[]; count: number; low: number; high: number; level: [Level["unit"], number];
  alike: number; drive: Start; tour: Record<string, string>; record: Measured | null;
  branches: { x: number[]; y: number[]; stable: boolean }[];
  bifurcations: { eta: number; gap: number; kind: string }[];
};
