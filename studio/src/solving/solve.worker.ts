/** The worker: WebAssembly scenes, and the jobs that the page requests. */

import { type Answer, compile, Door } from "./door.ts";
import { type Notice, noticeOf } from "../state/notice.ts";
import type { SceneFile } from "../state/scene_file.ts";
import type { Lattice, Vec3, Volume } from "../state/types.ts";

/** A lattice without values. */
export type Grid = Omit<Lattice, "values">;

/** A drive, and the factor that the supply voltage or modulation must apply. */
export type Played = Pick<Answer, "drive" | "scale">;

/** The outcome for a slot: its solution, its slices, |p| at the ear in Pa and Door.beads; or an error. */
export type Outcome =
  | { answer: Answer; lattices: Lattice[]; atEar: number; beads: number[]; warnings: Notice[] }
  | { refused: Notice };

/**
 * Number of time measurements; duration of each in ms (solves are repeated, as a browser's clock has steps of 0.1 ms); and the
 * limit for all of them in ms.
 */
const RUNS = 5;
const FINE = 2;
const PATIENCE = 1000;

/** The shown scene, and a second one for other jobs. */
let door: Door;
let beside: Door;
/** The scene of a path with its frames, which stay when other scenes are opened. */
let mover: Door;
/** The texts of the scenes that `door` and `beside` have open. */
let text = "";
let other = "";

function places({ corner, u, v, nu, nv }: Grid): Float64Array {
  const all = new Float64Array(3 * nu * nv);
  for (let j = 0, at = 0; j < nv; j += 1)
    for (let i = 0; i < nu; i += 1)
      for (let axis = 0; axis < 3; axis += 1)
        all[at++] = corner[axis] + (u[axis] * i) / (nu - 1) + (v[axis] * j) / (nv - 1);
  return all;
}

function open(scene: string): Notice[] {
  const warnings = door.open(scene);
  text = scene;
  return warnings;
}

/** Returns the second scene, opened from a text unless it has this text open, with the drive if there is one. */
function aside(scene: string, played?: { drive: Float32Array; scale?: number }): Door {
  if (other !== scene) beside.open(scene);
  other = scene;
  if (played) beside.load(played.drive, played.scale);
  return beside;
}

/** Returns the outcome of a solution: its slices, and |p| at the ear; 0 if the scene shows no ear. */
function looked(shown: Door, answer: Answer, warnings: Notice[], grids: Grid[], ear: Vec3 | null, beads: number[] = []): Outcome {
  const [re, im] = ear ? shown.field(Float64Array.from(ear)) : [0, 0];
  const lattices = grids.map((grid) => ({ ...grid, values: shown.field(places(grid)) }));
  return { answer, warnings, lattices, atEar: Math.hypot(re, im), beads };
}

/** Returns the outcome of a drive that was computed elsewhere. */
function judged(scene: string, drive: Float32Array, grids: Grid[], ear: Vec3 | null): Outcome {
  aside(scene, { drive });
  const points = JSON.parse(scene).points as { pressure?: number }[];
  const { metrics, pressures } = beside.judge();
  const targets = points.map(({ pressure }, k) => pressure ?? Math.hypot(...pressures[k]));
  const answer: Answer = { metrics, scale: 1, status: "done", steps: 0, targets, pressures, drive, said: [] };
  return looked(beside, answer, [], grids, ear);
}

