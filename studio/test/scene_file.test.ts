import { expect, test } from "vitest";
import keys from "../../python/midair/_studio/keys.json";
import { initial } from "../src/state/initial.ts";
import { sceneOf, stateOf } from "../src/state/scene_file.ts";
import type { SceneFile } from "../src/state/scene_file.ts";
import type { State, Vec3 } from "../src/state/types.ts";
import { generator, randomState } from "./random.ts";

test("states survive, but for what a scene has no place for", () => {
  const random = generator(3);
  for (let index = 0; index < 100; index += 1) {
    const drawn = randomState(random);
    const method = drawn.methods[drawn.slot];
    // A scene has the options of its method only.
    const state = { ...drawn, path: null, filled: [], options: drawn.options[method] ? { [method]: drawn.options[method] } : {} };
    const scene = JSON.parse(JSON.stringify(sceneOf(state, state.slot))) as SceneFile;
    const other: State = { ...initial, ...viewOf(state) };
    expect(stateOf(scene, other)).toEqual(state);
  }
});

function viewOf({ methods, level, view, quantity, slot, scale, ear }: State): Partial<State> {
  return { methods: methods.with(slot, "gs") as [string, string], level, view, quantity, slot, scale, ear };
}

test("the keys of a scene", () => {
  const positions: Vec3[] = [[0, 0, 0.1 + 0.2]];
  const normals: Vec3[] = [[0, 0, 1]];
  const array = { name: "mine", positions, normals };
  const points: Vec3[] = [[0, 0, 0.1]];
  const state: State = { ...initial, array, quantization: "none", points, pressures: [0] };
  expect(sceneOf(state, 1)).toEqual({
    medium: { temperature: 25 },
    array: { positions: [[0, 0, 0.3]], normals, quantization: {} },
    points: [{ position: [0, 0, 0.1], pressure: 0 }],
    solver: { name: "naive" },
    plane: { z: 0.18, size: 0.18, center: [0, 0] },
  });
});

test("an upright slice is a file's, its center as the file's axes are", () => {
  const plane = { axis: "y" as const, z: 0.13, size: 0.2, center: [0.01, 0.02] as [number, number] };
  const scene = sceneOf({ ...initial, plane }, 0);
  expect(scene.plane).toEqual({ axis: "y", at: 0.02, size: 0.2, center: [0.01, 0.13] });
  expect(stateOf(scene, initial).plane).toEqual(plane);
});

test("a grid, a sound speed and no plane", () => {
  const scene: SceneFile = {
    medium: { frequency: 40000, sound_speed: 346.1295, absorption: 0, density: 1.18 },
    array: { grid: { nx: 3, ny: 2, pitch: 0.01 } },
    points: [{ position: [0.01, 0, 0.15] }, { position: [0.03, 0.02, 0.15] }],
  };
  const state = stateOf(scene, initial);
  expect(state.temperature).toBeCloseTo(25, 1);
  expect(state.array).toEqual({
    name: "3 x 2",
    positions: [-0.005, 0.005].flatMap((y) => [-0.01, 0, 0.01].map((x) => [x, y, 0])),
    normals: Array.from({ length: 6 }, () => [0, 0, 1]),
  });
  expect(state.plane).toEqual({ axis: "z", z: 0.15, size: 0.18, center: [0.02, 0.01] });
  expect(state.methods).toEqual(initial.methods);
});

/** A scene with every key that the page has, none at its default. */
const WHOLE: SceneFile = {
  medium: { temperature: 18, absorption: 0.2, density: 1.1 },
  array: { positions: [[0, 0, 0], [0.01, 0, 0]], normals: [[0, 0, 1], [0, 1, 0]], source_pressure: 2, mask: [true, false], pins: [1, 0] },
  points: [{ position: [0, 0, 0.1], pressure: 200 }, { position: [0.02, 0, 0.1], pressure: 0 }],
  obstacles: [
    { point: [0, 0, 0.3], normal: [0, 0, -1], kind: "soft" },
    { center: [0, 0, 0.2], radius: 0.01, kind: "rigid" },
  ],
  signature: ["twin", "focus"],
  bead: { radius: 1.2e-3, density: 900, sound_speed: 2000, gravity: [0, 9.81, 0] },
  solver: { name: "greedy", seed: 3, order: "random" },
  plane: { axis: "x", at: 0.01, size: 0.1, center: [0.02, 0.03], pixels: 400 },
};

test("no key of a scene that is opened is lost", () => {
  expect(sceneOf(stateOf(WHOLE, initial), initial.slot)).toEqual(WHOLE);
  // Keys of which the page has one value only, or that it writes as others.
  const fixed = new Set(["frequency", "sound_speed", "phase", "weight", "version", "status"]);
  const named = (known: unknown): string[] => (known === Object(known) ? Object.entries(known as object).flatMap(([key, each]) => [key, ...named(each)]) : []);
  const written = new Set(named(WHOLE));
  expect(named(keys).filter((key) => Number.isNaN(Number(key)) && !fixed.has(key) && !written.has(key))).toEqual([]);
});

const GOOD = sceneOf(initial, 0);
const point = { position: [0, 0, 0.1] as Vec3 };

test.each<Partial<SceneFile>>([
  { array: { preset: "autd3", tiles: [1, 1], mask: [true, false], source_pressure: 2 } },
  { array: { preset: "autd3", tiles: [1, 1], quantization: { phases: 16 } } },
  { array: { positions: [[0, 0, 0]], normals: [[0, 0, 1]], directivity: { piston: 4.5e-3 } } },
  { bead: { radius: 1.2e-3, density: 900, sound_speed: 2000, gravity: [0, 0, -9.81] } },
  { solver: { name: "greedy", seed: 3, order: "random" } },
  { plane: { z: 0.1, size: 0.1, center: [0, 0], pixels: 400 } },
])("the page keeps what it does not change, and writes it back: %j", (change) => {
  const scene = { ...GOOD, ...change };
  expect(sceneOf(stateOf(scene, initial), 0)).toEqual(scene);
});

test.each<[object, string]>([
  [{ medium: { frequency: 25e3 } }, "medium.frequency is 25000: the page has 40000, use the package"],
  [{ medium: { wind: 3 } }, "medium.wind is 3: the page has no place for it, use the package"],
  [{ motion: { rate: 1000 } }, 'motion is {"rate":1000}: the page has no place for it, use the package'],
  [{ array: {} }, "array is {}"],
  [{ points: Array.from({ length: 65 }, () => point) }, "points is 65: the page has at most 64"],
  [{ points: [{ ...point, weight: 2 }] }, "points[0].weight is 2"],
  [{ points: [point, { ...point, phase: 1 }] }, "points[1].phase is 1"],
  [{ points: [{ ...point, colour: 1 }] }, "points[0].colour is 1: the page has no place for it"],
  [{ obstacles: [{ vertices: [] }] }, "obstacles[0].vertices is []: the page has no place for it"],
  [{ signature: [[1, 0]] }, "signature is [[1,0]]"],
  [{ signature: ["trap", "twim"] }, 'signature is ["trap","twim"]: give "trap"'],
  [{ plane: { size: 0.1 } }, "plane is"],
])("what a state has no place for is refused: %j", (change, line) => {
  expect(() => stateOf({ ...GOOD, ...change }, initial)).toThrow(line);
});
