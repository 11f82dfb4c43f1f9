/** The WebAssembly binding as functions on plain data. Errors are thrown with a message of one line. */

import { refuse } from "../state/notice.ts";
import { type Notice, Refusal } from "../state/refusal.ts";
import type { OwnArray, Vec3 } from "../state/types.ts";

/** A CSV file with more transducers, and a call with more numbers, is rejected. */
const MOST_TRANSDUCERS = 16384;
const MOST_NUMBERS = 1e8;

/** Quality of a drive at the points with a target above 0. */
export interface Metrics {
  accuracy: number;
  sigma: number;
  uniformity: number;
  level: number;
  residual: number;
  leak: number;
}

/** The result of a solver. */
export interface Answer {
  metrics: Metrics;
  /** The factor that the supply voltage or modulation must apply to the drive. */
  scale: number;
  status: "done" | "out_of_steps" | "stopped" | "missed";
  steps: number;
  /** Targets of the points, in Pa. */
  targets: number[];
  /** re and im of p at each point, in Pa. */
  pressures: [number, number][];
  /** re and im of each transducer's drive. */
  drive: Float32Array;
  /** Warnings about this result. */
  said: Notice[];
}

/** The field at a place: p in Pa, its level in dB SPL, its radiation pressure on a rigid wall in Pa. */
export interface Probe {
  pressure: [number, number];
  level: number;
  radiation: number;
}

/** An array that has a name. */
export interface Preset {
  name: string;
  summary: string;
  count: number;
  tiles: boolean;
  board: string;
}

/** A method, and whether it has the option `aim`. */
export interface Solver {
  name: string;
  summary: string;
  aims: boolean;
}

/** A kind of board. `baud` is 0 if it has no serial line; `restarts` tells whether opening its port restarts it. */
export interface BoardKind {
  name: string;
  summary: string;
  channels: number;
  baud: number;
  restarts: boolean;
}

/** The core's version, presets, methods and boards. */
export interface Catalogue {
  version: string;
  presets: Preset[];
  solvers: Solver[];
  boards: BoardKind[];
}

/**
 * A frame of a sequence: the largest phase change in rad, the least |p| of the points that are not quiet, and the largest |p|
 * of all points, in Pa.
 */
export interface Frame {
  change: number;
  least: number;
  most: number;
}

/**
 * Moving points: frames per second, whether the last frame continues to the first, the number of points in a frame, the points
 * (T, M, 3) in m, and the targets (T, M) in Pa.
 */
export interface Motion {
  rate: number;
  closed: boolean;
  count: number;
  points: Float64Array;
  targets: Float64Array;
}

/**
 * The predicted touch of a skin: felt width in m, largest displacement in m, force in N of a contact that is felt alike; and at
 * each place the felt strength, 1 at the threshold, and the pressure in Pa that is felt as a push.
 */
export interface Touch {
  width: number;
  peak: number;
  force: number;
  strengths: Float64Array;
  pushes: Float64Array;
}

/**
 * The simulated motion of a bead: the time in s at which it was lost, or null; its largest distance from its point in m until
 * then; and its places (F, 3) in m at the frames of all laps. The list ends where the bead is lost.
 */
export interface Flight {
  lost: number | null;
  farthest: number;
  places: Float64Array;
}

type Call = (...numbers: number[]) => number;
type Exports = { memory: WebAssembly.Memory } & Record<`studio_${string}`, Call>;

/** Compiles the module; throws a message of one line if the browser lacks WebAssembly with SIMD. */
export async function compile(bytes: BufferSource): Promise<WebAssembly.Module> {
  try {
    return await WebAssembly.compile(bytes);
  } catch (error) {
    refuse("no-simd", { value: String(error) });
  }
}

/** Writes a scene as JSON, which has no NaN and no infinity: they become text, which is refused where it stands. */
export function written(scene: object): string {
  try {
    return JSON.stringify(scene, (_, value) => (typeof value === "number" && !Number.isFinite(value) ? String(value) : value)) ?? "";
  } catch (error) {
    refuse("scene-form", { value: String(error).split("\n")[0] });
  }
}

/** The numbers of the results in the module. */
const [TEXT, NUMBERS, DRIVE, PRESSURES, BYTES] = [0, 1, 2, 3, 4];

/** A scene of its own in a compiled module, which can be solved, evaluated and played. */
export class Door {
  private readonly wasm: Exports;
  /** Its address in the module; 0 once it is freed or lost. */
  private studio: number;

  constructor(module: WebAssembly.Module) {
    this.wasm = new WebAssembly.Instance(module, {}).exports as unknown as Exports;
    this.studio = this.wasm.studio_new();
  }

