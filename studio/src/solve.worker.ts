/** The worker: two doors, one a slot, and the jobs that the page asks for. */

import { compile, openDoor, type Answer, type Door } from "./door.ts";
import type { Lattice, Slot, Vec3, Volume } from "./types.ts";

/** A lattice that is still to be filled. */
export type Grid = Omit<Lattice, "values">;

/** What became of a slot: its answer, its slice, |p| at the ear in Pa and how long solving took in ms; or a refusal. */
export type Outcome =
  | { answer: Answer; lattice: Lattice; heard: number; milliseconds: number; warnings: string[] }
  | { refused: string };

/** One a slot, and a third for questions beside. */
let doors: [Door, Door, Door];
/** The scenes that the doors of the slots have open. */
let texts: [string, string];

function places({ corner, u, v, nu, nv }: Grid): Float64Array {
  const all = new Float64Array(3 * nu * nv);
  for (let j = 0, at = 0; j < nv; j += 1)
    for (let i = 0; i < nu; i += 1)
      for (let axis = 0; axis < 3; axis += 1)
        all[at++] = corner[axis] + (u[axis] * i) / (nu - 1) + (v[axis] * j) / (nv - 1);
  return all;
}

function open(slot: Slot, text: string): string[] {
  const warnings = doors[slot].open(text);
  texts[slot] = text;
  return warnings;
}

const jobs = {
  /** Compiles the door, here or elsewhere, and warms it up: the first solve is slow. */
  async setup(source: BufferSource | WebAssembly.Module, warm: string) {
    const module = source instanceof WebAssembly.Module ? source : await compile(source);
    doors = [openDoor(module), openDoor(module), openDoor(module)];
    texts = ["", ""];
    open(0, warm);
    doors[0].solve();
    return { catalogue: doors[0].catalogue(), module };
  },
  /** Solves both slots, looks at the slice and listens at the ear. */
  update(scenes: [string, string], grid: Grid, ear: Vec3 | null): [Outcome, Outcome] {
    const at = places(grid);
    const solve = (slot: Slot): Outcome => {
      try {
        const warnings = open(slot, scenes[slot]);
        const begin = performance.now();
        const answer = doors[slot].solve();
        const milliseconds = performance.now() - begin;
        const [re, im] = ear ? doors[slot].field(Float64Array.from(ear)) : [0, 0];
        const lattice = { ...grid, values: doors[slot].field(at) };
        return { answer, milliseconds, warnings, lattice, heard: Math.hypot(re, im) };
      } catch (error) {
        return { refused: (error as Error).message };
      }
    };
    return [solve(0), solve(1)];
  },
  array: (slot: Slot) => doors[slot].array(),
  field: (slot: Slot, at: Float64Array) => doors[slot].field(at),
  save: (slot: Slot, toml: boolean) => doors[slot].save(toml),
  encode: (slot: Slot, board: string) => doors[slot].encode(board),
  silence: (slot: Slot, board: string) => doors[slot].silence(board),
  /** A scene file as JSON. */
  read(text: string, toml: boolean): string {
    doors[2].open(text, toml);
    return doors[2].save(false);
  },
  /** The bound on the level of a scene. */
  bound(scene: string): number {
    doors[2].open(scene);
    return doors[2].bound();
  },
  /** A layer of |p| on a box, of a drive that was found elsewhere. */
  layer(scene: string, drive: Float32Array, box: Omit<Volume, "moduli">, layer: number): Float32Array {
    if (texts[1] !== scene) open(1, scene);
    doors[1].load(drive);
    const { least, most, count } = box;
    const side = (axis: number) => most[axis] - least[axis];
    const grid: Grid = {
      corner: [least[0], least[1], least[2] + (side(2) * layer) / (count[2] - 1)],
      u: [side(0), 0, 0],
      v: [0, side(1), 0],
      nu: count[0],
      nv: count[1],
    };
    const values = doors[1].field(places(grid));
    return Float32Array.from({ length: values.length / 2 }, (_, k) => Math.hypot(values[2 * k], values[2 * k + 1]));
  },
  /** The slice of a drive that was found elsewhere. */
  slice(scene: string, drive: Float32Array, grid: Grid): Float32Array {
    if (texts[1] !== scene) open(1, scene);
    doors[1].load(drive);
    return doors[1].field(places(grid));
  },
  /** Frames of points (T, M, 3) one after another. */
  follow(scene: string, points: Float64Array, frames: number) {
    open(0, scene);
    return doors[0].follow(points, frames);
  },
  /** The drive of a frame that was followed, and its slice. */
  frame(index: number, grid: Grid) {
    const drive = doors[0].frame(index);
    return { drive, lattice: { ...grid, values: doors[0].field(places(grid)) } };
  },
};

/** What the page may ask for. */
export type Jobs = typeof jobs;

self.onmessage = async ({ data: { id, job, given } }: MessageEvent) => {
  try {
    self.postMessage({ id, result: await (jobs[job as keyof Jobs] as (...all: unknown[]) => unknown)(...given) });
  } catch (error) {
    self.postMessage({ id, refused: (error as Error).message });
  }
};
