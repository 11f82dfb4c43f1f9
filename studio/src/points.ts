/** Points as they are changed: one moved, one new, one gone, targets kept beside. */

import type { State, Vec3 } from "./types.ts";

/** To 1 um and within 10 m, as links have it. */
const rounded = (point: Vec3) => point.map((x) => Math.round(Math.min(Math.max(x, -10), 10) * 1e6) / 1e6) as Vec3;

/** The state with a point elsewhere. */
export function moved(state: State, index: number, to: Vec3): Partial<State> {
  return { points: state.points.map((point, k) => (k === index ? rounded(to) : point)) };
}

/** With a point more; it asks for what the last one does. */
export function added(state: State, place: Vec3): Partial<State> {
  const { points, pressures } = state;
  return {
    points: [...points, rounded(place)],
    pressures: pressures && [...pressures, pressures.at(-1) || loudest(pressures)],
  };
}

/** With one less; the last one stays. */
export function removed(state: State, index: number): Partial<State> {
  if (state.points.length === 1) return {};
  const others = <T>(list: T[]) => list.filter((_, k) => k !== index);
  const pressures = state.pressures && others(state.pressures);
  return { points: others(state.points), pressures: pressures?.some((pressure) => pressure > 0) ? pressures : null };
}

/** With another target, in Pa; the others are given those that they had by themselves. One without stays as it is, if `others` have. */
export function asked(state: State, index: number, pressure: number | null, balanced: number[], others = false): Partial<State> {
  if (pressure === null) return others ? {} : { pressures: null };
  const own = state.pressures ?? state.points.map((_, k) => Math.round(balanced[k] ?? 1000));
  const pressures = own.map((asked, k) => (k === index ? pressure : asked));
  return pressures.some((each) => each > 0) ? { pressures } : {};
}

const loudest = (pressures: number[]) => Math.max(...pressures);
