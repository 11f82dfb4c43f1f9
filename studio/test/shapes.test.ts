import { expect, test } from "vitest";
import { letters } from "../src/lettering.ts";
import { along, circle, fitting, line, STEP } from "../src/shapes.ts";
import type { Vec3 } from "../src/types.ts";

const distance = (a: Vec3, b: Vec3) => Math.hypot(...a.map((x, axis) => x - b[axis]));
const nearest = (points: Vec3[]) =>
  Math.min(...points.flatMap((a, k) => points.slice(0, k).map((b) => distance(a, b))));

test("a line has both ends and equal steps", () => {
  const points = line([-0.03, 0, 0.15], [0.03, 0, 0.15], 0.0021);
  // 60 / 2.1 = 28.6 is nearest to 29 steps.
  expect(points).toHaveLength(30);
  expect(points[0]).toEqual([-0.03, 0, 0.15]);
  expect(points[29]).toEqual([0.03, 0, 0.15]);
  points.slice(1).forEach((at, k) => expect(distance(at, points[k])).toBeCloseTo(0.06 / 29, 12));
});

test("a short line keeps its ends, one of no length is a point", () => {
  expect(line([0, 0, 0], [0.0015, 0, 0])).toHaveLength(2);
  expect(line([0, 0, 0], [0.0015, 0, 0], 0.01)).toHaveLength(1);
  expect(line([0, 0, 1], [0, 0, 1])).toEqual([[0, 0, 1]]);
});

test("a circle begins at +x and turns to +y without a doubled point", () => {
  const points = circle([0.01, 0, 0.15], 0.03);
  expect(points).toHaveLength(Math.round((2 * Math.PI * 0.03) / STEP));
  expect(points[0]).toEqual([0.04, 0, 0.15]);
  expect(points[1][1]).toBeGreaterThan(0);
  expect(nearest(points)).toBeGreaterThan(0.99 * STEP);
});

test("a square closes, and its steps run around corners", () => {
  const square: Vec3[] = [[0, 0, 0], [0.01, 0, 0], [0.01, 0.01, 0], [0, 0.01, 0], [0, 0, 0]];
  const tenths = along([square], 0.005).map((at) => at.map((x) => Math.round(x * 1e4)).slice(0, 2));
  expect(tenths).toEqual([[0, 0], [50, 0], [100, 0], [100, 50], [100, 100], [50, 100], [0, 100], [0, 50]]);
});

test("every letter is drawn, as high as asked, and none of its points are too near", () => {
  for (const letter of "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") {
    const points = letters(letter, 0.03, 0.15, 0.002);
    const up = points.map((at) => at[1]);
    // A step around a corner may miss it by half a step.
    expect(Math.abs(Math.max(...up) - 0.015), letter).toBeLessThan(0.001);
    expect(Math.abs(Math.min(...up) + 0.015), letter).toBeLessThan(0.001);
    expect(nearest(points), letter).toBeGreaterThanOrEqual(0.001 * (1 - 1e-8));
    expect(points.every((at) => at[2] === 0.15)).toBe(true);
  }
});

test("a text is centred, reads from left to right, and says what it has not", () => {
  const points = letters("a i.", 0.03, 0.15);
  const across = points.map((at) => at[0]);
  expect(Math.max(...across) + Math.min(...across)).toBeCloseTo(0, 12);
  expect(points.filter((at) => at[0] > 0.0199)).toHaveLength(1);
  expect(() => letters("あ", 0.03, 0.15)).toThrow('the text has "あ": give A to Z');
  expect(() => letters("  ", 0.03, 0.15)).toThrow("the text is empty");
});

test("a step that makes too many points is widened until they fit", () => {
  const points = fitting((step) => letters("MIDAIR 2026", 0.03, 0.15, step));
  expect(points.length).toBeLessThanOrEqual(64);
  expect(points.length).toBeGreaterThan(50);
  const few = circle([0, 0, 0.1], 0.01);
  expect(fitting((step) => circle([0, 0, 0.1], 0.01, step))).toEqual(few);
  expect(fitting((step) => circle([0, 0, 0.1], 0.01, step), 1)).toHaveLength(1);
});

test("a length that nobody means is refused", () => {
  expect(() => line([0, 0, 0], [1000, 0, 0])).toThrow("step is 0.002125 m: 1.00e+3 m of contours");
  expect(() => line([0, 0, 0], [1, 0, 0], 0)).toThrow("step is 0 m");
});
