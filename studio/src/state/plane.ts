/** Plane: the slice of a state, normal to a coordinate axis, and the three slices that cross in its middle. */

import { AXES, type Axis, type State, type Vec3 } from "./types.ts";

type Plane = State["plane"];

/** For each normal, the numbers of three axes: the one to the right on the slice, the one up, and the normal. */
export const SIDES: Record<Axis, [number, number, number]> = { x: [1, 2, 0], y: [0, 2, 1], z: [0, 1, 2] };

/** Returns the middle of a slice, m. */
export const middleOf = ({ center, z }: Plane): Vec3 => [...center, z];

/** Returns the slice with another middle. */
export const through = (plane: Plane, [x, y, z]: Vec3): Plane => ({ ...plane, center: [x, y], z });

/** Returns the slice moved along its normal to a place. */
export function following(plane: Plane, place: Vec3): Plane {
  const normal = SIDES[plane.axis][2];
  return through(plane, middleOf(plane).with(normal, place[normal]) as Vec3);
}

/**
 * Returns where a place is on the slice: right and up of its lower left corner, in sides of the slice; and its distance from
 * the slice, m.
 */
export function onPlane(plane: Plane, place: Vec3): [number, number, number] {
  const [right, up, off] = SIDES[plane.axis].map((axis) => place[axis] - middleOf(plane)[axis]);
  return [0.5 + right / plane.size, 0.5 + up / plane.size, off];
}

/** Returns the place (m) that is `right` and `up` away from the slice's lower left corner, in sides of the slice. */
export function placeOn(plane: Plane, right: number, up: number): Vec3 {
  const place = middleOf(plane);
  place[SIDES[plane.axis][0]] += (right - 0.5) * plane.size;
  place[SIDES[plane.axis][1]] += (up - 0.5) * plane.size;
  return place;
}

/** Returns the slices that the 3-D view shows, the state's own slice first. */
export const planesOf = ({ plane, view }: State): Plane[] => [
  plane,
  ...(view === "planes" ? AXES.filter((axis) => axis !== plane.axis).map((axis) => ({ ...plane, axis })) : []),
];
