/** Link: a state as the fragment of an address, which people can read and change. */

// `#v=1&a=autd3.2x2&l=board&t=25&m=uniform.naive&p=0,0,180_55,0,180&z=180,180&w=both`: mm, Pa and
// degrees C; ~ marks a pressure that the page filled in. Parts that are left out have their values in `initial`.
//
// | key | meaning | key | meaning |
// |---|---|---|---|
// | `v` | 1 | `z` | slice: height,size or height,size,x,y of its middle |
// | `a` | preset, preset.2x2 boards, or places | `f` | signature: trap, twin, vortex, or trap.focus |
// | `l` | phases and amplitudes: board, none | `o` | wall,x,y,z,nx,ny,nz,rigid_ball,x,y,z,radius,soft |
// | `t` | temperature, or temperature,Np/m,kg/m^3 of the air | `e` | ear: x,y,z |
// | `m` | methods A.B | `g` | path: circle,radius,Hz or line,length,Hz |
// | `p` | points: x,y,z or x,y,z,Pa | `w`, `s`, `k` | view, slot (a, b), scale |
// | `d` | quantity: modulus, wave, phase, felt, push, skin | `n` | normal of the slice: x, y, z |
// | `h` | level of the page: play, compare, engineer | `x` | options of methods as JSON |
// | `b` | bead: radius,kg/m^3,m/s, then gravity in m/s^2: x,y,z | | |
//
// The places of an array are x,y,z_x,y,z of at most 16 transducers that face up. A link cannot contain another array of one's
// own, or one with a mask and the like: such a link has `a=own`, which is rejected when read.

import keys from "../../../python/midair/_studio/keys.json";
import { initial, MOST_POINTS } from "./initial.ts";
import { isSignature } from "./signature.ts";
import { AXES, LEVELS, QUANTITIES, SCALES, VIEWS } from "./types.ts";
import type { Obstacle, State, Vec3 } from "./types.ts";
import { notice, Refusal } from "./notice.ts";

const QUANTIZATIONS = ["board", "none"] as const;
const SLOTS = ["a", "b"] as const;
const KINDS = ["rigid", "soft"] as const;
const PATHS = ["circle", "line"] as const;

const MOST_BOARDS = 8;
const MOST_OBSTACLES = keys.obstacles[0] as number;
/** Largest length in mm, and largest pressure in Pa. */
const FARTHEST = 10_000;
const LOUDEST = 1e6;

const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

function wrong(item: string, value: string, cure: string): never {
  const shown = value.length > 40 ? `${value.slice(0, 40)}...` : value;
  throw new Error(`${item} is "${shown.replace(/\s/g, " ")}": ${cure}`);
}

function word<T extends string>(item: string, text: string, words: readonly T[]): T {
  return words.find((each) => each === text) ?? wrong(item, text, `give ${words.join(", ")}`);
}

function number(item: string, text: string, least: number, most: number): number {
  const value = DECIMAL.test(text) ? Number(text) : NaN;
  if (value >= least && value <= most) return value + 0;
  return wrong(item, text, `give a number from ${least} to ${most}`);
}

/** Reads a length in mm and returns it in m, rounded to 1 nm. */
function metres(item: string, text: string, least = -FARTHEST): number {
  return Math.round(number(item, text, least, FARTHEST) * 1e6) / 1e9 + 0;
}

function place(item: string, cells: string[]): Vec3 {
  return [metres(item, cells[0]), metres(item, cells[1]), metres(item, cells[2])];
}

/** Splits a value into its cells; throws if their number is not one of `counts`. */
function cells(item: string, text: string, counts: number[], form: string): string[] {
  const parts = text.split(",");
  return counts.includes(parts.length) ? parts : wrong(item, text, `give ${form}`);
}

function readArray(text: string): State["array"] {
  if (text === "own") wrong("a", text, "an array of one's own is in no link, load its file");
  if (/^[-\d.]+,/.test(text)) {
    const positions = text.split("_").map((row) => place("a", cells("a", row, [3], "x,y,z of each transducer in mm")));
    return { name: "array", positions, normals: positions.map((): Vec3 => [0, 0, 1]) };
  }
  const match = /^([a-z][a-z0-9_]{0,39})(?:\.(\d+)x(\d+))?$/.exec(text);
  if (!match) return wrong("a", text, "give a preset such as autd3.2x2 or sonicsurface");
  const boards = (count = "1") => number("boards of a", count, 1, MOST_BOARDS);
  return { preset: match[1], tiles: [boards(match[2]), boards(match[3])] };
}

function readMethods(text: string): [string, string] {
  const match = /^([a-z][a-z0-9_]{0,19})\.([a-z][a-z0-9_]{0,19})$/.exec(text);
  return match ? [match[1], match[2]] : wrong("m", text, "give two methods such as uniform.naive");
}

