/** Plane: the slice of a state, normal to an axis of space, and the three that cross in its middle. */

import { AXES, type Axis, type State, type Vec3 } from "./types.ts";

type Plane = State["plane"];

/** The axes by number: those that lead right and up along a slice, and its normal. */
export const SIDES: Record<Axis, [number, number, number]> = { x: [1, 2, 0], y: [0, 2, 1], z: [0, 1, 2] };

/** Its middle, m. */
export const middleOf = ({ center, z }: Plane): Vec3 => [...center, z];

/** The slice with its middle elsewhere. */
export const through = (plane: Plane, [x, y, z]: Vec3): Plane => ({ ...plane, center: [x, y], z });

/** The slice, taken along its normal to where a place is. */
export function following(plane: Plane, place: Vec3): Plane {
  const normal = SIDES[plane.axis][2];
  return through(plane, middleOf(plane).with(normal, place[normal]) as Vec3);
}

/** Where a place is seen from straight ahead: right and up of the left lower corner, in sides, and how far off the slice, m. */
export function onPlane(plane: Plane, place: Vec3): [number, number, number] {
  const [right, up, off] = SIDES[plane.axis].map((axis) => place[axis] - middleOf(plane)[axis]);
  return [0.5 + right / plane.size, 0.5 + up / plane.size, off];
}

/** The place (m) that is seen this many sides right and up of the left lower corner. */
export function placeOn(plane: Plane, right: number, up: number): Vec3 {
  const place = middleOf(plane);
  place[SIDES[plane.axis][0]] += (right - 0.5) * plane.size;
  place[SIDES[plane.axis][1]] += (up - 0.5) * plane.size;
  return place;
}

/** The slices that the 3-D view shows, that of the plane first. */
export const planesOf = ({ plane, view }: State): Plane[] => [
  plane,
  ...(view === "planes" ? AXES.filter((axis) => axis !== plane.axis).map((axis) => ({ ...plane, axis })) : []),
];
