/** Check: tests whether values from a script or a link form a valid state. */

import { MOST_POINTS } from "./initial.ts";
import { fits as suits, isSignature } from "./signature.ts";
import { AXES, type Axis, LEVELS, QUANTITIES, SCALES, type State, VIEWS } from "./types.ts";

/** The arrays and methods of the core. */
interface Catalogue {
  presets: { name: string; tiles: boolean }[];
  solvers: { name: string }[];
}

type Rule = [fits: (value: unknown) => boolean, cure: string];

const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);
const isRow = (value: unknown, count: number): value is number[] =>
  Array.isArray(value) && value.length === count && value.every(isNumber);
const isPlace = (value: unknown) => isRow(value, 3);
const isPlaces = (value: unknown) => Array.isArray(value) && value.length > 0 && value.every(isPlace);
const isTable = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null && !Array.isArray(value);
const oneOf = (...words: readonly unknown[]): Rule => [
  (value) => words.includes(value),
  `give ${words.map((word) => JSON.stringify(word)).join(", ")}`,
];

function isArray(value: unknown): boolean {
  if (!isTable(value)) return false;
  if ("preset" in value) return typeof value.preset === "string" && isRow(value.tiles, 2);
  const { name, positions, normals } = value;
  if (typeof name !== "string" || !isPlaces(positions) || !isPlaces(normals)) return false;
  return (positions as unknown[]).length === (normals as unknown[]).length;
}

function isObstacle(value: unknown): boolean {
  if (!isTable(value) || !["rigid", "soft"].includes(value.kind as string)) return false;
  return "radius" in value ? isPlace(value.center) && isNumber(value.radius) : isPlace(value.point) && isPlace(value.normal);
}

function isPath(value: unknown): boolean {
  if (value === null) return true;
  if (!isTable(value) || !isNumber(value.frequency) || value.frequency <= 0) return false;
  const size = { circle: value.radius, line: value.length }[value.kind as string];
  return isNumber(size) && size > 0;
}

function isPlane(value: unknown): boolean {
  return isTable(value) && AXES.includes(value.axis as Axis) && isNumber(value.z) && isNumber(value.size) && value.size > 0 && isRow(value.center, 2);
}

const RULES: Record<keyof State, Rule> = {
  array: [isArray, 'give { preset: "autd3", tiles: [2, 2] }, or name, positions and normals of your own'],
  quantization: oneOf("board", "none"),
  temperature: [(value) => isNumber(value) && value > -273 && value < 1000, "give degrees C"],
  absorption: [(value) => value === null || (isNumber(value) && value >= 0), "give Np/m, or null"],
  density: [(value) => value === null || (isNumber(value) && value > 0), "give kg/m^3, or null"],
  points: [
    (value) => isPlaces(value) && (value as unknown[]).length <= MOST_POINTS,
    `give 1 to ${MOST_POINTS} places [x, y, z] in m`,
  ],
  pressures: [
    (value) => value === null || (Array.isArray(value) && value.every((each) => isNumber(each) && each >= 0)),
    "give a list of Pa, or null",
  ],
  filled: [(value) => Array.isArray(value) && value.every((each) => Number.isInteger(each) && each >= 0), "give a list of numbers of points, from 0"],
  methods: [(value) => Array.isArray(value) && value.length === 2, 'give two names, such as ["uniform", "naive"]'],
  signature: [isSignature, 'give "", "trap", "twin" or "vortex", or names for each point joined by dots, such as "trap.focus"'],
  obstacles: [(value) => Array.isArray(value) && value.every(isObstacle), "give a list of walls and balls"],
  ear: [(value) => value === null || isPlace(value), "give a place [x, y, z] in m, or null"],
  plane: [isPlane, 'give { axis: "x", "y" or "z", z, size, center: [x, y] } in m'],
  level: oneOf(...LEVELS),
  view: oneOf(...VIEWS),
  quantity: oneOf(...QUANTITIES),
  slot: oneOf(0, 1),
  scale: oneOf(...SCALES),
  path: [isPath, 'give { kind: "circle", radius, frequency }, { kind: "line", length, frequency } or null'],
};

/** Returns the fault of a state as a message of one line, "" if it is valid. */
export function faultOf(state: State, { presets, solvers }: Catalogue): string {
  const quoted = (value: unknown) => (JSON.stringify(value) ?? String(value)).slice(0, 60);
  const unknown = Object.keys(state).find((key) => !(key in RULES));
  if (unknown) return `${unknown} is no part of the state: give some of ${Object.keys(RULES).join(", ")}`;
  for (const [key, [fits, cure]] of Object.entries(RULES)) {
    const value = state[key as keyof State];
    if (!fits(value)) return `${key} is ${quoted(value)}: ${cure}`;
  }
  const { array, methods, points, pressures, signature } = state;
  if ("preset" in array) {
    const preset = presets.find(({ name }) => name === array.preset);
    if (!preset) return `array is ${quoted(array.preset)}: give one of ${presets.map(({ name }) => name).join(", ")}`;
    if (!preset.tiles && array.tiles.join() !== "1,1") return `tiles is ${quoted(array.tiles)}: ${preset.name} has no boards to be tiled`;
  }
  const method = methods.find((name) => !solvers.some((solver) => solver.name === name));
  if (method !== undefined) return `methods has ${quoted(method)}: give two of ${solvers.map(({ name }) => name).join(", ")}`;
  if (!suits(signature, points.length)) return `signature is ${quoted(signature)}: give one name, or one for each of ${points.length} points`;
  if (pressures && pressures.length !== points.length) {
    return `pressures has ${pressures.length} entries: give one for each of ${points.length} points, or null`;
  }
  return pressures?.every((each) => each === 0) ? "pressures is 0 at every point: give one above 0, or null" : "";
}
