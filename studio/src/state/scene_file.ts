/** Scene file: a state as the JSON scene that the package reads, and back (docs/files.md). */

import { MOST_POINTS } from "./initial.ts";
import { middleOf, SIDES, through } from "./plane.ts";
import { read, written } from "./signature.ts";
import type { ArrayChoice, Axis, Obstacle, Slot, State, Vec3 } from "./types.ts";

/** A JSON scene; the WebAssembly binding writes any scene file in this form. */
export interface SceneFile {
  medium?: Record<string, number>;
  array: {
    preset?: string;
    tiles?: [number, number];
    grid?: { nx: number; ny: number; pitch: number };
    positions?: Vec3[];
    normals?: Vec3[];
    quantization?: object;
    [key: string]: unknown;
  };
  points: { position: Vec3; pressure?: number; phase?: number; weight?: number }[];
  obstacles?: (Obstacle | { vertices: unknown })[];
  signature?: unknown;
  solver?: { name: string };
  plane?: { axis?: Axis; z?: number; at?: number; size?: number; center?: [number, number] };
  [key: string]: unknown;
}

const ZERO_CELSIUS = 273.15;
/** Sound speed of air at 0 degrees C, m/s. */
const SPEED = 331.3;

/** Rounds to 1e-9, so that a file contains no rounding errors. */
function rounded(x: number): number {
  return Math.round(x * 1e9) / 1e9 + 0;
}

function place(at: Vec3): Vec3 {
  return at.map(rounded) as Vec3;
}

function writeArray(array: ArrayChoice): SceneFile["array"] {
  if ("preset" in array) return { preset: array.preset, tiles: array.tiles };
  return { positions: array.positions.map(place), normals: array.normals };
}

function writeObstacle(each: Obstacle): Obstacle {
  return "radius" in each
    ? { center: place(each.center), radius: rounded(each.radius), kind: each.kind }
    : { point: place(each.point), normal: each.normal, kind: each.kind };
}

function writePlane(plane: State["plane"]): SceneFile["plane"] {
  const [right, up, at] = SIDES[plane.axis].map((axis) => rounded(middleOf(plane)[axis]));
  return { ...(plane.axis === "z" ? { z: at } : { axis: plane.axis, at }), size: rounded(plane.size), center: [right, up] };
}

/** Returns the JSON scene of a state, with the method of a slot: lengths in m, rounded to 1e-9. */
export function sceneOf(state: State, slot: Slot): SceneFile {
  const { pressures, plane, obstacles, signature, temperature, absorption, density } = state;
  return {
    medium: {
      temperature,
      ...(absorption === null ? {} : { absorption }),
      ...(density === null ? {} : { density }),
    },
    array: { ...writeArray(state.array), ...(state.quantization === "none" ? { quantization: {} } : {}) },
    points: state.points.map((at, k) => ({
      position: place(at),
      ...(pressures ? { pressure: pressures[k] } : {}),
    })),
    ...(obstacles.length ? { obstacles: obstacles.map(writeObstacle) } : {}),
    ...(signature ? { signature: written(signature) } : {}),
    solver: { name: state.methods[slot] },
    plane: writePlane(plane),
  };
}

/** For other keys of an array, the only values that the page supports; a file with other values is rejected. */
const USUAL: Record<string, unknown> = { source_pressure: 4.386, directivity: "point", quantization: {} };

function refuse(item: string, value: unknown, cure: string): never {
  throw new Error(`${item} is ${JSON.stringify(value)?.slice(0, 40)}: ${cure}`);
}

