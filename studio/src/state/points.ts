/** Points: the changes of a state when points are moved, added or removed, or the array is another. */

import { first, HEIGHT } from "./initial.ts";
import { signatureOf } from "./signature.ts";
import type { State, Vec3 } from "./types.ts";

/** Rounds a length to 1 um and limits it to 10 m, as links do. */
const micro = (x: number) => Math.round(Math.min(Math.max(x, -10), 10) * 1e6) / 1e6 + 0;
const rounded = (point: Vec3) => point.map(micro) as Vec3;

/** Returns the change that moves a point. */
export function moved(state: State, index: number, to: Vec3): Partial<State> {
  return { points: state.points.map((point, k) => (k === index ? rounded(to) : point)) };
}

/** Returns the change that shifts some points. */
export function shifted(state: State, which: number[], from: Vec3[], way: Vec3): Partial<State> {
  return { points: state.points.map((point, k) => (which.includes(k) ? rounded(from[k].map((x, axis) => x + way[axis]) as Vec3) : point)) };
}

/** Returns the change that adds a point, with the target of the last one. */
export function added(state: State, place: Vec3): Partial<State> {
  const { points, pressures, filled } = state;
  return {
    points: [...points, rounded(place)],
    signature: signatureOf(state, [...points.keys()], 1),
    ...(pressures && { pressures: [...pressures, pressures.at(-1) || loudest(pressures)], filled: [...filled, points.length] }),
  };
}

/** Returns the change that removes some points; at least one must stay. */
export function removed(state: State, ...which: number[]): Partial<State> {
  const left = state.points.map((_, k) => k).filter((k) => !which.includes(k));
  if (!left.length) return {};
  const points = left.map((k) => state.points[k]);
  const filled = left.flatMap((k, now) => (state.filled.includes(k) ? [now] : []));
  const pressures = state.pressures && left.map((k) => state.pressures![k]);
  const signature = signatureOf(state, left);
  return { points, signature, ...(pressures?.some((pressure) => pressure > 0) && filled.length < left.length ? { pressures, filled } : { pressures: null }) };
}

/**
 * Returns the change of one target, in Pa; all others keep theirs. With null, the page fills this target in if others are
 * given.
 */
export function withTarget(state: State, index: number, pressure: number | null, balanced: number[]): Partial<State> {
  const all = state.points.map((_, k) => k);
  const before = state.pressures ? state.filled : all;
  const filled = pressure === null ? [...new Set([...before, index])].toSorted((a, b) => a - b) : before.filter((k) => k !== index);
  if (filled.length === all.length) return { pressures: null };
  const targets = state.pressures ?? all.map((k) => Math.round(balanced[k] ?? 1000));
  const pressures = pressure === null ? targets : targets.with(index, pressure);
  return pressures.some((each) => each > 0) ? { pressures, filled } : {};
}

const loudest = (pressures: number[]) => Math.max(...pressures);

/** The room of an array, in m: its middle, its narrower side, its height, and whether its boards face each other. */
export type Room = { middle: Vec3; side: number; high: number; faces: boolean };

/** Returns the room of an array from its positions (N, 3) in m. */
export function roomOf(positions: ArrayLike<number>): Room {
  const along = (axis: number, of: (a: number, b: number) => number) => Array.from(positions).filter((_, k) => k % 3 === axis).reduce((a, b) => of(a, b));
  const ends = [0, 1, 2].map((axis) => [along(axis, Math.min), along(axis, Math.max)]);
  const [wide, deep, high] = ends.map(([least, most]) => most - least);
  return { middle: ends.map(([least, most]) => (least + most) / 2) as Vec3, side: Math.min(wide, deep), high, faces: high > 0.08 };
}

/** An array below this width, in m, has only one point in its own scene. */
const NARROW = 0.12;

/** Returns the scene that an array brings: traps between boards that face each other, one focus or three above others. */
export function broughtBy({ middle: [x, y, z], side, high, faces }: Room): Partial<State> {
  const scene = (points: Vec3[], z: number, size: number, quantity: State["quantity"], signature = ""): Partial<State> => {
    const plane: State["plane"] = { axis: "y", z: micro(z), size: micro(size), center: [x, y] };
    return { points: points.map((point) => rounded([point[0] + x, point[1] + y, point[2]])), plane, quantity, signature, pressures: null, path: null, view: "slice" };
  };
  if (faces) return scene(side < NARROW ? [[0, 0, z]] : [[-0.02, 0, z], [0.02, 0, z]], z, 0.85 * high, "modulus", "trap");
  if (side < NARROW) return scene([[0, 0, 0.6 * side]], 0.6 * side, 1.2 * side, "wave");
  return scene(first.points, first.plane.z, first.plane.size, first.quantity);
}

/** Returns points and slice moved, and made smaller if that is necessary, from the room of one array to that of another. */
export function reached({ points, plane }: State, from: Room, to: Room): Pick<State, "points" | "plane"> {
  const height = points.reduce((sum, point) => sum + point[2], 0) / points.length;
  const [far, near] = [0.4 * to.side, Math.min(HEIGHT, 1.2 * to.side)];
  const target = to.faces ? to.middle[2] : from.faces || height > 1.5 * to.side ? near : height;
  const wide = Math.max(...points.map(([x, y]) => Math.max(Math.abs(x - from.middle[0]), Math.abs(y - from.middle[1]))));
  const part = Math.min(1, far / Math.max(wide, 1e-9));
  const placed = (place: Vec3) => rounded(place.map((x, axis) => (axis < 2 ? to.middle[axis] + part * (x - from.middle[axis]) : target + part * (x - height))) as Vec3);
  const [x, y, z] = placed([...plane.center, plane.z]);
  return { points: points.map(placed), plane: { ...plane, center: [x, y], z, size: micro(part * plane.size) } };
}
