// Beads: their simulation by the WebAssembly module, their places in the animation, and the sentences about them.
import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { type BeadFlight, balls, beadsAt, fateOf } from "../src/solving/beads.ts";
import { compile, Door, type Flight } from "../src/solving/door.ts";
import { framesOf } from "../src/making/paths.ts";
import { initial } from "../src/state/initial.ts";
import { sceneOf, stateOf } from "../src/state/scene_file.ts";
import type { State, Vec3 } from "../src/state/types.ts";
import { say, type Word } from "../src/app/words.ts";

const door = new Door(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));
const english = (word: Word, put = {}) => say("en", word, put);

/** Time in ms for a test that flies beads twice on a busy machine. */
const SLOW = 60_000;

/** Returns the simulated motion of beads that two boards carry around circles. */
function flown(points: Vec3[], frequency: number, radius = 0.01): BeadFlight[] {
  const [count, rate] = [Math.round(1000 / frequency), 1000];
  const scene = { array: { preset: "openmpd_pair", quantization: {} }, points: points.map((position) => ({ position })), signature: "trap", solver: { name: "glide", rate } };
  door.open(JSON.stringify(scene));
  door.follow(framesOf(points, { kind: "circle", radius, frequency }, rate, count / rate), count);
  return points.map((_, point) => ({ point, ...door.fly(point, rate) }));
}

/** Returns the largest distance in m of a bead from a circle of 10 mm radius around the origin. */
function strayed({ places }: Flight): number {
  const each = Array.from({ length: places.length / 3 }, (_, k) => places.subarray(3 * k, 3 * k + 3));
  return Math.max(...each.map(([x, y, z]) => Math.hypot(Math.hypot(x, y) - 0.01, z)));
}

test("a bead goes around with its trap, for laps of a second", () => {
  const [flight] = flown([[0, 0, 0]], 4);
  expect(flight.lost).toBeNull();
  // From its point; from the circle it strays less.
  expect(flight.farthest).toBeLessThan(0.3e-3);
  expect(strayed(flight)).toBeLessThan(0.1e-3);
  expect(flight.places).toHaveLength(3 * 1000);
  const place = beadsAt([flight], 125, 250, 1000)[0];
  // The bead lags behind its point by half a frame and the transducers' time constant, .7 ms.
  expect(Math.hypot(place[0] + 0.01, place[1], place[2])).toBeLessThan(0.3e-3);
  expect(fateOf([flight], english)).toEqual([`The bead stays, at most ${(1000 * flight.farthest).toFixed(2)} mm from its point`]);
});

test("a bead that is carried too fast is lost, and is drawn until then", () => {
  const flights = flown([[0, 0, 0]], 40, 0.03);
  expect(flights[0].lost).toBeLessThan(0.5);
  expect(flights[0].places.some(Number.isNaN)).toBe(false);
  expect(flights[0].places.length / 3).toBeCloseTo(1000 * flights[0].lost!, -1);
  expect(beadsAt(flights, 0, 25, 1000)).toHaveLength(1);
  expect(beadsAt(flights, 999, 25, 1000)).toEqual([]);
  expect(fateOf(flights, english)).toEqual([`Bead 1 is lost after ${(1000 * flights[0].lost!).toFixed(0)} ms`]);
});

test("an opened scene keeps its bead: a heavy one strays farther", () => {
  const text = `
    signature = "trap"
    [array]
    preset = "openmpd_pair"
    [[points]]
    position = [0, 0, 0]
    [bead]
    radius = 1.2e-3
    density = 900
  `;
  door.open(text, true);
  const state = stateOf(JSON.parse(door.save(false)), initial);
  expect(state.bead).toMatchObject({ radius: 1.2e-3, density: 900 });
  const off = (bead: State["bead"]) => {
    door.open(JSON.stringify({ ...sceneOf({ ...state, bead }, 0), solver: { name: "glide", rate: 1000 } }));
    door.follow(framesOf(state.points, { kind: "circle", radius: 0.01, frequency: 4 }, 1000, 0.25), 250);
    return strayed(door.fly(0, 1000));
  };
  expect(off(state.bead)).toBeGreaterThan(4 * off(null));
}, SLOW);