function readPoints(text: string): Pick<State, "points" | "pressures" | "filled"> {
  const rows = text === "" ? [] : text.split("_");
  if (rows.length > MOST_POINTS) wrong("p", `${rows.length} points`, `give at most ${MOST_POINTS}`);
  const items = rows.map((row, k) => ({ item: `point ${k + 1}`, row }));
  const parts = items.map(({ item, row }) => cells(item, row, [3, 4], "x,y,z in mm or x,y,z,pressure in Pa"));
  const loud = parts.filter((part) => part.length === 4).length;
  if (loud > 0 && loud < parts.length) wrong("p", `${loud} pressures`, "give one to every point or to none");
  const points = parts.map((part, k) => place(items[k].item, part));
  const pressure = (part: string[], k: number) => number(`pressure of ${items[k].item}`, part[3].replace(/^~/, ""), 0, LOUDEST);
  const filled = parts.flatMap((part, k) => (part[3]?.startsWith("~") ? [k] : []));
  return { points, pressures: loud > 0 ? parts.map(pressure) : null, filled };
}

function readPlane(text: string): State["plane"] {
  const parts = cells("z", text, [2, 4], "height,size or height,size,x,y in mm");
  const [x, y] = parts.length === 4 ? [metres("z", parts[2]), metres("z", parts[3])] : [0, 0];
  return { axis: "z", z: metres("z", parts[0]), size: metres("size of z", parts[1], 1), center: [x, y] };
}

function readObstacle(text: string, index: number): Obstacle {
  const item = `obstacle ${index + 1}`;
  const parts = text.split(",");
  const kind = () => word(`kind of ${item}`, parts[parts.length - 1], KINDS);
  if (parts[0] === "wall" && parts.length === 8) {
    const normal = parts.slice(4, 7).map((cell) => number(`normal of ${item}`, cell, -1e6, 1e6)) as Vec3;
    if (Math.hypot(...normal) === 0) wrong(`normal of ${item}`, "0,0,0", "give a direction such as 0,0,1");
    return { point: place(item, parts.slice(1)), normal, kind: kind() };
  }
  if (parts[0] === "ball" && parts.length === 6) {
    const radius = metres(`radius of ${item}`, parts[4], 0.1);
    return { center: place(item, parts.slice(1)), radius, kind: kind() };
  }
  return wrong(item, text, "give wall,x,y,z,nx,ny,nz,rigid or ball,x,y,z,radius,rigid");
}

function readObstacles(text: string): Obstacle[] {
  const rows = text.split("_");
  if (rows.length > MOST_OBSTACLES) wrong("o", `${rows.length} obstacles`, `give at most ${MOST_OBSTACLES}`);
  return rows.map(readObstacle);
}

function readPath(text: string): State["path"] {
  const parts = cells("g", text, [3], "circle,radius,frequency or line,length,frequency in mm and Hz");
  const kind = word("g", parts[0], PATHS);
  const size = metres("size of g", parts[1], 0.01);
  const frequency = number("frequency of g", parts[2], 1e-3, 1000);
  return kind === "circle" ? { kind, radius: size, frequency } : { kind, length: size, frequency };
}

function readAir(text: string): Partial<State> {
  const [temperature, ...rest] = cells("t", text, [1, 3], "temperature or temperature,absorption,density");
  const air = { temperature: number("t", temperature, -60, 60) };
  if (!rest.length) return air;
  const [absorption, density] = rest;
  return {
    ...air,
    absorption: absorption === "" ? null : number("absorption of t", absorption, 0, 1e3),
    density: density === "" ? null : number("density of t", density, 1e-3, 1e3),
  };
}

function readBead(text: string): State["bead"] {
  const [radius, density, speed, ...gravity] = cells("b", text, [6], "radius,density,sound speed,x,y,z of gravity");
  return {
    radius: metres("radius of b", radius, 1e-3),
    density: number("density of b", density, 0, 1e6),
    sound_speed: number("sound speed of b", speed, 0, 1e6),
    gravity: gravity.map((cell) => number("gravity of b", cell, -1e6, 1e6)) as Vec3,
  };
}

function readOptions(text: string): State["options"] {
  try {
    const options = JSON.parse(text);
    if ([options, ...Object.values(options)].every((each) => Object.getPrototypeOf(each) === Object.prototype)) return options;
  } catch {
    // The message below has the text.
  }
  return wrong("x", text, 'give JSON such as {"greedy":{"seed":3}}');
}

/** Returns a length in m as mm, to 0.001. */
function mm(length: number): string {
  return String(Math.round(length * 1e6) / 1000 + 0);
}

function writeArray({ array }: State): string {
  const long = "positions" in array && (array.positions.length > 16 || array.normals.some(([, , z]) => z !== 1));
  return long || array.parts ? "own" : "preset" in array ? `${array.preset}.${array.tiles.join("x")}` : array.positions.map((at) => at.map(mm).join()).join("_");
}

function writePoints({ points, pressures, filled }: State): string {
  const pressure = (k: number) => (pressures ? [`${filled.includes(k) ? "~" : ""}${pressures[k]}`] : []);
  return points.map((at, k) => [...at.map(mm), ...pressure(k)].join()).join("_");
}

