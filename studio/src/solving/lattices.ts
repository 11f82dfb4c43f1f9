/** Lattices: the sample points of slices and of the volume, dense enough for the wavelength. */

import type { Grid } from "./solve.worker.ts";
import { soundSpeed } from "../state/air.ts";
import { placeOn, SIDES } from "../state/plane.ts";
import type { State, Vec3, Volume } from "../state/types.ts";

/** The frequency of all presets, 40 kHz. */
export const FREQUENCY = 40e3;

/** Samples per wavelength: interpolation of p between them has errors of up to 0.3 % of the peak. */
const FINE = 5.5;

/** The largest number of samples along a side of a slice. */
const MOST = 320;

/** Samples along a volume's longest side. */
const VOLUME = 48;

/** Returns the wavelength in m. */
export const wavelength = (state: State) => soundSpeed(state.temperature) / FREQUENCY;

/** Returns a slice's lattice, with at most this many samples along a side. */
export function gridOf(state: State, most = MOST, plane = state.plane): Grid {
  const { size } = plane;
  const [right, up] = SIDES[plane.axis];
  const count = Math.min(most, Math.ceil((size * FINE) / wavelength(state)) + 1);
  const n = Math.max(count, 8);
  return {
    corner: placeOn(plane, 0, 0),
    u: [0, 0, 0].with(right, size) as Vec3,
    v: [0, 0, 0].with(up, size) as Vec3,
    nu: n,
    nv: n,
  };
}

/**
 * Returns the box of the volume: as wide as the slice, from 5 wavelengths below the points to 5 above them, and not below the
 * transducers (or beyond them, if boards face each other).
 */
export function boxOf(state: State, array: Float64Array): Omit<Volume, "moduli"> {
  const { size, center } = state.plane;
  const heights = state.points.map((point) => point[2]);
  const margin = 5 * wavelength(state);
  const top = Math.max(...heights) + margin;
  const bottom = Math.min(...heights) - margin;
  const [low, high] = gap(array);
  const least: Vec3 = [center[0] - size / 2, center[1] - size / 2, Math.max(bottom, low)];
  const most: Vec3 = [center[0] + size / 2, center[1] + size / 2, Math.max(Math.min(top, high), least[2] + margin)];
  const longest = Math.max(size, most[2] - least[2]);
  const count = ([0, 1, 2] as const).map((axis) =>
    Math.max(2, Math.round(((most[axis] - least[axis]) / longest) * VOLUME)),
  ) as [number, number, number];
  return { least, most, count };
}

/** Returns the range of heights without transducers, if they lie in one plane or two. */
function gap(array: Float64Array): [number, number] {
  const heights = [];
  for (let i = 2; i < array.length / 2; i += 3) heights.push(array[i]);
  const most = heights.reduce((a, b) => Math.max(a, b), -Infinity);
  const least = heights.reduce((a, b) => Math.min(a, b), Infinity);
  return most - least > 0.1 ? [least + 0.01, most - 0.01] : [most + 0.01, Infinity];
}
