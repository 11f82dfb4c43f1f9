// Arrays and drives as CSV, read and written by the core.
import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { compile, Door } from "../src/solving/door.ts";
import type { Vec3 } from "../src/state/types.ts";

const door = new Door(await compile(readFileSync(new URL("../built/midair.wasm", import.meta.url))));
const readDrive = (text: string) => door.readDrive(text, "drive");

/** Returns the CSV of a drive of transducers at these positions. */
function writeDrive(positions: Vec3[], drive: Float32Array): string {
  // JSON.stringify writes -0 as 0.
  const places = positions.map((at) => `[${at.map((x) => (Object.is(x, -0) ? "-0.0" : x))}]`);
  door.open(`{"array": {"positions": [${places}]}, "points": [{"position": [0, 0, 0.2]}]}`);
  door.load(drive);
  return door.writeDrive();
}

const DRIVE = readFileSync(new URL("drive.csv", import.meta.url), "utf8");
const FLAT: Vec3[] = [[0, 0, 0], [0.01, 0, 0]];
const UP: Vec3[] = [[0, 0, 1], [0, 0, 1]];

test.each([
  ["0,0,0\n0.01,0,0\n", FLAT, UP],
  ["\ufeffx;y;z\r\n0;0;0\r\n0.01;0;0\r\n", FLAT, UP],
  ["# mine\n\nz\tname\tY\tx\n0\ta\t0\t0\n  # more\n0\tb\t0\t1e-2\n", FLAT, UP],
  ['"x","y","z","nx","ny","nz"\n0,0,0,0,0,-2\n0.01,0,0,0,3,4\n', FLAT, [[0, 0, -1], [0, 0.6, 0.8]]],
  ["0,0,0,0,0,5", [[0, 0, 0]], [[0, 0, 1]]],
])("arrays are read: %j", (text, positions, normals) => {
  const array = door.readArray(text, "a.csv");
  expect(array.name).toBe("a.csv");
  expect(array.positions).toEqual(positions);
  expect(array.normals.map((each) => each.map((x) => x + 0))).toEqual(normals);
});

test.each([
  ["", "a.csv: empty: give rows x,y,z in metres"],
  ["# nothing\n", "a.csv: empty: give rows"],
  ["x,y,z\n", "a.csv: empty: give rows"],
  ["x,x,y,z\n0,0,0,0\n", 'a.csv, line 1: column "x" is there twice'],
  ["1,2\n", "a.csv, line 1: 2 columns"],
  ["0,0,0,0\n", "a.csv, line 1: 4 columns"],
  ["x,y,w\n0,0,0\n", "a.csv, line 1: columns are x, y, w: name them x,y,z"],
  ["x,y,z,nx\n0,0,0,1\n", "a.csv, line 1: columns are x, y, z, nx: name them"],
  ["0,0,0\n\n0.01,abc,0\n", 'a.csv, line 3: y is "abc": give a number'],
  ["0,0,0\n0.01,0\n", 'a.csv, line 2: z is "": give a number'],
  ["0,0,0\nInfinity,0,0\n", 'a.csv, line 2: x is "Infinity"'],
  ["0,0,0,0,0,1\n0.01,0,0,0,0,0\n", "a.csv: array.normals[1] is "],
  ["-80,0,0\n80,0,0\n", "a.csv: array.positions is "],
  ["0,0,0\n1,0,0\n", "a.csv: array.positions is "],
  ["0,0,0\n1e-5,0,0\n", "a.csv: array.positions is "],
  ["0,0,0\n0,0,0\n", "a.csv: array.positions is "],
  [Array.from({ length: 16385 }, (_, k) => `${(k % 128) / 100},${(k >> 7) / 100},0`).join("\n"), "a.csv: 16385 rows"],
])("faults of arrays are one line: %#", (text, line) => {
  expect(() => door.readArray(text, "a.csv")).toThrow(line);
});

test("a drive that the package wrote is written alike", () => {
  const drive = readDrive(DRIVE);
  const rows = DRIVE.trim().split("\n").slice(1).map((row) => row.split(",").map(Number));
  const positions = rows.map(([, x, y, z]): Vec3 => [x, y, z]);
  const again = writeDrive(positions, drive).split("\n");
  DRIVE.split("\n").forEach((row, k) => {
    const [here, there] = [again[k].split(","), row.split(",")];
    expect(here.slice(0, 4)).toEqual(there.slice(0, 4));
    // Amplitudes and phases are from the drive, which has single precision.
    if (k > 0) here.slice(4).forEach((cell, c) => expect(Number(cell)).toBeCloseTo(Number(there[c + 4]), 6));
  });
  expect(again[0]).toBe("index,x,y,z,amplitude,phase");
  expect(readDrive(writeDrive(positions, drive))).toEqual(drive);
});

test("numbers are written as Python writes them", () => {
  const positions: Vec3[] = [[-0, 1e-5, 0.00012], [1, -2.5e-12, 0.1]];
  const text = writeDrive(positions, new Float32Array([1, 0, 0, -1]));
  expect(text).toBe(
    "index,x,y,z,amplitude,phase\n0,-0.0,1e-05,0.00012,1.0,0.0\n1,1.0,-2.5e-12,0.1,1.0,4.71238898038469\n",
  );
});

test.each([
  ["", "drive: empty: give rows amplitude,phase"],
  ["index,amplitude\n0,1\n", "drive, line 1: columns are index, amplitude: name them"],
  ["amplitude,phase\n", "drive: empty: give rows amplitude,phase"],
  ["amplitude,phase\n2,0\n", "drive, line 2: amplitude is 2: give 0 to 1"],
  ["index,amplitude,phase\n0,1,0\n2,1,0\n", "drive, line 3: index is 2: give 1"],
  ["amplitude,phase\n1,x\n", 'drive, line 2: phase is "x"'],
])("faults of drives are one line: %j", (text, line) => {
  expect(() => readDrive(text)).toThrow(line);
});
