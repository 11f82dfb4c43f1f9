/** Contours: polylines, scaled and moved. The core makes points along them. */

import type { Vec3 } from "../state/types.ts";

/** The vertices of a polyline, in any unit before `placed` and in m after; it is closed if the last is the first. */
export type Contour = Vec3[];

/** Returns the least and the largest x, and the least and the largest y. */
export function box(contours: Contour[]): [number, number][] {
  const most = (axis: number, sign: number) => sign * contours.flat().reduce((a, at) => Math.max(a, sign * at[axis]), -Infinity);
  return [0, 1].map((axis) => [most(axis, -1), most(axis, 1)]);
}

/** Returns the contours in m, scaled along x and y, in the horizontal plane at a place, with the middle of their box there. */
export function placed(contours: Contour[], scale: [number, number], at: Vec3): Contour[] {
  const middle = box(contours).map(([least, most]) => (least + most) / 2);
  const moved = (vertex: Vec3, axis: number) => (vertex[axis] - middle[axis]) * scale[axis] + at[axis];
  return contours.map((contour) => contour.map((vertex): Vec3 => [moved(vertex, 0), moved(vertex, 1), at[2]]));
}
