import { expect, test } from "vitest";
import { initial } from "../src/state/initial.ts";
import { gridOf } from "../src/solving/lattices.ts";
import { following, middleOf, onPlane, placeOn, planesOf } from "../src/state/plane.ts";
import { AXES, type State, type Vec3 } from "../src/state/types.ts";

const planes = AXES.map((axis): State["plane"] => ({ axis, z: 0.15, size: 0.2, center: [0.01, -0.02] }));

test.each(planes)("a place on the slice normal to $axis is found again, and its lattice lies there", (plane) => {
  const normal = AXES.indexOf(plane.axis);
  for (const [right, up] of [[0, 0], [1, 0.25], [0.3, 1]]) {
    const place = placeOn(plane, right, up);
    onPlane(plane, place).forEach((x, k) => expect(x).toBeCloseTo([right, up, 0][k], 12));
    expect(place[normal]).toBe(middleOf(plane)[normal]);
  }
  const { corner, u, v } = gridOf({ ...initial, plane });
  expect(corner).toEqual(placeOn(plane, 0, 0));
  corner.map((x, k) => x + u[k] + v[k]).forEach((x, k) => expect(x).toBeCloseTo(placeOn(plane, 1, 1)[k], 12));
  // On an upright slice, z points up.
  if (plane.axis !== "z") expect(v).toEqual([0, 0, plane.size]);
});

test.each(planes)("a slice normal to $axis goes with a point along its normal alone", (plane) => {
  const place: Vec3 = [0.07, 0.08, 0.09];
  const [before, after] = [plane, following(plane, place)].map(middleOf);
  after.forEach((x, k) => expect(x).toBe(k === AXES.indexOf(plane.axis) ? place[k] : before[k]));
});

test("three slices cross in one middle, that of A and B first", () => {
  const state: State = { ...initial, view: "planes", plane: planes[1] };
  expect(planesOf(state).map(({ axis }) => axis)).toEqual(["y", "x", "z"]);
  for (const plane of planesOf(state)) expect(middleOf(plane)).toEqual(middleOf(planes[1]));
  expect(planesOf({ ...state, view: "both" })).toEqual([planes[1]]);
});
