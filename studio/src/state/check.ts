/** Check: tests whether values from a script or a link form a valid state; a link has the limits of numbers. */

import { initial } from "./initial.ts";
import { readLink, writeLink } from "./link.ts";
import { fits, isSignature } from "./signature.ts";
import { LEVELS, QUANTITIES, SCALES, type State, VIEWS } from "./types.ts";

/** The arrays and methods of the core. */
interface Catalogue {
  presets: { name: string; tiles: boolean }[];
  solvers: { name: string }[];
}

/** The form of a value: any number or text, one of some forms, a list, a tuple, a table with some keys, or one value. */
type Form = typeof Number | typeof String | Set<Form> | List | readonly Form[] | { [key: string]: Form } | string | number | null;

/** The form of a list of any length. */
class List {
  constructor(readonly each: Form) {}
}

const matches = (form: Form, value: unknown): boolean => {
  if (form === Number) return Number.isFinite(value);
  if (form === String) return typeof value === "string";
  if (form instanceof Set) return [...form].some((each) => matches(each, value));
  if (form instanceof List) return Array.isArray(value) && value.every((each) => matches(form.each, each));
  if (Array.isArray(form)) return Array.isArray(value) && value.length === form.length && form.every((each, k) => matches(each, value[k]));
  if (typeof form !== "object" || form === null) return value === form;
  return typeof value === "object" && value !== null && Object.entries(form).every(([key, each]) => matches(each, (value as Record<string, unknown>)[key]));
};

const oneOf = (...forms: readonly Form[]) => new Set(forms);
const PLACE = [Number, Number, Number];
const KIND = oneOf("rigid", "soft");
const words = (all: readonly (string | number)[]): [Form, string] => [oneOf(...all), `give ${all.map((word) => JSON.stringify(word)).join(", ")}`];

/** The form of each part of a state, and the cure of other values. */
const RULES: Record<keyof State, [Form, string]> = {
  array: [
    oneOf({ preset: String, tiles: [Number, Number] }, { name: String, positions: new List(PLACE), normals: new List(PLACE) }),
    'give { preset: "autd3", tiles: [2, 2] }, or name, positions and normals of your own',
  ],
  quantization: words(["board", "none"]),
  temperature: [Number, "give degrees C"],
  absorption: [oneOf(null, Number), "give Np/m, or null"],
  density: [oneOf(null, Number), "give kg/m^3, or null"],
  points: [new List(PLACE), "give places [x, y, z] in m"],
  pressures: [oneOf(null, new List(Number)), "give a list of Pa, or null"],
  filled: [new List(Number), "give a list of numbers of points, from 0"],
  methods: [[String, String], 'give two names, such as ["uniform", "naive"]'],
  options: [{}, "give { greedy: { seed: 3 } }"],
  signature: [String, 'give "", "trap", "twin" or "vortex", or names for each point joined by dots, such as "trap.focus"'],
  bead: [
    oneOf(null, { radius: Number, density: Number, sound_speed: Number, gravity: PLACE }),
    "give { radius, density, sound_speed, gravity: [0, 0, -9.81] }, or null",
  ],
  obstacles: [new List(oneOf({ center: PLACE, radius: Number, kind: KIND }, { point: PLACE, normal: PLACE, kind: KIND })), "give a list of walls and balls"],
  ear: [oneOf(null, PLACE), "give a place [x, y, z] in m, or null"],
  plane: [{ axis: String, z: Number, size: Number, center: [Number, Number] }, 'give { axis: "x", "y" or "z", z, size, center: [x, y] } in m'],
  level: words(LEVELS),
  view: words(VIEWS),
  quantity: words(QUANTITIES),
  slot: words([0, 1]),
  scale: words(SCALES),
  path: [
    oneOf(null, { kind: "circle", radius: Number, frequency: Number }, { kind: "line", length: Number, frequency: Number }),
    'give { kind: "circle", radius, frequency }, { kind: "line", length, frequency } or null',
  ],
};

/** Returns a state rounded as in a link; throws a message of one line about its fault. */
export function checked(state: State, catalogue: Catalogue): State {
  check(state, catalogue);
  // A link cannot contain a user's own array.
  return { ...readLink(writeLink({ ...state, array: initial.array })), array: state.array };
}

/** Throws a message of one line if a state has a fault other than a number beyond its limits. */
export function check(state: State, catalogue: Catalogue): void {
  const fault = faultOf(state, catalogue);
  if (fault) throw new Error(fault);
}

/** Returns the fault of a state as a message of one line, or "". */
function faultOf(state: State, { presets, solvers }: Catalogue): string {
  const quoted = (value: unknown) => (JSON.stringify(value) ?? String(value)).slice(0, 60);
  const unknown = Object.keys(state).find((key) => !(key in RULES));
  if (unknown) return `${unknown} is no part of the state: give some of ${Object.keys(RULES).join(", ")}`;
  for (const [key, [form, cure]] of Object.entries(RULES)) {
    const value = state[key as keyof State];
    if (!matches(form, value)) return `${key} is ${quoted(value)}: ${cure}`;
  }
  const { array, methods, points, pressures, signature } = state;
  if (!points.length) return "points is []: give at least one";
  if ("preset" in array) {
    const preset = presets.find(({ name }) => name === array.preset);
    if (!preset) return `array is ${quoted(array.preset)}: give one of ${presets.map(({ name }) => name).join(", ")}`;
    if (!preset.tiles && array.tiles.join() !== "1,1") return `tiles is ${quoted(array.tiles)}: ${preset.name} has no boards to be tiled`;
  } else if (!array.positions.length || array.positions.length !== array.normals.length) {
    return `normals has ${array.normals.length} entries: give one for each of ${array.positions.length} positions`;
  }
  const method = methods.find((name) => !solvers.some((solver) => solver.name === name));
  if (method !== undefined) return `methods has ${quoted(method)}: give two of ${solvers.map(({ name }) => name).join(", ")}`;
  if (!isSignature(signature)) return `signature is ${quoted(signature)}: ${RULES.signature[1]}`;
  if (!fits(signature, points.length)) return `signature is ${quoted(signature)}: give one name, or one for each of ${points.length} points`;
  if (pressures && pressures.length !== points.length) {
    return `pressures has ${pressures.length} entries: give one for each of ${points.length} points, or null`;
  }
  return pressures?.every((each) => each === 0) ? "pressures is 0 at every point: give one above 0, or null" : "";
}
