/** The WebAssembly binding as functions on plain data. Errors are thrown with a message of one line. */

import type { OwnArray, Vec3 } from "../state/types.ts";

/** A CSV file with more transducers is rejected. */
const MOST_TRANSDUCERS = 16384;

/** Quality of a drive at the points with a target above 0; `weakest` is the least |p| there, in Pa. */
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
  /** Warnings and notes about this result, one line each. */
  said: string[];
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

/** The predicted touch of a skin: felt width in m, largest displacement in m, and felt strength at each place, 1 at the threshold. */
export interface Touch {
  width: number;
  peak: number;
  strengths: Float64Array;
}

/**
 * The simulated motion of a bead: the time in s at which it was lost, or NaN; its largest distance from its path in m until
 * then; and its places (F, 3) in m at the frames of all laps.
 */
export interface Flight {
  lost: number;
  farthest: number;
  places: Float64Array;
}

/** A scene in the WebAssembly module that can be solved, evaluated and played. */
export interface Door {
  catalogue(): Catalogue;
  /** Opens the text of a scene file; returns warnings about probable mistakes, one line each. */
  open(text: string, toml?: boolean, scalar?: boolean): string[];
  /** Returns the scene as the command line writes it. */
  save(toml: boolean): string;
  /** Returns positions (N, 3) in m, then normals (N, 3). */
  array(): Float64Array;
  /**
   * Moves the points (M of x, y, z in m), with new pressures in Pa or the old ones; the next solve starts from the
   * last drive.
   */
  move(points: readonly (readonly number[])[], pressures?: readonly number[]): void;
  solve(): Answer;
  judge(): Metrics;
  /** Sets the drive, and the factor that the supply voltage or modulation must apply. */
  load(drive: ArrayLike<number>, scale?: number): void;
  /** Reads the array of a CSV file. */
  readArray(text: string, name: string): OwnArray;
  /** Reads the drive (N of re, im) of a CSV file. */
  readDrive(text: string, name: string): Float32Array;
  /** Returns the drive as `midair solve -o drive.csv` writes it. */
  writeDrive(): string;
  /** Returns re and im of p at places (K, 3) in m. */
  field(places: Float64Array): Float32Array;
  /** Returns the field values at a place in m. */
  probe(place: Vec3): Probe;
  /** Returns at most this many points along the straight lines between the vertices of each contour; m. */
  along(contours: Vec3[][], most: number): Vec3[];
  bound(): number;
  follow(points: Float64Array, frames: number): Frame[];
  frame(index: number): Float32Array;
  /**
   * Predicts the touch of a skin at places (K, 3) in m, a square lattice, under the frames of `follow`, repeated for ever at
   * `rate` frames per second.
   */
  skin(places: Float64Array, rate: number): Touch;
  /** Returns the displacement of that skin in m at each place, at the start of a frame. */
  moved(frame: number): Float64Array;
  /** Simulates the bead in the trap of a point while the frames of `follow` repeat at `rate` frames/s. */
  fly(point: number, rate: number): Flight;
  encode(board: string): Uint8Array;
  silence(board: string): Uint8Array;
  free(): void;
}

type Call = (...numbers: number[]) => number;
type Exports = { memory: WebAssembly.Memory } & Record<`studio_${string}`, Call>;

/** Compiles the module; throws a message of one line if the browser lacks WebAssembly with SIMD. */
export async function compile(bytes: BufferSource): Promise<WebAssembly.Module> {
  try {
    return await WebAssembly.compile(bytes);
  } catch (error) {
    throw new Error(`this browser cannot run midair (${String(error)}): WebAssembly with SIMD is needed`);
  }
}

