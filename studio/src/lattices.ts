/** Where the field is computed: a slice's lattice and the volume's box, fine enough for the wave. */

import type { Grid } from "./solve.worker.ts";
import { placeOn, SIDES } from "./plane.ts";
import type { State, Vec3, Volume } from "./types.ts";

/** 40 kHz, as all presets. */
export const FREQUENCY = 40e3;

/** Places a wavelength: fine enough that p between them is found to .3 % of the peak. */
const FINE = 5.5;

/** The most places along a side of a slice. */
const MOST = 320;

/** Places along a volume's longest side. */
const VOLUME = 48;

/** Speed of sound in m/s at a temperature in degrees C. */
export const soundSpeed = (temperature: number) => 331.3 * Math.sqrt(1 + temperature / 273.15);

/** Wavelength in m. */
export const wavelength = (state: State) => soundSpeed(state.temperature) / FREQUENCY;

/** A slice's lattice, of at most this many places along a side. */
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

/** The box around the points, a few wavelengths wide on each side, above (or between) the transducers. */
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

/** Heights between which no transducer is, if they lie in one or two planes. */
function gap(array: Float64Array): [number, number] {
  const heights = [];
  for (let i = 2; i < array.length / 2; i += 3) heights.push(array[i]);
  const most = heights.reduce((a, b) => Math.max(a, b), -Infinity);
  const least = heights.reduce((a, b) => Math.min(a, b), Infinity);
  return most - least > 0.1 ? [least + 0.01, most - 0.01] : [most + 0.01, Infinity];
}
