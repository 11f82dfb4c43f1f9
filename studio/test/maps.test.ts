import { expect, test } from "vitest";
import { colour, entry, mapOf, modulusAt, shade, TABLES, ticks, tone } from "../src/painter/maps.ts";
import type { Look } from "../src/state/types.ts";
import { lab } from "./lab.ts";

const look = (scale: Look["scale"], top = 6900): Look => ({ quantity: "modulus", scale, top, turn: 0, theme: "dark" });

test("the map of |p| goes from dark to bright, on light ground from the page's own colour to black", () => {
  const at = (map: "field" | "field_light", i: number) => [...TABLES[map].subarray(4 * i, 4 * i + 3)];
  expect([at("field", 0), at("field", 255)]).toEqual([[0, 0, 4], [252, 253, 191]]);
  // matplotlib's magma, up to the error of 25 interpolated colours.
  at("field", 128).forEach((value, k) => expect(Math.abs(value - [183, 55, 121][k])).toBeLessThan(3));
  expect([at("field_light", 0), at("field_light", 255)]).toEqual([[246, 248, 250], [0, 0, 4]]);
  for (const [map, way] of [["field", 1], ["field_light", -1]] as const) {
    const light = Array.from({ length: 256 }, (_, i) => lab(at(map, i))[0]);
    expect(light.slice(1).every((value, i) => way * (value - light[i]) > 0)).toBe(true);
  }
});

test("the scales", () => {
  expect(colour(look("linear"), 3450)).toEqual(entry("field", 0.5));
  expect(colour(look("squared"), 3450)).toEqual(entry("field", 0.25));
  expect(colour(look("decibel"), 690)).toEqual(entry("field", 1 - 20 / 30));
  for (const scale of ["linear", "squared", "decibel"] as const) {
    expect(tone(look(scale), modulusAt(look(scale), 0.3))).toBeCloseTo(0.3, 12);
    expect(colour(look(scale), 0)).toEqual([0, 0, 4]);
    expect(colour(look(scale), 9000)).toEqual([252, 253, 191]);
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

test("the wave is Re(p e^{-jwt}): it runs away from its source, and its map is quiet in the middle", () => {
  const wave = (turn: number): Look => ({ ...look("squared", 1000), quantity: "wave", turn });
  for (let k = 0; k < 40; k += 1) {
    const [turn, phase] = [0.3 * k, 0.7 * k - 9];
    const at = shade(wave(turn), 800 * Math.cos(phase), 800 * Math.sin(phase));
    expect(at).toBeCloseTo(0.5 + 0.4 * Math.cos(phase - turn), 12);
  }
  // The crest of e^{jkr} is at kr = wt, so it moves outwards.
  expect(shade(wave(0.5), 1000 * Math.cos(0.5), 1000 * Math.sin(0.5))).toBeCloseTo(1, 12);
  for (const theme of ["dark", "light"] as const) {
    const name = mapOf({ ...wave(0), theme });
    const bright = (t: number) => entry(name, t).reduce((sum, value) => sum + value);
    const order = [0, 0.25, 0.5].map(bright);
    expect(order.every((value, k) => k === 0 || (theme === "dark" ? value < order[k - 1] : value > order[k - 1]))).toBe(true);
    expect([1, 0.75].every((t) => (theme === "dark" ? bright(t) > bright(0.5) : bright(t) < bright(0.5)))).toBe(true);
  }
  expect(ticks(wave(0)).map(({ label }) => label)).toEqual(["−1.0 kPa", "−0.5 kPa", "0", "0.5 kPa", "1.0 kPa"]);
  expect(ticks(wave(1)).map(({ at }) => at)).toEqual([0, 0.25, 0.5, 0.75, 1]);
});

test("the phase goes around the map, which closes", () => {
  const phase: Look = { ...look("linear"), quantity: "phase" };
  for (const angle of [-3, -1, 0, 0.5, 3]) expect(shade(phase, 5 * Math.cos(angle), 5 * Math.sin(angle))).toBeCloseTo(0.5 + angle / 2 / Math.PI, 12);
  expect(entry("phase", 0)).toEqual(entry("phase", 1));
  // Bright where p is at its crest, dark at its trough; orange a quarter ahead of it, blue a quarter behind.
  const bright = (t: number) => entry("phase", t).reduce((sum, value) => sum + value);
  for (const t of [0.25, 0.75]) expect(bright(0.5) > bright(t) && bright(t) > bright(0)).toBe(true);
  for (const [t, blue] of [[0.75, -1], [0.25, 1]]) expect(Math.sign(entry("phase", t)[2] - entry("phase", t)[0])).toBe(blue);
  for (const { at, value } of ticks(phase)) expect(at).toBeCloseTo(0.5 + value / 2 / Math.PI, 12);
});
