import { expect, test } from "vitest";
import { initial } from "../src/state/initial.ts";
import { sceneOf, stateOf } from "../src/state/scene_file.ts";
import type { SceneFile } from "../src/state/scene_file.ts";
import type { State, Vec3 } from "../src/state/types.ts";
import { generator, randomState } from "./random.ts";

test("states survive, but for what a scene has no place for", () => {
  const random = generator(3);
  for (let index = 0; index < 100; index += 1) {
    const state = { ...randomState(random), path: null, filled: [] };
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
    array: { grid: { nx: 3, ny: 2, pitch: 0.01 }, source_pressure: 4.386, directivity: "point" },
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

const GOOD = sceneOf(initial, 0);
const point = { position: [0, 0, 0.1] as Vec3 };
test.each<[Partial<SceneFile>, string]>([
  [{ medium: { frequency: 25e3 } }, "medium.frequency is 25000: the page has 40000, use the package"],
  [{ array: { preset: "autd3", mask: [true, false] } }, "array.mask is [true,false]: the page"],
  [{ array: { preset: "autd3", quantization: { phases: 16 } } }, "array.quantization"],
  [{ array: { positions: [[0, 0, 0]], source_pressure: 1 } }, "array.source_pressure is 1"],
  [{ array: {} }, "array is {}"],
  [{ points: Array.from({ length: 65 }, () => point) }, "points is 65: the page has at most 64"],
  [{ points: [{ ...point, weight: 2 }] }, "points[0].weight is 2"],
  [{ points: [point, { ...point, phase: 1 }] }, "points[1].phase is 1"],
  [{ obstacles: [{ vertices: [] }] }, "obstacles[0]"],
  [{ signature: [[1, 0]] }, "signature is [[1,0]]"],
  [{ signature: ["trap", "twim"] }, 'signature is ["trap","twim"]: give "trap"'],
  [{ plane: { size: 0.1 } }, "plane is"],
])("what a state has no place for is refused: %j", (change, line) => {
  expect(() => stateOf({ ...GOOD, ...change }, initial)).toThrow(line);
});
