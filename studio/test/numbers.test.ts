// The numbers that the page shows, with their units: in the table, in the sentence and at the pointer.
import { expect, test } from "vitest";

import type { Context } from "../src/app/context.ts";
import { decibels, duration, metricsOf, numberRows, percent, pressure, sentenceOf, strengthLevel } from "../src/app/numbers.ts";
import { createReadout } from "../src/app/readout.ts";
import type { Answer } from "../src/solving/door.ts";
import type { Result, View } from "../src/solving/studio.ts";
import { initial } from "../src/state/initial.ts";

test.each([
  [pressure(999.4), "999 Pa"],
  [pressure(0.01234), "0.0123 Pa"],
  [pressure(1234), "1.23 kPa"],
  [duration(0.25), "250 µs"],
  [duration(12.34), "12.3 ms"],
  [percent(0.876), "88 %"],
])("numbers have units: %s", (text, wanted) => {
  expect(text).toBe(wanted);
});

test("levels are in dB above 20 µPa rms and above the threshold", () => {
  expect(decibels(Math.SQRT2 * 2)).toBeCloseTo(100, 9);
  expect(strengthLevel(10)).toBeCloseTo(20, 9);
});

const metrics = { accuracy: 0.9876, sigma: 0.0123, uniformity: 0.876, level: 0.75, leak: 0.0321, residual: 0 };
const answer = { pressures: [[300, 400], [1500, 0], [3, 4]], targets: [1, 1, 0], metrics, drive: [], scale: 1 } as unknown as Answer;
const result = { answer, lattice: null, crossing: [], atEar: Math.SQRT2 * 2, beads: [3, 4], milliseconds: 0.25, refused: null, warnings: [] } as Result;
const slower: Result = { ...result, beads: [0, 4], milliseconds: 2, answer: { ...answer, metrics: { ...metrics, sigma: 0.2 } } };
const state = { ...initial, pressures: [1, 1, 0], ear: [0, 0, 0.5] as [number, number, number], signature: "", path: null };
const view = { state, results: [result, slower], bound: 0.8, frame: null } as unknown as View;

test("the table's rows", () => {
  const rows = Object.fromEntries(numberRows(view).map(({ word, values, better }) => [word, [...values, better]]));
  expect(rows).toEqual({
    accuracy: ["0.988", "0.988", null],
    sigma: ["0.012", "0.200", 0],
    uniformity: ["0.876", "0.876", null],
    level: ["0.750", "0.750", null],
    bound: ["0.800", null],
    weakest: ["500 Pa", "500 Pa", null],
    leak: ["0.032", "0.032", null],
    atEar: ["100.0 dB SPL", "100.0 dB SPL", null],
    kept: ["3 / 4", "0 / 4", 0],
    time: ["250 µs", "2.0 ms", null],
  });
  expect(metricsOf(result)?.weakest).toBe(500);
});

test("the sentence's numbers", () => {
  expect(sentenceOf(view)).toEqual({
    word: "foci",
    put: { count: 2, pressure: "500 Pa", level: "145 dB", evenness: "88 %", time: "250 µs" },
  });
  const touch = { most: 10, width: 0.012, peak: 1e-6, quantity: "felt" };
  const frame = { points: [], results: [null, null], names: ["", ""], touch };
  expect(sentenceOf({ ...view, frame } as unknown as View)).toEqual({ word: "skinFelt", put: { strength: "20 dB", width: "12 mm" } });
  const pushed = { ...frame, touch: { ...touch, quantity: "push", force: 0.2114 } };
  expect(sentenceOf({ ...view, frame: pushed } as unknown as View)).toEqual({ word: "pushFelt", put: { push: "211 mN" } });
});

test("the readout at the pointer", async () => {
  const lines: string[] = [];
  const node = { replaceChildren: () => undefined, setAttribute: () => undefined, append: () => undefined, hidden: true };
  globalThis.document = { createElement: () => ({ ...node }) } as unknown as Document;
  const probe = { pressure: [300, 400], level: 145.2, radiation: 1.234 };
  const lattice = { corner: [0, 0, 0], u: [1, 0, 0], v: [0, 1, 0], nu: 8, nv: 8, values: new Float32Array(128).map((_, k) => (k % 2 ? 0 : 2.5e-6)) };
  const studio = { view: { ...view, results: [{ ...result, lattice }, slower] }, scene: () => "" };
  const context = { studio, engine: { slots: [{ probe: async () => probe }] }, say: (word: string) => word };
  const readout = createReadout(context as unknown as Context, (line) => lines.push(line));
  readout.show(0, [0.0123, 0, 0.15]);
  await new Promise((done) => setTimeout(done));
  studio.view = { ...studio.view, frame: { results: [null, null], touch: { quantity: "skin" } } } as unknown as typeof studio.view;
  readout.show(0, [0.5, 0.5, 0]);
  await new Promise((done) => setTimeout(done));
  expect(lines).toEqual([
    "A  x 12.3  y 0  z 150 mm, |p| 500 Pa  ·  145.2 dB SPL, phase 0.93 rad  ·  radiation 1.23 Pa",
    "A  x 500  y 500  z 0 mm, skin 2.5 µm",
  ]);
});