  catalogue(): Catalogue {
    this.run("catalogue");
    return JSON.parse(this.text());
  }

  /** Opens the text of a scene file; returns warnings about probable mistakes. */
  open(text: string, toml = false): Notice[] {
    this.giveText(text);
    this.call("open", Number(toml));
    return JSON.parse(this.text());
  }

  /** Returns the scene as the command line writes it. */
  save(toml: boolean): string {
    this.call("save", Number(toml));
    return this.text();
  }

  /** Returns positions (N, 3) in m, then normals (N, 3). */
  array(): Float64Array {
    this.call("array");
    return this.numbers();
  }

  /**
   * Moves the points (M of x, y, z in m), with new pressures in Pa or the old ones; the next solve starts from the
   * last drive.
   */
  move(points: readonly (readonly number[])[], pressures: readonly number[] = []): void {
    const odd = points.findIndex((point) => point.length !== 3);
    if (odd >= 0) refuse("point-form", { item: odd, point: odd + 1, value: points[odd].length });
    this.giveNumbers("points", [...points.flat(), ...pressures]);
    this.call("move", points.length);
  }

  solve(): Answer {
    this.call("solve");
    const [all, { status, said }] = [this.numbers(), JSON.parse(this.text())];
    const points = Array.from({ length: (all.length - 8) / 3 }, (_, j) => all.subarray(8 + 3 * j, 11 + 3 * j));
    return {
      metrics: metrics(all),
      scale: all[6],
      status,
      steps: all[7],
      targets: points.map(([target]) => target),
      pressures: points.map(([, re, im]) => [re, im]),
      drive: this.drive(),
      said,
    };
  }

  /** Returns how many traps of the last solution hold their bead, and the number of traps; empty without traps. */
  beads(): number[] {
    this.call("beads");
    return [...this.numbers()];
  }

  /** Returns the metrics of the drive, and its pressures at the points; a trap's are those of its foci. */
  judge(): Pick<Answer, "metrics" | "pressures"> {
    this.call("judge");
    const all = new Float32Array(...this.result(PRESSURES, 2));
    return { metrics: metrics(this.numbers()), pressures: Array.from({ length: all.length / 2 }, (_, j) => [all[2 * j], all[2 * j + 1]]) };
  }

  /** Sets the drive, and the factor that the supply voltage or modulation must apply. */
  load(drive: ArrayLike<number>, scale = 1): void {
    this.giveNumbers("drive", drive, 2);
    this.call("load", scale);
  }

  /** Reads the array of a CSV file. */
  readArray(text: string, name: string): OwnArray {
    this.giveFile(text, name);
    this.call("read_array");
    const rows = places(this.numbers());
    const count = rows.length / 2;
    if (count > MOST_TRANSDUCERS) refuse("rows", { value: count, other: MOST_TRANSDUCERS }, name);
    return { name, positions: rows.slice(0, count), normals: rows.slice(count) };
  }

  /** Reads the drive (N of re, im) of a CSV file. */
  readDrive(text: string, name: string): Float32Array {
    this.giveFile(text, name);
    this.call("read_drive");
    return this.drive();
  }

  /** Returns the drive as `midair solve -o drive.csv` writes it. */
  writeDrive(): string {
    this.call("write_drive");
    return this.text();
  }

  /** Returns re and im of p at places (K, 3) in m. */
  field(places: Float64Array): Float32Array {
    this.giveNumbers("places", places, 3);
    this.call("field");
    return new Float32Array(...this.result(PRESSURES, 2)).slice();
  }

  /** Returns the field values at a place in m. */
  probe(place: Vec3): Probe {
    this.giveNumbers("place", place, 3, 3);
    this.call("probe");
    const [re, im, level, radiation] = this.numbers();
    return { pressure: [re, im], level, radiation };
  }

  /** Returns at most this many points along the straight lines between the vertices of each contour; m. */
  along(contours: Vec3[][], most: number): Vec3[] {
    this.giveNumbers("contours", contours.flatMap((contour) => [contour.length, ...contour.flat()]));
    this.call("along", whole("most", most));
    return places(this.numbers());
  }

  bound(): number {
    this.call("bound");
    return this.numbers()[0];
  }

  /** Returns the frames of a scene file with `[motion]`; throws for another scene. */
  motion(): Motion {
    this.call("motion");
    const all = this.numbers();
    const [rate, closed, count] = all;
    const size = 3 + (3 * (all.length - 3)) / 4;
    return { rate, closed: closed === 1, count, points: all.slice(3, size), targets: all.slice(size) };
  }

