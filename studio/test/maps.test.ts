import { expect, test } from "vitest";
import { colour, entry, modulusAt, TABLES, ticks, tone } from "../src/painter/maps.ts";
import type { Look } from "../src/types.ts";

const look = (scale: Look["scale"], top = 6900): Look => ({ map: "viridis", scale, top });

test("the maps are matplotlib's", () => {
  const at = (map: Look["map"], i: number) => [...TABLES[map].subarray(4 * i, 4 * i + 3)];
  expect([0, 128, 255].map((i) => at("viridis", i))).toEqual([
    [68, 1, 84],
    [33, 145, 140],
    [253, 231, 37],
  ]);
  expect([0, 128, 255].map((i) => at("cividis", i))).toEqual([
    [0, 34, 78],
    [125, 124, 120],
    [254, 232, 56],
  ]);
  expect([0, 128, 255].map((i) => at("magma", i))).toEqual([
    [0, 0, 4],
    [183, 55, 121],
    [252, 253, 191],
  ]);
});

test("the scales", () => {
  expect(colour(look("linear"), 3450)).toEqual(entry("viridis", 0.5));
  expect(colour(look("squared"), 3450)).toEqual(entry("viridis", 0.25));
  expect(colour(look("decibel"), 690)).toEqual(entry("viridis", 1 - 20 / 30));
  for (const scale of ["linear", "squared", "decibel"] as const) {
    expect(tone(look(scale), modulusAt(look(scale), 0.3))).toBeCloseTo(0.3, 12);
    expect(colour(look(scale), 0)).toEqual([68, 1, 84]);
    expect(colour(look(scale), 9000)).toEqual([253, 231, 37]);
  }
});

test("the ticks are round, on the bar, and in the order of |p|", () => {
  expect(ticks(look("linear")).map((tick) => tick.label)).toEqual(["0", "2 kPa", "4 kPa", "6 kPa"]);
  expect(ticks(look("squared", 500)).map((tick) => tick.label)).toEqual([
    "0",
    "100 Pa",
    "200 Pa",
    "300 Pa",
    "400 Pa",
    "500 Pa",
  ]);
  expect(ticks(look("linear", 1000)).map((tick) => tick.label)[1]).toBe("0.2 kPa");
  expect(ticks(look("decibel")).map((tick) => tick.label)).toEqual(["−30 dB", "−20 dB", "−10 dB", "0 dB"]);
  for (const scale of ["linear", "squared", "decibel"] as const) {
    for (const top of [0.02, 3, 77, 999, 1000, 12345]) {
      const all = ticks(look(scale, top));
      expect(all.length).toBeGreaterThanOrEqual(3);
      expect(all.length).toBeLessThanOrEqual(6);
      for (const [i, tick] of all.entries()) {
        expect(tick.at).toBeGreaterThanOrEqual(i ? all[i - 1].at + 1e-3 : 0);
        expect(tick.at).toBeLessThanOrEqual(1);
      }
    }
  }
});
