/** Paths: the places of moving points, frame by frame. */

import type { Path, Vec3 } from "../state/types.ts";

/** Returns the shift in m of the points from their places at a time in s. */
function offset(path: Path, time: number): Vec3 {
  const angle = 2 * Math.PI * path.frequency * time;
  if (path.kind === "line") return [(path.length / 2) * Math.cos(angle), 0, 0];
  return [path.radius * Math.cos(angle), path.radius * Math.sin(angle), 0];
}

/** Returns the length of a turn in m, of a line that of a circle as fast as its fastest point. */
export const lengthOf = (path: Path) => Math.PI * (path.kind === "circle" ? 2 * path.radius : path.length);

/**
 * Returns the points (M) in each of T = rate * seconds frames: T * M * 3 numbers in m; `rate` in frames per second.
 *
 * All points move alike: counterclockwise around their places from the +x side, or back and forth along x from the +x end.
 */
export function framesOf(points: Vec3[], path: Path, rate: number, seconds: number): Float64Array {
  const frames = Math.round(rate * seconds);
  const places = new Float64Array(frames * points.length * 3);
  let at = 0;
  for (let frame = 0; frame < frames; frame += 1) {
    const moved = offset(path, frame / rate);
    for (const point of points) {
      for (let axis = 0; axis < 3; axis += 1) places[at++] = point[axis] + moved[axis];
    }
  }
  return places;
}
