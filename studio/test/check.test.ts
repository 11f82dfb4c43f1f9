// Invalid values given to the page are rejected with a message of one line; every scene of the gallery is valid.
import { expect, test } from "vitest";

import { checked } from "../src/state/check.ts";
import { gallery } from "../src/state/gallery.ts";
import { initial } from "../src/state/initial.ts";
import type { State } from "../src/state/types.ts";

const names = ["paper36", "autd3", "sonicsurface", "sonicsurface_pair", "openmpd_pair"];
const catalogue = {
  version: "",
  presets: names.map((name) => ({ name, summary: "", count: 1, tiles: name === "autd3", board: "" })),
  solvers: ["uniform", "naive", "gspat", "glide", "fast", "greedy"].map((name) => ({ name, summary: "", aims: false })),
  boards: [],
};
const fault = (partial: object) => {
  try {
    checked({ ...initial, ...partial } as State, catalogue);
    return "";
  } catch (error) {
    return (error as Error).message;
  }
};

test.each(gallery.map(({ name, state }) => [name[0], state] as const))("%s", (_, state) => {
  expect(fault(state)).toBe("");
});

test.each([
  { array: { name: "x" } },
  { array: "autd3" },
  { array: null },
  { array: { preset: "autd3" } },
  { array: { preset: "nonsense", tiles: [1, 1] } },
  { array: { preset: "sonicsurface", tiles: [2, 2] } },
  { temperature: "25" },
  { temperature: NaN },
  { slot: 5 },
  { slot: "1" },
  { points: [] },
  { points: null },
  { points: "x" },
  { points: [[0, 0, 0.1, 5]] },
  { points: [["0", 0, 0.15]] },
  { points: Array.from({ length: 65 }, (_, k) => [k / 1000, 0, 0.15]) },
  { pressures: [1] },
  { pressures: "x" },
  { pressures: initial.points.map(() => 0) },
  { methods: "uniform" },
  { methods: ["foo", "naive"] },
  { plane: null },
  { plane: { ...initial.plane, z: "0.15" } },
  { plane: { ...initial.plane, size: 0 } },
  { obstacles: null },
  { obstacles: [{}] },
  { ear: "x" },
  { path: { kind: "spiral", radius: 1, frequency: 1 } },
  { colour: "red" },
])("%j is refused", (partial) => {
  const line = fault(partial);
  expect(line).toMatch(/: /);
  expect(line).not.toMatch(/\n/);
});
