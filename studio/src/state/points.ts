/** Points: the changes of a state when points are moved, added or removed, with their targets. */

import { signatureOf } from "./signature.ts";
import type { State, Vec3 } from "./types.ts";

/** Rounds a point to 1 um and limits it to 10 m, as links do. */
const rounded = (point: Vec3) => point.map((x) => Math.round(Math.min(Math.max(x, -10), 10) * 1e6) / 1e6) as Vec3;

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
