import { expect, test } from "vitest";
import { framesOf } from "../src/making/paths.ts";
import type { Vec3 } from "../src/state/types.ts";

const POINTS: Vec3[] = [[0, 0, 0.1], [0.02, 0.01, 0.2]];

test("a circle carries all points alike, a quarter of a turn to +y", () => {
  const frames = framesOf(POINTS, { kind: "circle", radius: 0.01, frequency: 2 }, 40, 0.5);
  expect(frames).toHaveLength(20 * 2 * 3);
  expect([...frames.slice(0, 6)]).toEqual([0.01, 0, 0.1, 0.03, 0.01, 0.2]);
  const quarter = [...frames.slice(5 * 6, 6 * 6)];
  [0, 0.01, 0.1, 0.02, 0.02, 0.2].forEach((x, k) => expect(quarter[k]).toBeCloseTo(x, 12));
});

test("a line leads back and forth along x, as long as requested", () => {
  const frames = framesOf([[0, 0, 0.1]], { kind: "line", length: 0.06, frequency: 1 }, 100, 1);
  const across = [...frames].filter((_, k) => k % 3 === 0);
  expect(across[0]).toBe(0.03);
  expect(across[50]).toBeCloseTo(-0.03, 12);
  expect(Math.max(...across) - Math.min(...across)).toBeCloseTo(0.06, 12);
  expect([...frames].filter((_, k) => k % 3 === 2).every((z) => z === 0.1)).toBe(true);
});

test("what stands still and what lasts no time", () => {
  const still = framesOf([[0, 0, 0.1]], { kind: "circle", radius: 0.01, frequency: 0 }, 10, 0.3);
  expect([...still]).toEqual([0.01, 0, 0.1, 0.01, 0, 0.1, 0.01, 0, 0.1]);
  expect(framesOf(POINTS, { kind: "line", length: 0.01, frequency: 1 }, 10, 0)).toHaveLength(0);
});