  /** Solves frames (T, M, 3) in m one after the other; without points, those of the scene's motion. */
  follow(points: Float64Array = new Float64Array(), frames = 0): Frame[] {
    this.giveNumbers("points", points, 3);
    this.call("follow", whole("frames", frames));
    const all = this.numbers();
    return Array.from({ length: all.length / 3 }, (_, t) => {
      const [change, least, most] = all.subarray(3 * t);
      return { change, least, most };
    });
  }

  frame(index: number): Float32Array {
    this.call("frame", whole("frame", index));
    return this.drive();
  }

  /**
   * Predicts the touch of a skin at places (K, 3) in m, a square lattice, under the frames of `follow`, repeated for ever at
   * `rate` frames per second.
   */
  skin(places: Float64Array, rate: number): Touch {
    this.giveNumbers("places", places, 3);
    this.call("skin", rate);
    const [all, end] = [this.numbers(), 3 + places.length / 3];
    return { width: all[0], peak: all[1], force: all[2], strengths: all.slice(3, end), pushes: all.slice(end) };
  }

  /** Returns the displacement of that skin in m at each place, at the start of a frame. */
  moved(frame: number): Float64Array {
    this.call("moved", whole("frame", frame));
    return this.numbers();
  }

  /** Simulates the bead in the trap of a point while the frames of `follow` repeat at `rate` frames/s. */
  fly(point: number, rate: number): Flight {
    this.call("fly", whole("point", point), rate);
    const all = this.numbers();
    return { lost: Number.isNaN(all[0]) ? null : all[0], farthest: all[1], places: all.slice(2) };
  }

  encode(board: string): Uint8Array {
    this.giveText(board);
    this.call("encode");
    return this.bytes();
  }

  silence(board: string): Uint8Array {
    this.giveText(board);
    this.call("silence");
    return this.bytes();
  }

  free(): void {
    if (this.studio) this.run("free");
    this.studio = 0;
  }

  private call(job: string, ...inputs: number[]): void {
    if (this.run(job, ...inputs)) throw new Refusal(JSON.parse(this.text()));
  }

  /** Calls a function of the module. A trap, because memory is used up, ends the scene: its state is unknown then. */
  private run(job: string, ...inputs: number[]): number {
    if (!this.studio) refuse("scene-freed");
    try {
      return this.wasm[`studio_${job}`](this.studio, ...inputs);
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      this.studio = 0;
      return refuse("scene-broken", { value: error.message });
    }
  }

  // A call can grow the memory, which detaches old views; so each view is made after the call.
  /** Returns the memory, and where a result is in it: its address, and how many numbers it has, so many in each entry. */
  private result(kind: number, each = 1): [ArrayBuffer, number, number] {
    const { memory, studio_result, studio_count } = this.wasm;
    return [memory.buffer, studio_result(this.studio, kind), each * studio_count(this.studio, kind)];
  }

  private text = () => new TextDecoder().decode(new Uint8Array(...this.result(TEXT)));
  private numbers = () => new Float64Array(...this.result(NUMBERS)).slice();
  private bytes = () => new Uint8Array(...this.result(BYTES)).slice();
  private drive = () => new Float32Array(...this.result(DRIVE, 2)).slice();

  private giveText(text: string): void {
    const encoded = new TextEncoder().encode(text);
    const address = this.run("text_in", encoded.length);
    new Uint8Array(this.wasm.memory.buffer, address, encoded.length).set(encoded);
  }

  private giveFile(text: string, name: string): void {
    this.giveText(`${name.replace(/\s+/g, " ")}\n${text}`);
  }

  /** Gives the module numbers, so many in each entry. */
  private giveNumbers(item: string, numbers: ArrayLike<number>, each = 1, most = MOST_NUMBERS): void {
    const count = numbers.length;
    if (!(Number.isInteger(count / each) && count >= 0 && count <= most)) {
      refuse("numbers-count", { item, value: String(count), other: each });
    }
    const address = this.run("numbers_in", count);
    new Float64Array(this.wasm.memory.buffer, address, count).set(numbers);
  }
}

/** Checks a number or an index of something. */
function whole(item: string, value: number): number {
  if (!(Number.isInteger(value) && value >= 0 && value < 2 ** 32)) refuse("whole-number", { item, value: String(value) });
  return value;
}

/** Returns places as [x, y, z] from K x 3 numbers. */
function places(numbers: Float64Array): Vec3[] {
  return Array.from({ length: numbers.length / 3 }, (_, k) => [...numbers.subarray(3 * k, 3 * k + 3)] as Vec3);
}

function metrics(numbers: Float64Array): Metrics {
  const [accuracy, sigma, uniformity, level, residual, leak] = numbers;
  return { accuracy, sigma, uniformity, level, residual, leak };
}
