import { expect, test } from "vitest";
import { initial } from "../src/state/initial.ts";
import { readLink, writeLink } from "../src/state/link.ts";
import type { Vec3 } from "../src/state/types.ts";
import { generator, randomState } from "./random.ts";

const round = (x: number) => Math.round(x * 1e5) / 1e5;

test("200 random states survive exactly", () => {
  const random = generator(1);
  for (let index = 0; index < 200; index += 1) {
    const state = randomState(random);
    expect(readLink(writeLink(state))).toEqual(state);
    expect(readLink(`#${encodeURIComponent(writeLink(state))}`)).toEqual(state);
  }
});

test("the first state is a short link, and no link is the first state", () => {
  expect(writeLink(initial)).toMatch(/^v=1&a=autd3\.2x2&l=board&t=25&m=uniform\.naive&p=40,0,180_/);
  expect(readLink(writeLink(initial))).toEqual(initial);
  expect(readLink("")).toEqual(initial);
  expect(readLink("#")).toEqual(initial);
});

test("what is left out is as at the beginning, and a reader cannot change that", () => {
  const state = readLink("#v=1&p=1,2,3.456,1e3&a=sonicsurface&z=100,90,5,-6");
  expect(state.points).toEqual([[0.001, 0.002, 0.003456]]);
  expect(state.pressures).toEqual([1000]);
  expect(state.array).toEqual({ preset: "sonicsurface", tiles: [1, 1] });
  expect(state.plane).toEqual({ axis: "z", z: 0.1, size: 0.09, center: [0.005, -0.006] });
  expect(state.methods).toEqual(initial.methods);
  state.methods[0] = "gs";
  expect(initial.methods[0]).toBe("uniform");
});

test("an upright slice is written, wherever its normal stands in the link", () => {
  const plane = { axis: "x" as const, z: 0.1, size: 0.09, center: [0.005, -0.006] as [number, number] };
  expect(writeLink({ ...initial, plane })).toContain("&z=100,90,5,-6&n=x");
  for (const link of ["v=1&z=100,90,5,-6&n=x", "v=1&n=x&z=100,90,5,-6"]) expect(readLink(link).plane).toEqual(plane);
  expect(() => readLink("v=1&n=w")).toThrow("x, y, z");
});

test("64 points are at most 1.3 kB", () => {
  const random = generator(2);
  const place = () => round(0.3 * random() - 0.15);
  const points = Array.from({ length: 64 }, () => [place(), place(), 0.18] as Vec3);
  expect(writeLink({ ...initial, points }).length).toBeLessThan(1300);
});

test("an array of one's own is written", () => {
  const bowl = { name: "bowl", positions: [[0, 0, 0]] as Vec3[], normals: [[1, 0, 0]] as Vec3[] };
  const masked = { preset: "autd3", tiles: [1, 1] as [number, number], parts: { mask: [true] } };
  for (const array of [bowl, masked]) expect(() => readLink(writeLink({ ...initial, array }))).toThrow(`a is "own": an array of one's own is in no link, load its file`);
  const two = { name: "array", positions: [[-0.017, 0, 0], [0.017, 0, 0.001]] as Vec3[], normals: [[0, 0, 1], [0, 0, 1]] as Vec3[] };
  expect(writeLink({ ...initial, array: two })).toContain("&a=-17,0,0_17,0,1&");
  expect(readLink(writeLink({ ...initial, array: two })).array).toEqual(two);
});

const many = (count: number, each: string) => Array.from({ length: count }, () => each).join("_");
const BAD: [string, string][] = [
  ["hello", "the link's part"],
  ["a=autd3", "begin with v=1"],
  ["v=2", "v=1"],
  ["v=1&v=1", "once"],
  ["v=1&q=3", "a key"],
  ["v=1&constructor=3", "a key"],
  ["v=1&&t=3", "key=value"],
  ["v=1&a=", "preset"],
  ["v=1&a=own", "file"],
  ["v=1&a=autd3.2", "preset"],
  ["v=1&a=autd3.0x2", "boards of a"],
  ["v=1&a=autd3.99x2", "boards of a"],
  ["v=1&a=../../x", "preset"],
  ["v=1&l=full", "board, none"],
  ["v=1&t=", "number"],
  ["v=1&t=hot", "number"],
  ["v=1&t=0x10", "number"],
  ["v=1&t=100", "number"],
  ["v=1&m=uniform", "two methods"],
  ["v=1&m=uniform.naive.gs", "two methods"],
  ["v=1&p=1,2", "point 1"],
  ["v=1&p=1,2,3_1,2", "point 2"],
  ["v=1&p=1,2,3_", "point 2"],
  ["v=1&p=1,2,3_1,2,x", "point 2"],
  ["v=1&p=1,2,NaN", "point 1"],
  ["v=1&p=1,2,Infinity", "point 1"],
  ["v=1&p=1,2,3,4_1,2,3", "every point"],
  ["v=1&p=1,2,3,-4", "pressure of point 1"],
  [`v=1&p=${many(65, "1,2,3")}`, "65 points"],
  ["v=1&z=180", "height,size"],
  ["v=1&z=180,0", "size of z"],
  ["v=1&w=all", "slice, planes, volume, both"],
  ["v=1&d=real", "modulus, wave, phase"],
  ["v=1&c=jet", "viridis"],
  ["v=1&k=log", "linear"],
  ["v=1&s=c", "a, b"],
  ["v=1&f=bottle", "trap"],
  ["v=1&o=wall,1,2,3", "obstacle 1"],
  ["v=1&o=wall,1,2,3,0,0,0,rigid", "normal of obstacle 1"],
  ["v=1&o=ball,1,2,3,-4,rigid", "radius of obstacle 1"],
  ["v=1&o=ball,1,2,3,4,hard", "kind of obstacle 1"],
  [`v=1&o=${many(65, "ball,1,2,3,4,soft")}`, "65 obstacles"],
  ["v=1&b=1,900", "b is"],
  ["v=1&b=0,900,900,0,0,-9.81", "radius of b"],
  ["v=1&x=greedy", "give JSON"],
  ['v=1&x={"greedy":3}', "give JSON"],
  ["v=1&g=circle,5,0", "frequency of g"],
  ["v=1&e=1,2", "e is"],
  ["v=1&g=square,1,2", "circle, line"],
  ["v=1&g=circle,0,2", "size of g"],
  ["v=1&g=circle,5,-2", "frequency of g"],
  [`v=1&l=${"x\n".repeat(500)}`, "l is"],
];

test("a broken % is a notice, which the page translates", () => {
  expect(() => readLink("v=1&t=%E0%A4")).toThrow(/^the link has a broken "%": copy it once more$/);
});

test.each(BAD)("one line: %s", (link, part) => {
  let reason = "";
  expect(() => {
    try {
      readLink(link);
    } catch (error) {
      reason = (error as Error).message;
      throw error;
    }
  }).toThrow(part);
  expect(reason.split("\n")).toHaveLength(1);
  expect(reason.length).toBeLessThan(140);
});