const jobs = {
  /** Compiles the module, unless it is given compiled, and solves a small scene, because the first solve is slow. */
  async setup(source: BufferSource | WebAssembly.Module, warm: string) {
    const module = source instanceof WebAssembly.Module ? source : await compile(source);
    [door, beside, mover] = [new Door(module), new Door(module), new Door(module)];
    open(warm);
    door.solve();
    return { catalogue: door.catalogue(), module };
  },
  /** Solves a scene and computes its slices and |p| at the ear. With `passing`, the shown scene stays open. */
  update(scene: string, grids: Grid[], ear: Vec3 | null, passing = false): Outcome {
    try {
      const warnings = passing ? [] : open(scene);
      const shown = passing ? aside(scene) : door;
      return looked(shown, shown.solve(), warnings, grids, ear, passing ? [] : shown.beads());
    } catch (error) {
      return { refused: noticeOf(error) };
    }
  },
  /** Returns the time of a solve in ms: the median of five after a first one, of fewer if they take more than a second. */
  time(scene: string): number {
    aside(scene).solve();
    const times: number[] = [];
    const first = performance.now();
    do {
      const begin = performance.now();
      let solves = 0;
      do {
        beside.solve();
        solves += 1;
      } while (performance.now() - begin < FINE);
      times.push((performance.now() - begin) / solves);
    } while (times.length < RUNS && performance.now() - first < PATIENCE);
    return times.toSorted((a, b) => a - b)[times.length >> 1];
  },
  array: () => door.array(),
  /** Returns the array of another scene. */
  arrayOf: (scene: string) => aside(scene).array(),
  along: (contours: Vec3[][], most: number) => door.along(contours, most),
  field: (at: Float64Array) => door.field(at),
  save: (toml: boolean) => door.save(toml),
  /** Returns the bytes with which a board plays a drive. */
  encode: (scene: string, drive: Float32Array, board: string) => aside(scene, { drive }).encode(board),
  /** Returns the bytes that turn a board off. */
  silence: (scene: string, board: string) => aside(scene).silence(board),
  readArray: (text: string, name: string) => beside.readArray(text, name),
  readDrive: (text: string, name: string) => beside.readDrive(text, name),
  /** Returns the CSV of a drive for a scene. */
  writeDrive: (scene: string, drive: Float32Array) => aside(scene, { drive }).writeDrive(),
  /** Returns a scene file as JSON; of its array, without the parts that all such arrays have. */
  read(text: string, toml: boolean): SceneFile {
    beside.open(text, toml);
    other = "";
    const scene: SceneFile = JSON.parse(beside.save(false));
    const { preset, tiles, grid, positions, normals } = scene.array;
    const place = { preset, tiles, grid, positions, normals };
    beside.open(JSON.stringify({ array: place, points: scene.points }));
    const usual: SceneFile = JSON.parse(beside.save(false));
    for (const [key, value] of Object.entries(usual.array)) {
      if (!(key in place) && JSON.stringify(value) === JSON.stringify(scene.array[key])) delete scene.array[key];
    }
    return scene;
  },
  /** Returns the bound on the level of a scene. */
  bound: (scene: string) => aside(scene).bound(),
  /** Returns |p| of a solution in one horizontal layer of a box. */
  layer(scene: string, { drive, scale }: Played, box: Omit<Volume, "moduli">, layer: number): Float32Array {
    if (text !== scene) open(scene);
    door.load(drive, scale);
    const { least, most, count } = box;
    const side = (axis: number) => most[axis] - least[axis];
    const grid: Grid = {
      corner: [least[0], least[1], least[2] + (side(2) * layer) / (count[2] - 1)],
      u: [side(0), 0, 0],
      v: [0, side(1), 0],
      nu: count[0],
      nv: count[1],
    };
    const values = door.field(places(grid));
    return Float32Array.from({ length: values.length / 2 }, (_, k) => Math.hypot(values[2 * k], values[2 * k + 1]));
  },
  /** Returns the field values of a solution at a place. */
  probe: (scene: string, played: Played, place: Vec3) => aside(scene, played).probe(place),
  judged,
  /** Solves frames of points (T, M, 3) one after the other, and returns their metrics. */
  follow(scene: string, points: Float64Array, frames: number) {
    mover.open(scene);
    return mover.follow(points, frames);
  },
  /** Returns the outcome of a frame that `follow` has solved; `scene` has the frame's points. */
  frame: (index: number, scene: string, grids: Grid[], ear: Vec3 | null) => judged(scene, mover.frame(index), grids, ear),
  /** Predicts the touch of a skin under the frames that `follow` has solved, repeated at `rate` frames per second. */
  skin: (grid: Grid, rate: number) => mover.skin(places(grid), rate),
  /** Returns the displacement in m of the skin that `skin` has predicted, at the start of a frame. */
  moved: (frame: number) => mover.moved(frame),
  /** Simulates the bead in the trap of a point while the frames of `follow` repeat. */
  fly: (point: number, rate: number) => mover.fly(point, rate),
};

/** The jobs that the page can request. */
export type Jobs = typeof jobs;

self.onmessage = async ({ data: { id, job, inputs } }: MessageEvent) => {
  try {
    self.postMessage({ id, result: await (jobs[job as keyof Jobs] as (...all: unknown[]) => unknown)(...inputs) });
  } catch (error) {
    self.postMessage({ id, refused: noticeOf(error) });
  }
};
