import { expect, test } from "vitest";
import { along, type Camera, fit, Sight, type Spot } from "../src/painter/camera.ts";
import { makeView } from "../src/painter/view.ts";
import type { Vec3 } from "../src/state/types.ts";
import { square } from "./field.ts";

const camera: Camera = { target: [0.01, -0.02, 0.1], yaw: 0.7, pitch: 0.45, distance: 0.6 };
const [width, height] = [780, 820];
const size: Spot = [width, height];
const sight = new Sight(camera, size);
const points: Vec3[] = [
  [0, 0, 0.18],
  [0.09, -0.05, 0.12],
  [-0.08, 0.07, 0.2],
  [-0.05, -0.09, 0.02],
];

test("the target is in the middle, x to the right, z up", () => {
  const [x, y, depth] = sight.project(camera.target);
  for (const rest of [x - width / 2, y - height / 2, depth - camera.distance]) expect(rest).toBeCloseTo(0, 9);
  const level: Camera = { target: [0, 0, 0], yaw: 0, pitch: 0, distance: 1 };
  expect(new Sight(level, size).project([0.1, 0, 0])[0]).toBeGreaterThan(width / 2);
  expect(new Sight(level, size).project([0, 0, 0.1])[1]).toBeLessThan(height / 2);
});

test("the shaders' matrix is the same projection", () => {
  const { matrix } = makeView(camera, { x: 0, y: 0, width, height }, [0, 0, width, height], 1);
  for (const point of points) {
    const clip = [0, 1, 3].map((row) =>
      [...point, 1].reduce((sum, value, column) => sum + matrix[4 * column + row] * value, 0),
    );
    const [x, y, depth] = sight.project(point);
    expect(((clip[0] / clip[2] + 1) / 2) * width).toBeCloseTo(x, 9);
    expect(((1 - clip[1] / clip[2]) / 2) * height).toBeCloseTo(y, 9);
    expect(clip[2]).toBeCloseTo(depth, 12);
  }
});

test("a ray goes through what is seen there", () => {
  for (const point of points) {
    const [x, y, depth] = sight.project(point);
    const { eye, way } = sight.ray([x, y]);
    for (const axis of [0, 1, 2]) expect(eye[axis] + depth * way[axis]).toBeCloseTo(point[axis], 12);
  }
});

test("a dragged point stays under the pointer", () => {
  for (const point of points) {
    const [x, y] = sight.project(point);
    for (const [dx, dy] of [
      [60, 20],
      [-90, 45],
      [3, -110],
    ]) {
      const shift = sight.slide([x, y], [x + dx, y + dy], point);
      expect(shift).not.toBeNull();
      const moved: Vec3 = [point[0] + shift![0], point[1] + shift![1], point[2] + shift![2]];
      expect(moved[2]).toBeCloseTo(point[2], 12);
      const seen = sight.project(moved);
      expect(Math.hypot(seen[0] - x - dx, seen[1] - y - dy)).toBeLessThan(1e-6);

      const dz = sight.lift([x, y], [x + dx, y + dy], point);
      const raised = sight.project([point[0], point[1], point[2] + dz!]);
      expect(Math.abs(raised[1] - y - dy)).toBeLessThan(1e-6);
    }
  }
});

test("so does one that is dragged along an upright slice, or off it", () => {
  for (const [k, point] of points.entries()) {
    const axis = k % 2;
    const [x, y] = sight.project(point);
    const shift = sight.slide([x, y], [x + 30, y - 20], point, axis)!;
    expect(shift[axis]).toBeCloseTo(0, 12);
    const seen = sight.project(along(point, 1, shift));
    expect(Math.hypot(seen[0] - x - 30, seen[1] - y + 20)).toBeLessThan(1e-6);
    // A drag that lifts the point off the slice moves it only along the normal, as near to the pointer as possible.
    const away = sight.lift([x, y], [x + 30, y - 20], point, axis)!;
    const off = sight.project(point.with(axis, point[axis] + away) as Vec3);
    expect((off[0] - x) * 30 + (off[1] - y) * -20).toBeGreaterThan(0);
  }
});

test("a drag that begins beside the point does not jump", () => {
  const [x, y] = sight.project(points[1]);
  expect(sight.slide([x + 9, y - 7], [x + 9, y - 7], points[1])).toEqual([0, 0, 0]);
  expect(sight.lift([x + 9, y - 7], [x + 9, y - 7], points[1])).toBe(0);
});

test("a drag beyond the horizon is none", () => {
  expect(sight.slide([390, 500], [390, -900], [0, 0, 0.1])).toBeNull();
  expect(new Sight({ ...camera, pitch: Math.PI / 2 }, size).lift([390, 410], [390, 300], points[0])).toBeNull();
});

test("fit shows all, wide or narrow", () => {
  const positions = square(20);
  for (const [w, h] of [[780, 820], [390, 700], [3000, 900]] as Spot[]) {
    const fitted = new Sight(fit(positions, points, [w, h]), [w, h]);
    const seen = [...points];
    for (let i = 0; i < positions.length; i += 3) seen.push([positions[i], positions[i + 1], 0]);
    let [left, top] = [w, h];
    for (const place of seen) {
      const [x, y, depth] = fitted.project(place);
      expect(depth).toBeGreaterThan(0);
      left = Math.min(left, x, w - x);
      top = Math.min(top, y, h - y);
    }
    // In the tighter direction 4.5 % of the view stay free, with space for the axes, but not much more.
    expect(Math.min(left / w, top / h)).toBeGreaterThan(0.0449);
    expect(Math.min(left / w, top / h)).toBeLessThan(0.12);
  }
});
