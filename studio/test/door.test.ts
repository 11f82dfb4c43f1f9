// The WebAssembly binding: the drives of golden/, bit for bit, with both instruction sets; error messages; frames; boards. It
// has no imports.
import { readFileSync, readdirSync } from "node:fs";

import { expect, test } from "vitest";

import { compile, Door } from "../src/solving/door.ts";
import { boardOf } from "../src/boards/serial.ts";

const here = import.meta.dirname;
const module = await compile(readFileSync(`${here}/../built/midair.wasm`));
const door: Door = new Door(module);
const golden = `${here}/../../golden`;

/** Returns a scene file of six points on a ring over an array. */
function ring(name: string, more: object = {}) {
  const points = Array.from({ length: 6 }, (_, k) => ({ position: [0.03 * Math.cos(k), 0.03 * Math.sin(k), 0.15] }));
  return JSON.stringify({ array: { preset: "sonicsurface" }, points, solver: { name }, ...more });
}

test("the module asks its surroundings for nothing", () => {
  expect(WebAssembly.Module.imports(module)).toEqual([]);
});

test.each(readdirSync(golden).filter((name) => name.endsWith(".json")))("the drive of golden/%s", (name) => {
  const text = readFileSync(`${golden}/${name}`, "utf8");
  const record = JSON.parse(text);
  // The text is used unparsed, because a JavaScript number cannot store a seed of 64 bits.
  const scene = text.slice(text.indexOf('"scene":') + 8, text.lastIndexOf("}"));
  const requested = scene.replace('"solver":{', `"solver":{"balance":${record.balance},`);
  const wanted = Float32Array.from(record.drive.flat());
  door.open(requested);
  expect(door.solve().drive).toEqual(wanted);
});

test("a field at the points is what the answer says", () => {
  door.open(ring("uniform"));
  const { pressures, scale } = door.solve();
  const places = Float64Array.from(JSON.parse(ring("uniform")).points.flatMap((point: { position: number[] }) => point.position));
  const field = door.field(places);
  const largest = Math.max(...pressures.map(([re, im]) => Math.hypot(re, im)));
  expect(scale).toBeGreaterThan(0);
  pressures.forEach(([re, im], j) => {
    expect(Math.hypot(field[2 * j] - re, field[2 * j + 1] - im) / largest).toBeLessThan(1e-3);
  });
});

test("a drive that is loaded with its scale is as loud as the answer was", () => {
  const points = [{ position: [0, 0, 0.15], pressure: 40 }, { position: [0.03, 0, 0.15], pressure: 30 }];
  door.open(ring("uniform", { points, solver: { name: "uniform", balance: true } }));
  const { drive, scale, metrics, pressures } = door.solve();
  expect(scale).toBeLessThan(0.5);
  door.load(drive, scale);
  expect(door.judge().metrics.level).toBeCloseTo(metrics.level, 4);
  const { pressure } = door.probe([0, 0, 0.15]);
  expect(Math.hypot(...pressure) / Math.hypot(...pressures[0])).toBeCloseTo(1, 3);
  door.load(drive);
  expect(door.judge().metrics.level * scale).toBeCloseTo(metrics.level, 4);
});

test("no drive exceeds the bound", () => {
  door.open(ring("uniform"));
  const { metrics } = door.solve();
  expect(door.bound()).toBeGreaterThan(metrics.level * metrics.uniformity);
});

test("a scene that was saved is the same scene", () => {
  door.open(ring("greedy", { medium: { temperature: 25 } }));
  const [toml, drive] = [door.save(true), door.solve().drive];
  door.open(toml, true);
  expect(door.solve().drive).toEqual(drive);
});

test("refusals are one line, and the scene before stays open", () => {
  door.open(ring("uniform"));
  expect(() => door.open('{"array": {"preset": "sonic"}, "points": []}')).toThrow(/sonic/);
  expect(() => door.open(ring("unifrom"))).toThrow(/unifrom/);
  expect(() => door.open("[array", true)).toThrow(/^[^\n]+$/);
  expect(() => door.load([1, 0])).toThrow(/256/);
  expect(() => door.encode("sonicsurfice")).toThrow(/sonicsurfice/);
  expect(door.solve().metrics.uniformity).toBeGreaterThan(0.9);
});

test("frames follow one another within glide's change", () => {
  door.open(ring("glide", { points: [{ position: [0, 0, 0.15] }], array: { preset: "paper20" } }));
  const frames = 20;
  const places = Float64Array.from({ length: 3 * frames }, (_, k) => [1e-4 * Math.floor(k / 3), 0, 0.15][k % 3]);
  const tracked = door.follow(places, frames);
  expect(Math.max(...tracked.map(({ change }) => change))).toBeLessThan(Math.PI / 16 + 1e-4);
  expect(door.frame(19)).not.toEqual(door.frame(0));
  expect(() => door.frame(20)).toThrow(/frame is 20/);
});

