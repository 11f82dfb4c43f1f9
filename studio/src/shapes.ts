/** Shapes: evenly spaced points along lines, circles and contours, by the rules of python/midair/shape. */

import { MOST_POINTS } from "./initial.ts";
import type { Vec3 } from "./types.ts";

/** A quarter of the wavelength at 40 kHz and 340 m/s, in m. */
export const STEP = 2.125e-3;

/** Vertices of straight lines in m; it closes where the last is the first. */
export type Contour = Vec3[];

/** More steps than these are a slip of a unit, or a drawing that is too fine. */
const MOST_STEPS = 20_000;
/** Rounding never decides whether two points are half a step apart. */
const ROUNDING = 1e-9;

/** Points at equal steps on each contour, as near to `step` (m) as can be, none nearer than half a step. */
export function along(contours: Contour[], step: number): Vec3[] {
  const total = contours.reduce((sum, contour) => sum + ways(contour).at(-1)!, 0);
  if (!(total / step <= MOST_STEPS)) {
    throw new Error(`step is ${step} m: ${total.toPrecision(3)} m of contours would be too many points`);
  }
  return spaced(contours.flatMap((contour) => even(contour, step)), step);
}

/** The points in their order, without those nearer than half a step (m) to one before them. */
export function spaced(points: Vec3[], step: number): Vec3[] {
  const least = (step / 2) * (1 - ROUNDING);
  const kept: Vec3[] = [];
  for (const at of points) {
    if (kept.every((other) => distance(at, other) >= least)) kept.push(at);
  }
  return kept;
}

/** How many equal steps, as near to `step` as can be, make up a length, both in m. */
export function count(length: number, step: number): number {
  return Math.max(Math.round(length / step), 1);
}

/** Points from one place to another, both included; m. */
export function line(from: Vec3, to: Vec3, step = STEP): Vec3[] {
  return along([[from, to]], step);
}

/** Points of a horizontal circle, counterclockwise from +x; m. */
export function circle(center: Vec3, radius: number, step = STEP): Vec3[] {
  const steps = count(2 * Math.PI * radius, step);
  const [x, y, z] = center;
  const points = Array.from({ length: steps }, (_, k): Vec3 => {
    const angle = (2 * Math.PI * k) / steps;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle), z];
  });
  return spaced(points, step);
}

/** The points of `make` at the least step from `STEP` on, to 2 %, at which they are at most so many. */
export function fitting(make: (step: number) => Vec3[], most = MOST_POINTS): Vec3[] {
  let step = STEP;
  let points = make(step);
  while (points.length > most) {
    step *= Math.max(1.02, Math.min(points.length / most / 1.2, 4));
    points = make(step);
  }
  return points;
}

/** The contours with the middle of their box moved to (0, 0). */
export function centred(contours: Contour[]): Contour[] {
  const middle = [0, 1].map((axis) => {
    const every = contours.flat().map((at) => at[axis]);
    return (every.reduce((a, b) => Math.min(a, b)) + every.reduce((a, b) => Math.max(a, b))) / 2;
  });
  return contours.map((contour) => contour.map(([x, y, z]) => [x - middle[0], y - middle[1], z]));
}

function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The way along a contour to each of its vertices. */
function ways(contour: Contour): number[] {
  const found = [0];
  for (let k = 1; k < contour.length; k += 1) found.push(found[k - 1] + distance(contour[k - 1], contour[k]));
  return found;
}

function even(contour: Contour, step: number): Vec3[] {
  const way = ways(contour);
  const length = way.at(-1)!;
  if (length === 0) return contour.slice(0, 1);
  const steps = count(length, step);
  // The end of a contour that closes is its beginning.
  const closed = distance(contour[0], contour.at(-1)!) < ROUNDING * length;
  let segment = 1;
  return Array.from({ length: closed ? steps : steps + 1 }, (_, k) => {
    const at = (length * k) / steps;
    while (segment < contour.length - 1 && way[segment] < at) segment += 1;
    const part = Math.min((at - way[segment - 1]) / (way[segment] - way[segment - 1] || 1), 1);
    const [from, to] = [contour[segment - 1], contour[segment]];
    return from.map((x, axis) => x + part * (to[axis] - x)) as Vec3;
  });
}
