import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import type { Contour } from "../src/making/contours.ts";
import { compile, Door } from "../src/solving/door.ts";
import { letters } from "../src/making/lettering.ts";
import { first, initial } from "../src/state/initial.ts";
import { broughtBy, reached, roomOf } from "../src/state/points.ts";
import type { Vec3 } from "../src/state/types.ts";

const door = new Door(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));

/** The distance in m of neighbouring points, if there are enough points for the whole shape. */
const STEP = 2.125e-3;

const along = (contours: Contour[], most = 64) => door.along(contours, most);
const written = (text: string, most = 64) => along(letters(text, 0.03, 1, [0, 0, 0.15]).contours, most);
const distance = (a: Vec3, b: Vec3) => Math.hypot(...a.map((x, axis) => x - b[axis]));
const nearest = (points: Vec3[]) =>
  Math.min(...points.flatMap((a, k) => points.slice(0, k).map((b) => distance(a, b))));

test("a line has both ends and equal steps", () => {
  const points = along([[[-0.03, 0, 0.15], [0.03, 0, 0.15]]]);
  // 60 / 2.125 = 28.2 is rounded to 28 steps.
  expect(points).toHaveLength(29);
  expect(points[0]).toEqual([-0.03, 0, 0.15]);
  expect(points[28]).toEqual([0.03, 0, 0.15]);
  points.slice(1).forEach((at, k) => expect(distance(at, points[k])).toBeCloseTo(0.06 / 28, 12));
});

test("a short line keeps its ends, one of no length is a point", () => {
  expect(along([[[0, 0, 0], [0.0015, 0, 0]]])).toHaveLength(2);
  expect(along([[[0, 0, 1], [0, 0, 1]]])).toEqual([[0, 0, 1]]);
  expect(along([[[0, 0, 1]]])).toEqual([[0, 0, 1]]);
});

test("a square closes, and its steps run on around corners", () => {
  const side = 2 * STEP;
  const square: Vec3[] = [[0, 0, 0], [side, 0, 0], [side, side, 0], [0, side, 0], [0, 0, 0]];
  const steps = along([square]).map((at) => at.map((x) => Math.round(x / STEP)).slice(0, 2));
  expect(steps).toEqual([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]]);
});

test("every letter is drawn, as high as requested, and none of its points are too near", () => {
  for (const letter of "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") {
    const points = written(letter, 1000);
    const up = points.map((at) => at[1]);
    // Around a corner, points can miss it by half a step.
    expect(Math.abs(Math.max(...up) - 0.015), letter).toBeLessThan(0.00107);
    expect(Math.abs(Math.min(...up) + 0.015), letter).toBeLessThan(0.00107);
    expect(nearest(points), letter).toBeGreaterThanOrEqual((STEP / 2) * (1 - 1e-8));
    expect(points.every((at) => at[2] === 0.15)).toBe(true);
  }
});

test("a text is centred, reads from left to right, and says what it has not", () => {
  const points = written("a i.");
  const across = points.map((at) => at[0]);
  expect(Math.max(...across) + Math.min(...across)).toBeCloseTo(0, 12);
  expect(points.filter((at) => at[0] > 0.0199)).toHaveLength(1);
  expect(() => written("あ")).toThrow('the text has "あ": give A to Z');
  expect(() => written("  ")).toThrow("the text is empty");
});

test("a step that makes too many points is widened until they fit", () => {
  const points = written("MIDAIR 2026");
  expect(points.length).toBeLessThanOrEqual(64);
  expect(points.length).toBeGreaterThan(50);
});

test("what is no shape is refused", () => {
  expect(() => along([[[0, 0, 0], [1000, 0, 0]]])).toThrow("step is 0.002125: 1000 m of contours would be more than");
  expect(() => along([[]])).toThrow("contour is []");
});

test("many letters are broken into lines where they are larger then, and say how near to one another they are", () => {
  const size = (text: string) => {
    const { contours, apart } = letters(text, 0.03, 0.16, [0.01, 0.02, 0.15]);
    const all = contours.flat();
    const [x, y] = [0, 1].map((axis) => all.map((at) => at[axis]));
    const ends = [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)];
    expect((ends[0] + ends[1]) / 2).toBeCloseTo(0.01, 9);
    expect((ends[2] + ends[3]) / 2).toBeCloseTo(0.02, 9);
    return { wide: ends[1] - ends[0], high: ends[3] - ends[2], apart };
  };
  expect(size("HI").high).toBeCloseTo(0.03, 9);
  const one = size("ULTRASOUND");
  const two = size("ULTRA SOUND");
  expect(one.high).toBeLessThan(0.02);
  expect(two.high).toBeGreaterThan(2 * one.high);
  expect(two.apart).toBeGreaterThan(1.5 * one.apart);
  for (const { wide, high } of [one, two, size("FOUR WORDS IN LINES")]) expect(Math.max(wide, high)).toBeLessThan(0.16 + 1e-9);
  // Half a wavelength is 4.3 mm: ten letters on a line of 160 mm are too dense, on two lines they are not.
  expect(one.apart).toBeLessThan(0.0062);
  expect(size("ABCDEFGHIJKLMNOPQRSTUVWX").apart).toBeLessThan(0.0043);
});

const presetOf = (preset: string, tiles = [1, 1]) => {
  door.open(JSON.stringify({ array: { preset, ...(preset === "autd3" && { tiles }) }, points: [{ position: [0, 0, 0.1] }] }));
  const places = door.array();
  return roomOf(places.subarray(0, places.length / 2));
};

test("an array brings its own scene: the first one above boards, one focus above small ones, traps between two", () => {
  const { points, plane, quantity } = first;
  for (const room of [presetOf("autd3"), presetOf("autd3", [2, 2]), presetOf("stratos")]) expect(broughtBy(room)).toMatchObject({ points, plane, quantity, signature: "" });
  for (const name of ["ultraino_flat8x8", "spherical_cap64"]) expect(broughtBy(presetOf(name)).points).toHaveLength(1);
  for (const [name, count] of [["tinylev", 1], ["openmpd_pair", 2]] as const) {
    const { points, signature, plane } = broughtBy(presetOf(name));
    expect([points!.length, signature, plane!.axis]).toEqual([count, "trap", "y"]);
    expect(points!.every((point) => Math.abs(point[2]) < 1e-3)).toBe(true);
  }
});

test("points of one's own come along into the reach of another array, and stay where they can", () => {
  const state = { ...initial, plane: { ...initial.plane } };
  const [large, small, pair] = [presetOf("autd3", [2, 2]), presetOf("ultraino_flat8x8"), presetOf("openmpd_pair")];
  expect(reached(state, large, presetOf("autd3"))).toEqual({ points: state.points, plane: state.plane });
  const { points, plane } = reached(state, large, small);
  expect(Math.max(...points.flatMap((point) => point.slice(0, 2).map(Math.abs)))).toBeLessThan(0.45 * small.side);
  expect(points.every((point) => point[2] < 1.3 * small.side)).toBe(true);
  expect(plane.z).toBeCloseTo(points[0][2], 9);
  expect(reached(state, large, pair).points.every((point) => Math.abs(point[2]) < 1e-3)).toBe(true);
  expect(reached({ ...state, ...reached(state, large, pair) }, pair, large).plane.z).toBeCloseTo(0.18, 9);
});