test("a quiet point is not the weakest of a frame", () => {
  const points = [
    { position: [0, 0, 0.15], pressure: 1000 },
    { position: [0.03, 0, 0.15], pressure: 0 },
  ];
  door.open(ring("glide", { points }));
  const places = Float64Array.from(Array.from({ length: 5 }, () => [0, 0, 0.15, 0.03, 0, 0.15]).flat());
  for (const { least, most } of door.follow(places, 5)) {
    expect(least).toBe(most);
    expect(least).toBeGreaterThan(500);
  }
});

test("a skin under a circle is felt as the record has it", () => {
  const record = JSON.parse(readFileSync(`${golden}/touch/ring.json`, "utf8"));
  const { frames, rate, radius, height, size, side } = record;
  door.open(JSON.stringify({ array: { preset: record.array }, points: [{ position: [radius, 0, height] }], solver: { name: record.solver } }));
  const circle = Array.from({ length: frames }, (_, t) => (2 * Math.PI * t) / frames);
  door.follow(Float64Array.from(circle.flatMap((angle) => [radius * Math.cos(angle), radius * Math.sin(angle), height])), frames);
  const along = (k: number) => (k / (side - 1) - 0.5) * size;
  const places = Float64Array.from({ length: 3 * side * side }, (_, k) => {
    const place = Math.floor(k / 3);
    return [along(place % side), along(Math.floor(place / side)), height][k % 3];
  });
  const { width, peak, force, strengths, pushes } = door.skin(places, rate);
  expect(20 * Math.log10(Math.max(...strengths))).toBeCloseTo(record.level, 1);
  expect(width).toBeCloseTo(record.width, 6);
  // Less than a fifth of the pressure at 56 Hz passes the channel of pressure.
  expect(pushes.length).toBe(side * side);
  expect(force / (9 * pushes.reduce((a, b) => a + b) * (size / (side - 1)) ** 2)).toBeCloseTo(1, 6);
  expect(force).toBeGreaterThan(0.01);
  record.places.forEach((place: number, k: number) => {
    const [slow, fast] = [record.slow[k], record.fast[k]];
    const exact = Math.max(slow, fast) + Math.min(slow, fast) / 2;
    expect(Math.abs(strengths[place] - exact) / exact).toBeLessThan(3e-3);
    // The motion is the sum of the lines.
    const lines = record.displacement[k] as [number, number][];
    for (const frame of [0, 17]) {
      const moved = lines.map(([re, im], l) => re * Math.cos(frame * (l + 1) * circle[1]) - im * Math.sin(frame * (l + 1) * circle[1])).reduce((a, b) => a + b);
      expect(Math.abs(door.moved(frame)[place] - moved)).toBeLessThan(5e-3 * peak);
    }
  });
  expect(() => door.moved(frames)).toThrow(/frame is 72: predict the skin's motion first/);
  expect(() => door.skin(places, frames * 501)).toThrow(/^laps is 501 a second: give at most 500/);
  expect(() => door.skin(places.subarray(0, 15), rate)).toThrow(/^places is 5: give the square/);
});

test("a board's bytes", () => {
  door.open(ring("uniform"));
  door.solve();
  expect(door.encode("sonicsurface").length).toBeGreaterThan(256);
  expect(door.silence("sonicsurface")).not.toEqual(door.encode("sonicsurface"));
});

test("boards at a serial port, by the arrays that they play", () => {
  const catalogue = door.catalogue();
  const baud = (preset: string) => boardOf(catalogue, preset)?.baud;
  expect(["sonicsurface_pair", "ultraino_flat8x8"].map(baud)).toEqual([230400, 115200]);
  const restarts = (preset: string) => boardOf(catalogue, preset)?.restarts;
  expect(["sonicsurface_pair", "ultraino_flat8x8"].map(restarts)).toEqual([false, true]);
  expect(["autd3", "openmpd_pair", "nothing"].map(baud)).toEqual([undefined, undefined, undefined]);
});

test("a trap that moves has the pressure that it has at rest, around its point", () => {
  const array = { preset: "openmpd_pair" };
  const points = [[-0.02, 0, 0], [0.02, 0.01, 0]];
  for (const [signature, dark] of [["trap", 2], [["trap", "focus"], 1]] as const) {
    door.open(JSON.stringify({ array, points: points.map((position) => ({ position })), signature, solver: { name: "glide", rate: 1000 } }));
    const rest = Math.min(...door.solve().pressures.map((p) => Math.hypot(...p)));
    const frames = 20;
    const circle = Array.from({ length: frames }, (_, t) => (2 * Math.PI * t) / frames);
    const places = circle.flatMap((turn) => points.flatMap(([x, y, z]) => [x + 2e-4 * Math.cos(turn), y, z + 2e-4 * Math.sin(turn)]));
    for (const { least } of door.follow(Float64Array.from(places), frames)) expect(Math.abs(least / rest - 1)).toBeLessThan(0.1);
    door.load(door.frame(0));
    expect(Math.abs(Math.min(...door.judge().pressures.map((p) => Math.hypot(...p))) / rest - 1)).toBeLessThan(0.1);
    expect(points.filter((_, k) => Math.hypot(...door.field(Float64Array.from(points[k]))) < 0.2 * rest)).toHaveLength(dark);
  }
});
