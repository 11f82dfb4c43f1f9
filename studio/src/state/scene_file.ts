/** Scene file: a state as the JSON scene that the package reads, and back (docs/files.md). */

import keys from "../../../python/midair/_studio/keys.json";
import { temperatureOf } from "./air.ts";
import { type Notice, notice, Refusal } from "./notice.ts";
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
    [part: string]: unknown;
  };
  points: { position: Vec3; pressure?: number }[];
  obstacles?: Obstacle[];
  signature?: unknown;
  bead?: State["bead"];
  solver?: { name: string; [option: string]: unknown };
  plane?: { axis?: Axis; z?: number; at?: number; size?: number; center?: [number, number]; pixels?: number };
}

/** Rounds to 1e-9, so that a file contains no rounding errors. */
const rounded = (x: number) => Math.round(x * 1e9) / 1e9 + 0;
const place = (at: Vec3) => at.map(rounded) as Vec3;

function writeArray(array: ArrayChoice): SceneFile["array"] {
  if ("preset" in array) return { preset: array.preset, tiles: array.tiles, ...array.parts };
  return { positions: array.positions.map(place), normals: array.normals, ...array.parts };
}

function writeObstacle(each: Obstacle): Obstacle {
  return "radius" in each ? { ...each, center: place(each.center), radius: rounded(each.radius) } : { ...each, point: place(each.point) };
}

function writePlane({ pixels, ...plane }: State["plane"]): SceneFile["plane"] {
  const [right, up, at] = SIDES[plane.axis].map((axis) => rounded(middleOf(plane)[axis]));
  return { ...(plane.axis === "z" ? { z: at } : { axis: plane.axis, at }), size: rounded(plane.size), center: [right, up], ...(pixels && { pixels }) };
}

/** Returns the JSON scene of a state, with the method of a slot: lengths in m, rounded to 1e-9. */
export function sceneOf(state: State, slot: Slot): SceneFile {
  const { pressures, obstacles, signature, bead, temperature, absorption, density } = state;
  const name = state.methods[slot];
  return {
    medium: {
      temperature,
      ...(absorption === null ? {} : { absorption }),
      ...(density === null ? {} : { density }),
    },
    array: { ...writeArray(state.array), ...(state.quantization === "none" ? { quantization: {} } : {}) },
    points: state.points.map((at, k) => ({ position: place(at), ...(pressures ? { pressure: pressures[k] } : {}) })),
    ...(obstacles.length ? { obstacles: obstacles.map(writeObstacle) } : {}),
    ...(signature ? { signature: written(signature) } : {}),
    ...(bead ? { bead } : {}),
    solver: { ...state.options[name], name },
    plane: writePlane(state.plane),
  };
}

/**
 * Yields what a scene has and a state has not. `known` are the keys of states: true for any value; another value for this
 * value only; a table for a table with these keys; or, for a list, its largest length and the keys of each item.
 */
export function* misfits(value: unknown, known: unknown, path = ""): Generator<Notice> {
  const lacks = (of: unknown, other: string) => notice("page-lacks", { item: path, value: JSON.stringify(of)?.slice(0, 40), other });
  if (Array.isArray(known)) {
    const [most, each] = known;
    const list = value as unknown[];
    if (list.length > most) yield notice("page-most", { item: path, value: list.length, other: most });
    for (const [k, item] of list.entries()) yield* misfits(item, each, `${path}[${k}]`);
  } else if (typeof known === "object") {
    for (const [key, item] of Object.entries(value as object)) yield* misfits(item, (known as Record<string, unknown>)[key], path ? `${path}.${key}` : key);
  } else if (known === undefined) yield lacks(value, "no place for it");
  else if (known !== true && known !== value) yield lacks(value, String(known));
}

function wrong(item: string, value: unknown, cure: string): never {
  throw new Error(`${item} is ${JSON.stringify(value).slice(0, 40)}: ${cure}`);
}

function readArray({ preset, tiles = [1, 1], grid, positions, normals, ...parts }: SceneFile["array"]): ArrayChoice {
  if (JSON.stringify(parts.quantization) === "{}") delete parts.quantization;
  const more = Object.keys(parts).length ? { parts } : {};
  if (preset !== undefined) return { preset, tiles, ...more };
  const facing = (places: Vec3[]) => normals ?? places.map((): Vec3 => [0, 0, 1]);
  if (positions !== undefined) return { name: "array", positions, normals: facing(positions), ...more };
  if (grid === undefined) return wrong("array", parts, "give a preset, a grid or positions");
  const { nx, ny, pitch } = grid;
  const places = Array.from({ length: nx * ny }, (_, k): Vec3 => {
    const [i, j] = [k % nx, Math.floor(k / nx)];
    return place([(i - (nx - 1) / 2) * pitch, (j - (ny - 1) / 2) * pitch, 0]);
  });
  return { name: `${nx} x ${ny}`, positions: places, normals: facing(places), ...more };
}

/** Returns the slice of a scene, or one through its points if it has none. */
function readPlane(scene: SceneFile, plane: State["plane"]): State["plane"] {
  const { axis = "z", z, at = z, size = plane.size, center = [0, 0], pixels } = scene.plane ?? {};
  if (at !== undefined) {
    const middle: Vec3 = [0, 0, 0];
    SIDES[axis].forEach((side, k) => (middle[side] = [...center, at][k]));
    return through({ ...plane, axis, size, ...(pixels && { pixels }) }, middle);
  }
  if (!scene.points.length) return plane;
  if (scene.plane && Object.keys(scene.plane).length) wrong("plane", scene.plane, "give z, or axis and at");
  const along = (k: number) => scene.points.map(({ position }) => position[k]);
  const middle = (k: number) => rounded((Math.max(...along(k)) + Math.min(...along(k))) / 2);
  return { axis, z: scene.points[0].position[2], size, center: [middle(0), middle(1)] };
}

function readSignature(value: unknown): string {
  return read(value) ?? wrong("signature", value, 'give "trap", "twin" or "vortex", or a list of these or "focus", one for each point');
}

/**
 * Returns the state of a JSON scene as the WebAssembly binding writes it. Parts that the scene does not have are those of
 * `state`, except the path, which is null. Anything that a state does not have is rejected with a message of one line.
 */
export function stateOf(scene: SceneFile, state: State): State {
  for (const each of misfits(scene, keys)) throw new Refusal(each);
  const { medium = {}, array, points, obstacles = [], signature = "", bead = null, solver } = scene;
  const methods: [string, string] = [...state.methods];
  const { name, ...options } = solver ?? { name: methods[state.slot] };
  methods[state.slot] = name;
  const { sound_speed = 340, temperature = temperatureOf(sound_speed), absorption = null, density = null } = medium;
  const loud = points.length > 0 && points[0].pressure !== undefined;
  return structuredClone({
    ...state,
    array: readArray(array),
    quantization: JSON.stringify(array.quantization) === "{}" ? "none" : "board",
    temperature,
    absorption,
    density,
    points: points.map(({ position }) => position),
    filled: [],
    pressures: loud ? points.map(({ pressure = 0 }) => pressure) : null,
    methods,
    options: Object.keys(options).length ? { [name]: options } : {},
    signature: readSignature(signature),
    bead,
    obstacles: obstacles.map((each) => ({ ...each, kind: each.kind ?? "rigid" })),
    plane: readPlane(scene, state.plane),
    path: null,
  });
}
