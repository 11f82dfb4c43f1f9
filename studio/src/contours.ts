/** Contours: straight lines from vertex to vertex, brought to their place; the core makes points along them. */

import type { Vec3 } from "./types.ts";

/** Vertices in any unit, then in m; it closes where the last is the first. */
export type Contour = Vec3[];

/** The least and the largest x and y. */
export function box(contours: Contour[]): [number, number][] {
  const most = (axis: number, sign: number) => sign * contours.flat().reduce((a, at) => Math.max(a, sign * at[axis]), -Infinity);
  return [0, 1].map((axis) => [most(axis, -1), most(axis, 1)]);
}

/** The contours scaled along x and y, the middle of their box at a place, all in its plane; m. */
export function placed(contours: Contour[], scale: [number, number], at: Vec3): Contour[] {
  const middle = box(contours).map(([least, most]) => (least + most) / 2);
  const moved = (vertex: Vec3, axis: number) => (vertex[axis] - middle[axis]) * scale[axis] + at[axis];
  return contours.map((contour) => contour.map((vertex): Vec3 => [moved(vertex, 0), moved(vertex, 1), at[2]]));
}
