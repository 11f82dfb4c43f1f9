// The touch of a skin: the slice on which it lies, its limits, the colour bar and the sentence about it.
import { expect, test } from "vitest";

import { initial } from "../src/state/initial.ts";
import { readLink, writeLink } from "../src/state/link.ts";
import { sentenceOf } from "../src/app/numbers.ts";
import { colour, ticks } from "../src/painter/maps.ts";
import { lengthOf } from "../src/making/paths.ts";
import type { View } from "../src/solving/studio.ts";
import { limitsOf, skinPlane, touchOf } from "../src/solving/touch.ts";
import type { Look, Path, State, TouchQuantity } from "../src/state/types.ts";

const circle: Path = { kind: "circle", radius: 0.02, frequency: 56 };
const state = (partial: Partial<State>): State => ({ ...initial, path: circle, ...partial });

test("a skin lies flat through the points, with their paths and a margin", () => {
  expect(skinPlane(state({ points: [[0.01, 0, 0.2]] }))).toEqual({ axis: "z", z: 0.2, size: 0.08, center: [0.01, 0] });
  const two = state({ points: [[-0.03, 0.01, 0.15], [0.03, 0.02, 0.17]], path: { kind: "line", length: 0.011, frequency: 10 } });
  expect(skinPlane(two)).toEqual({ axis: "z", z: 0.16, size: 0.115, center: [0, 0.015] });
  expect(skinPlane(state({ points: [[0, 0, 0.2]], path: null })).size).toBe(0.04);
});

test("only points on a path have a touch, and links keep it", () => {
  expect(touchOf(state({ quantity: "felt" }))).toBe("felt");
  expect(touchOf(state({ quantity: "felt", path: null }))).toBeNull();
  expect(touchOf(state({ quantity: "wave" }))).toBeNull();
  expect(readLink(writeLink(state({ quantity: "skin" }))).quantity).toBe("skin");
});

test("samples are few enough that the core keeps G, and no farther apart than 2.5 mm", () => {
  expect(limitsOf(996).count).toBe(64);
  for (const transducers of [1, 996, 2241, 15936]) {
    const { count, size } = limitsOf(transducers);
    expect(count * count * transducers).toBeLessThanOrEqual(1 << 23);
    expect(size / (count - 1)).toBeCloseTo(2.5e-3, 9);
  }
});

test("a turn is as long as its circle", () => {
  expect(lengthOf(circle)).toBeCloseTo(0.1257, 4);
  expect(lengthOf({ kind: "line", length: 0.04, frequency: 1 })).toBeCloseTo(0.1257, 4);
});

test("the colour bar of strength has levels above the threshold, that of motion micrometres", () => {
  const felt: Look = { quantity: "modulus", touch: "felt", scale: "decibel", top: 10 ** (25 / 20), turn: 0, theme: "dark" };
  const marks = ticks(felt);
  expect(marks.map(({ label }) => label)).toEqual(["0 dB", "10 dB", "20 dB"]);
  expect(marks[2].at).toBeCloseTo(1 - 5 / 30, 9);
  // A mark has the colour of its strength.
  for (const { value, at } of marks) expect(colour(felt, value)).toEqual(colour({ ...felt, scale: "linear", top: 1 }, at));
  expect(ticks({ ...felt, top: 0.5 }).map(({ label }) => label)).toEqual(["\u221230 dB", "\u221220 dB", "\u221210 dB"]);
  const push: Look = { ...felt, touch: "push", scale: "linear", top: 170 };
  expect(ticks(push).map(({ label }) => label)).toEqual(["0", "50 Pa", "100 Pa", "150 Pa"]);
  const skin: Look = { ...felt, quantity: "wave", touch: "skin", scale: "linear", top: 45e-6 };
  expect(ticks(skin).map(({ label }) => label)).toEqual(["\u221240 µm", "\u221220 µm", "0", "20 µm", "40 µm"]);
  expect(ticks({ ...skin, top: 0.6e-6 }).at(-1)!.label).toBe("0.6 µm");
});

test("the sentence reports the strongest place and how wide it is felt", () => {
  const answer = { metrics: {}, pressures: [[1, 0]], targets: [1] };
  const said = (most: number, width: number, touch: TouchQuantity | null = "felt") => {
    const frame = touch && { points: [], results: [null, null], names: ["", ""], touch: { quantity: touch, most, width, peak: 1e-6 } };
    const view = { state: state({ quantity: "felt", plane: { ...initial.plane, size: 0.08 } }), results: [{ answer }, { answer }], frame };
    return sentenceOf(view as unknown as View);
  };
  expect(said(10 ** (41.2 / 20), 0.0186)).toEqual({ word: "skinFelt", put: { strength: "41 dB", width: "19 mm" } });
  expect(said(0.5, Infinity)).toEqual({ word: "skinBelow", put: { strength: "6 dB", width: "> 80 mm" } });
  expect(said(1, 0.01, null)).toEqual({ word: "skinComing", put: {} });
});