/** Rejects values that a state cannot store and that would change the solution. */
function check(scene: SceneFile): void {
  const { medium = {}, array, points, obstacles = [], signature, plane = {} } = scene;
  const only = (item: string, value: unknown, one: unknown) => {
    if (value !== undefined && JSON.stringify(value) !== JSON.stringify(one)) {
      refuse(item, value, `the page has ${JSON.stringify(one) ?? "no place for it"}, use the package`);
    }
  };
  only("medium.frequency", medium.frequency, 40e3);
  const { preset, tiles, grid, positions, normals, ...parts } = array;
  for (const [key, value] of Object.entries(parts)) {
    // A preset's source pressure and directivity are its own, so a file may state them.
    if (preset === undefined || !["source_pressure", "directivity"].includes(key)) {
      only(`array.${key}`, value, USUAL[key]);
    }
  }
  if (points.length > MOST_POINTS) refuse("points", points.length, `the page has at most ${MOST_POINTS}`);
  points.forEach(({ weight, phase }, k) => {
    only(`points[${k}].weight`, weight, 1);
    only(`points[${k}].phase`, phase, undefined);
  });
  obstacles.forEach((each, k) => {
    const cure = "the page has walls and balls, use the package";
    const keys = Object.keys(each).filter((key) => key !== "kind").sort().join();
    if (keys === "center,radius" || keys === "normal,point") return;
    refuse(`obstacles[${k}]`, "vertices" in each ? "a mesh" : keys, cure);
  });
  if (signature !== undefined && read(signature) === null) {
    refuse("signature", signature, 'give "trap", "twin" or "vortex", or a list of these or "focus", one for each point');
  }
  if (points.length && (plane.z ?? plane.at) === undefined && Object.keys(plane).length) {
    refuse("plane", plane, "give z, or axis and at");
  }
}

function readArray(array: SceneFile["array"]): ArrayChoice {
  const { preset, tiles = [1, 1], grid, positions, normals } = array;
  if (preset !== undefined) return { preset, tiles };
  if (positions !== undefined) {
    return { name: "array", positions, normals: normals ?? positions.map(() => [0, 0, 1]) };
  }
  if (grid === undefined) return refuse("array", array, "give a preset, a grid or positions");
  const { nx, ny, pitch } = grid;
  const places = Array.from({ length: nx * ny }, (_, k): Vec3 => {
    const [i, j] = [k % nx, Math.floor(k / nx)];
    return place([(i - (nx - 1) / 2) * pitch, (j - (ny - 1) / 2) * pitch, 0]);
  });
  return { name: `${nx} x ${ny}`, positions: places, normals: places.map(() => [0, 0, 1]) };
}

/** Returns the temperature in degrees C, to 0.001, at which air has this sound speed in m/s. */
function temperatureOf(speed: number): number {
  return Math.round(1e3 * ZERO_CELSIUS * ((speed / SPEED) ** 2 - 1)) / 1e3;
}

/** Returns the slice of a scene, or one through its points if it has none. */
function readPlane(scene: SceneFile, plane: State["plane"]): State["plane"] {
  const { axis = "z", z, at = z, size = plane.size, center = [0, 0] } = scene.plane ?? {};
  if (at !== undefined) {
    const middle: Vec3 = [0, 0, 0];
    SIDES[axis].forEach((side, k) => (middle[side] = [...center, at][k]));
    return through({ ...plane, axis, size }, middle);
  }
  if (!scene.points.length) return plane;
  const along = (k: number) => scene.points.map(({ position }) => position[k]);
  const middle = (k: number) => rounded((Math.max(...along(k)) + Math.min(...along(k))) / 2);
  return { axis, z: scene.points[0].position[2], size, center: [middle(0), middle(1)] };
}

/**
 * Returns the state of a JSON scene as the WebAssembly binding writes it. Parts that the scene does not have are those of
 * `state`, except the path, which is null.
 *
 * Only the name of a solver is read; source pressure and directivity of a preset are the preset's. Other keys that a state
 * cannot store, such as weights, are rejected with a message of one line.
 */
export function stateOf(scene: SceneFile, state: State): State {
  check(scene);
  const { medium = {}, array, points, obstacles = [], signature = "", solver } = scene;
  const methods: [string, string] = [...state.methods];
  if (solver) methods[state.slot] = solver.name;
  const { sound_speed = 340, temperature = temperatureOf(sound_speed), absorption = null, density = null } = medium;
  const loud = points.length > 0 && points[0].pressure !== undefined;
  return structuredClone({
    ...state,
    array: readArray(array),
    quantization: array.quantization === undefined ? "board" : "none",
    temperature,
    absorption,
    density,
    points: points.map(({ position }) => position),
    filled: [],
    pressures: loud ? points.map(({ pressure = 0 }) => pressure) : null,
    methods,
    signature: read(signature) ?? "",
    obstacles: (obstacles as Obstacle[]).map((each) => ({ ...each, kind: each.kind ?? "rigid" })),
    plane: readPlane(scene, state.plane),
    path: null,
  });
}