/** Makes a binding of a compiled module, with a scene of its own. */
export function openDoor(module: WebAssembly.Module): Door {
  const wasm = new WebAssembly.Instance(module, {}).exports as unknown as Exports;
  const studio = wasm.studio_new();
  const encoder = new TextEncoder();
  const decoder = new TextDecoder();

  // A call can grow the memory, which detaches old views; so each view is made after the call.
  const text = () =>
    decoder.decode(new Uint8Array(wasm.memory.buffer, wasm.studio_text(studio), wasm.studio_text_size(studio)));
  const numbers = () =>
    new Float64Array(wasm.memory.buffer, wasm.studio_numbers(studio), wasm.studio_numbers_count(studio)).slice();
  const bytes = () =>
    new Uint8Array(wasm.memory.buffer, wasm.studio_bytes(studio), wasm.studio_bytes_size(studio)).slice();
  const drive = () =>
    new Float32Array(wasm.memory.buffer, wasm.studio_drive(studio), 2 * wasm.studio_drive_count(studio)).slice();
  const giveText = (given: string) => {
    const encoded = encoder.encode(given);
    const place = wasm.studio_text_in(studio, encoded.length);
    new Uint8Array(wasm.memory.buffer, place, encoded.length).set(encoded);
  };
  const giveFile = (given: string, name: string) => giveText(`${name.replace(/\s+/g, " ")}\n${given}`);
  const giveNumbers = (given: ArrayLike<number>) => {
    const place = wasm.studio_numbers_in(studio, given.length);
    new Float64Array(wasm.memory.buffer, place, given.length).set(given);
  };
  const lines = () => text().split("\n").filter(Boolean);
  const done = (refused: number) => {
    if (refused) throw new Error(text());
  };

  return {
    catalogue() {
      wasm.studio_catalogue(studio);
      return read(lines());
    },
    open(given, toml = false, scalar = false) {
      giveText(given);
      done(wasm.studio_open(studio, Number(toml), Number(scalar)));
      return lines();
    },
    save(toml) {
      done(wasm.studio_save(studio, Number(toml)));
      return text();
    },
    array() {
      done(wasm.studio_array(studio));
      return numbers();
    },
    solve() {
      done(wasm.studio_solve(studio));
      const found = numbers();
      const points = (found.length - 9) / 3;
      const at = (j: number, k: number) => found[9 + 3 * j + k];
      return {
        metrics: metrics(found),
        scale: found[6],
        status: (["done", "out_of_steps", "stopped", "missed"] as const)[found[7]],
        steps: found[8],
        targets: Array.from({ length: points }, (_, j) => at(j, 0)),
        pressures: Array.from({ length: points }, (_, j) => [at(j, 1), at(j, 2)]),
        drive: drive(),
        said: lines(),
      };
    },
    move(points, pressures = []) {
      const odd = points.findIndex((point) => point.length !== 3);
      if (odd >= 0) throw new Error(`points[${odd}] has ${points[odd].length} numbers: give x, y and z in m`);
      giveNumbers([...points.flat(), ...pressures]);
      done(wasm.studio_move(studio, points.length));
    },
    judge() {
      done(wasm.studio_judge(studio));
      return metrics(numbers());
    },
    load(given, scale = 1) {
      giveNumbers(given);
      done(wasm.studio_load(studio, scale));
    },
    readArray(given, name) {
      giveFile(given, name);
      done(wasm.studio_read_array(studio));
      const rows = places(numbers());
      const count = rows.length / 2;
      if (count > MOST_TRANSDUCERS) throw new Error(`${name}: ${count} rows: give at most ${MOST_TRANSDUCERS}`);
      return { name, positions: rows.slice(0, count), normals: rows.slice(count) };
    },
    readDrive(given, name) {
      giveFile(given, name);
      done(wasm.studio_read_drive(studio));
      return drive();
    },
    writeDrive() {
      done(wasm.studio_write_drive(studio));
      return text();
    },
    field(places) {
      giveNumbers(places);
      done(wasm.studio_field(studio));
      const count = Math.floor(places.length / 3);
      return new Float32Array(wasm.memory.buffer, wasm.studio_pressures(studio), 2 * count).slice();
    },
    probe(place) {
      giveNumbers(place);
      done(wasm.studio_probe(studio));
      const [re, im, level, radiation] = numbers();
      return { pressure: [re, im], level, radiation };
    },
    along(contours, most) {
      giveNumbers(contours.flatMap((contour) => [contour.length, ...contour.flat()]));
      done(wasm.studio_along(studio, most));
      return places(numbers());
    },
    bound() {
      done(wasm.studio_bound(studio));
      return numbers()[0];
    },
    follow(points, frames) {
      giveNumbers(points);
      done(wasm.studio_follow(studio, frames));
      const found = numbers();
      return Array.from({ length: frames }, (_, t) => ({
        change: found[3 * t],
        least: found[3 * t + 1],
        most: found[3 * t + 2],
      }));
    },
    frame(index) {
      done(wasm.studio_frame(studio, index));
      return drive();
    },
    skin(places, rate) {
      giveNumbers(places);
      done(wasm.studio_skin(studio, rate));
      const found = numbers();
      return { width: found[0], peak: found[1], strengths: found.subarray(2) };
    },
    moved(frame) {
      done(wasm.studio_moved(studio, frame));
      return numbers();
    },
    fly(point, rate) {
      done(wasm.studio_fly(studio, point, rate));
      const found = numbers();
      return { lost: found[0], farthest: found[1], places: found.slice(2) };
    },
    encode(board) {
      giveText(board);
      done(wasm.studio_encode(studio));
      return bytes();
    },
    silence(board) {
      giveText(board);
      done(wasm.studio_silence(studio));
      return bytes();
    },
    free() {
      wasm.studio_free(studio);
    },
  };
}

/** Returns places as [x, y, z] from K x 3 numbers. */
function places(found: Float64Array): Vec3[] {
  return Array.from({ length: found.length / 3 }, (_, k) => [...found.subarray(3 * k, 3 * k + 3)] as Vec3);
}

function metrics(found: Float64Array): Metrics {
  const [accuracy, sigma, uniformity, level, residual, leak] = found;
  return { accuracy, sigma, uniformity, level, residual, leak };
}

function read(lines: string[]): Catalogue {
  const rows = lines.map((line) => line.split("\t"));
  const of = (kind: string) => rows.filter((row) => row[0] === kind).map((row) => row.slice(1));
  return {
    version: of("version")[0][0],
    presets: of("preset").map(([name, summary, count, tiles, board]) => ({
      name,
      summary,
      count: Number(count),
      tiles: tiles === "1",
      board,
    })),
    solvers: of("solver").map(([name, summary, aims]) => ({ name, summary, aims: aims === "1" })),
    boards: of("board").map(([name, summary, channels, baud, restarts]) => ({
      name,
      summary,
      channels: Number(channels),
      baud: Number(baud),
      restarts: restarts === "1",
    })),
  };
}