function writePlane({ z, size, center }: State["plane"]): string {
  const middle = center.map(mm);
  return [mm(z), mm(size), ...(middle.some((x) => x !== "0") ? middle : [])].join();
}

function writeObstacle(each: Obstacle): string {
  return "radius" in each
    ? `ball,${each.center.map(mm)},${mm(each.radius)},${each.kind}`
    : `wall,${each.point.map(mm)},${each.normal},${each.kind}`;
}

function readSignature(text: string): Partial<State> {
  if (text && isSignature(text)) return { signature: text };
  return wrong("f", text, "give trap, twin, vortex, or one of these or focus for each point, such as trap.focus");
}

type Part = [read: (text: string, state: State) => Partial<State>, write: (state: State) => string | null];

/** Returns a part that is one of some words; it is left out of a link if the state's word is `usual`. */
function choice<K extends "quantization" | "level" | "view" | "quantity" | "scale">(key: string, name: K, words: readonly State[K][], usual?: State[K]): Part {
  return [(text) => ({ [name]: word(key, text, words) }), (state) => (state[name] === usual ? null : state[name])];
}

/** The parts of a link by their keys, in the order in which they are written. */
const PARTS: Record<string, Part> = {
  v: [(text) => (text === "1" ? {} : wrong("v", text, "this page reads v=1")), () => "1"],
  a: [(text) => ({ array: readArray(text) }), writeArray],
  l: choice("l", "quantization", QUANTIZATIONS),
  t: [readAir, ({ temperature, absorption, density }) => [temperature, ...(absorption === null && density === null ? [] : [absorption, density])].join()],
  m: [(text) => ({ methods: readMethods(text) }), ({ methods }) => methods.join(".")],
  p: [readPoints, writePoints],
  z: [(text, { plane: { axis } }) => ({ plane: { ...readPlane(text), axis } }), ({ plane }) => writePlane(plane)],
  n: [(text, { plane }) => ({ plane: { ...plane, axis: word("n", text, AXES) } }), ({ plane: { axis } }) => (axis === "z" ? null : axis)],
  h: choice("h", "level", LEVELS, initial.level),
  w: choice("w", "view", VIEWS),
  d: choice("d", "quantity", QUANTITIES, initial.quantity),
  // Old links have colour maps of |p| here, which are ignored.
  c: [(text) => (word("c", text, ["viridis", "cividis", "magma"]), {}), () => null],
  k: choice("k", "scale", SCALES, initial.scale),
  s: [(text) => ({ slot: word("s", text, SLOTS) === "a" ? 0 : 1 }), ({ slot }) => (slot === 0 ? null : "b")],
  f: [readSignature, ({ signature }) => signature || null],
  o: [(text) => ({ obstacles: readObstacles(text) }), ({ obstacles }) => obstacles.map(writeObstacle).join("_") || null],
  e: [(text) => ({ ear: place("e", cells("e", text, [3], "x,y,z in mm")) }), ({ ear }) => ear && ear.map(mm).join()],
  g: [(text) => ({ path: readPath(text) }), ({ path }) => path && [path.kind, mm(path.kind === "circle" ? path.radius : path.length), path.frequency].join()],
  b: [(text) => ({ bead: readBead(text) }), ({ bead }) => bead && [mm(bead.radius), bead.density, bead.sound_speed, ...bead.gravity].join()],
  x: [(text) => ({ options: readOptions(text) }), ({ options }) => (Object.keys(options).length ? JSON.stringify(options) : null)],
};

function read(fragment: string): State {
  const text = fragment.replace(/^#/, "");
  const state = structuredClone(initial);
  const seen = new Set<string>();
  for (const part of text === "" ? [] : text.split("&")) {
    const [, key, value] = /^([^=]*)=(.*)$/s.exec(part) ?? wrong("the link's part", part, "give key=value");
    if (!Object.hasOwn(PARTS, key)) wrong("a key", key, `give one of ${Object.keys(PARTS).join(" ")}`);
    if (seen.has(key)) wrong(key, value, "give it once");
    seen.add(key);
    Object.assign(state, PARTS[key][0](value, state));
  }
  if (text !== "" && !seen.has("v")) wrong("the link", text, "begin with v=1");
  return state;
}

/** Returns the state of a fragment (with or without #); throws a message of one line about its fault. */
export function readLink(fragment: string): State {
  try {
    return read(decodeURIComponent(fragment));
  } catch (error) {
    throw error instanceof URIError ? new Refusal(notice("link-broken")) : error;
  }
}

/** Returns the fragment (without #) of a state, with lengths to 0.001 mm. */
export function writeLink(state: State): string {
  const written = Object.entries(PARTS).map(([key, [, write]]) => [key, write(state)]);
  return written.flatMap(([key, value]) => (value === null ? [] : [`${key}=${value}`])).join("&");
}