test("a scene whose points are moved keeps its bead", () => {
  const bead = { radius: 1.2e-3, density: 900 };
  const text = { array: { preset: "openmpd_pair" }, points: [{ position: [0, 0, 0] }], signature: "trap", bead, solver: { name: "glide", rate: 1000 } };
  const flown = (moved: boolean) => {
    door.open(JSON.stringify(text));
    if (moved) door.move([[0, 0, 0]]);
    expect(JSON.parse(door.save(false)).bead).toMatchObject(bead);
    door.follow(framesOf([[0, 0, 0]], { kind: "circle", radius: 0.01, frequency: 4 }, 1000, 0.25), 250);
    return door.fly(0, 1000);
  };
  expect(flown(true)).toEqual(flown(false));
}, SLOW);

test("a rate that is none of frames is refused, and frames fly at another rate too", () => {
  const [flight] = flown([[0, 0, 0]], 4);
  for (const rate of [1e-300, 1e300, NaN, -1]) expect(() => door.fly(0, rate)).toThrow(/rate is .*: give/);
  expect(door.fly(0, 2000).places).toHaveLength(flight.places.length * 2);
}, SLOW);

test("frames that were not followed are not flown", () => {
  door.open(JSON.stringify({ array: { preset: "openmpd_pair" }, points: [{ position: [0, 0, 0] }] }));
  expect(() => door.fly(0, 1000)).toThrow(/drives is 0/);
});

test("lost beads are named by their time, those beyond three are counted, the others have their distance", () => {
  const flight = (lost: number | null, point: number): BeadFlight => ({ point, lost, farthest: 1.2e-4, places: new Float64Array(6) });
  const stays = flight(null, 1);
  expect(fateOf([stays, flight(null, 2)], english)).toEqual(["All beads stay, at most 0.12 mm from their points"]);
  expect(fateOf([flight(0.05, 0), stays, flight(0.034, 2)], english)).toEqual(["Bead 3 is lost after 34 ms", "Bead 1 is lost after 50 ms", "The others stay, at most 0.12 mm from their points"]);
  expect(fateOf([0.1, 0.2, 0.3, 0.4].map(flight), english).at(-1)).toBe("1 more are lost");
});

test("after the last lap it is flown again; balls have the size of a bead, or of some pixels", () => {
  const places = Float64Array.from({ length: 12 }, (_, k) => Math.floor(k / 3));
  const at = (frame: number) => beadsAt([{ lost: null, farthest: 0, places }], frame, 2, 1)[0][0];
  expect([0, 1, 2, 3, 4, 5, 6].map(at)).toEqual([0, 1, 2, 3, 2, 3, 2]);
  expect(balls([[1, 2, 3]], ([x]) => 1e-4 * x)).toEqual([{ center: [1, 2, 3], radius: 1e-3, kind: "rigid", tint: expect.any(Array) }]);
  expect(balls([[1, 2, 3]], () => 2e-3)[0]).toMatchObject({ radius: 7 * 2e-3 });
  expect(balls([[1, 2, 3]], () => 1e-5, 1.2e-3)[0]).toMatchObject({ radius: 1.2e-3 });
});

test("a lost bead falls from its last place for a quarter of a second, once", () => {
  const places = Float64Array.from([0, 0, 1, 0, 0, 1]);
  const at = (frame: number) => beadsAt([{ lost: 0.15, farthest: 0, places }], frame, 2, 10);
  expect([0, 1, 2, 3].map((frame) => at(frame)[0][2])).toEqual([1, 1, 1 - 4.905 * 0.01, 1 - 4.905 * 0.04]);
  expect([4, 5, 99].map(at)).toEqual([[], [], []]);
});
