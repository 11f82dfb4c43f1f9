/** Files: arrays and drives as CSV, in the package's own formats (docs/conventions.md, "Files"). */

import { decimal } from "./decimal.ts";
import type { Vec3 } from "./types.ts";

/** An array of one's own: metres, and unit vectors whither each transducer radiates. */
export type OwnArray = { name: string; positions: Vec3[]; normals: Vec3[] };

const MOST_TRANSDUCERS = 16384;
/** Nobody's array is larger, and no two transducers are nearer or all farther apart (5 wavelengths), in m. */
const LARGEST = 10;
const NEAREST = 0.0004;
const SPARSE = 0.0425;

const AXES = ["x", "y", "z"];
const NORMALS = ["nx", "ny", "nz"];
const CURE = "give x,y,z in m, or x,y,z,nx,ny,nz";
const DRIVE_CURE = "give index,x,y,z,amplitude,phase or index,amplitude,phase";
/** An amplitude of 1 may have been rounded. */
const ROUNDING = 1e-6;

type Row = { line: number; cells: string[] };

function fault(name: string, line: number | null, reason: string): never {
  throw new Error(line === null ? `${name}: ${reason}` : `${name}, line ${line}: ${reason}`);
}

/** Rows of cells between commas, semicolons or tabs, without empty lines and those that begin with #. */
function rowsOf(text: string): Row[] {
  const lines = text.replace(/^\ufeff/, "").split(/\r?\n/);
  const rows = lines.map((content, index) => {
    const separator = [";", "\t"].find((each) => content.includes(each)) ?? ",";
    const cells = content.split(separator).map((cell) => cell.trim().replace(/^"|"$/g, "").trim());
    return { line: index + 1, cells };
  });
  return rows.filter((_, index) => /^\s*[^\s#]/.test(lines[index]));
}

function picked(name: string, row: Row, names: string[], columns: number[]): number[] {
  return columns.map((column, k) => {
    const cell = row.cells[column] ?? "";
    const value = decimal(cell);
    if (Number.isFinite(value)) return value;
    return fault(name, row.line, `${names[k]} is "${cell.slice(0, 40)}": give a number`);
  });
}

/** Where each of the names stands in a first row of names. */
function columnsOf(name: string, row: Row, names: string[], cure: string): number[] {
  const given = row.cells.map((cell) => cell.toLowerCase());
  const columns = names.map((each) => given.indexOf(each));
  const missing = names[columns.indexOf(-1)];
  return missing ? fault(name, row.line, `no column is named ${missing}: ${cure}`) : columns;
}

/**
 * The array of a CSV: a row x,y,z or x,y,z,nx,ny,nz in m for each transducer, a row of names first or not.
 *
 * Normals are made unit vectors, +z where left out. An error is one line that names file, line and cure.
 */
export function readArray(text: string, name: string): OwnArray {
  const rows = rowsOf(text);
  if (!rows.length) fault(name, null, `no row is in it: ${CURE} for each transducer`);
  const first = rows[0];
  const every = [...AXES, ...NORMALS];
  const header = Number.isNaN(decimal(first.cells[0]));
  const count = first.cells.length;
  if (!header && count !== 3 && count !== 6) fault(name, first.line, `${count} columns: ${CURE}`);
  const turned = header ? first.cells.some((cell) => NORMALS.includes(cell.toLowerCase())) : count === 6;
  const names = turned ? every : AXES;
  const columns = header ? columnsOf(name, first, names, CURE) : names.map((_, k) => k);
  const body = header ? rows.slice(1) : rows;
  if (!body.length) fault(name, null, `no row is in it: ${CURE} for each transducer`);
  const most = MOST_TRANSDUCERS;
  if (body.length > most) fault(name, null, `${body.length} rows: give at most ${most}`);
  const table = body.map((row) => picked(name, row, names, columns));
  const positions = table.map((row) => row.slice(0, 3) as Vec3);
  checkUnit(name, positions);
  const normals = table.map((row, k) => unit(name, body[k].line, turned ? row.slice(3) : [0, 0, 1]));
  return { name, positions, normals };
}

function unit(name: string, line: number, normal: number[]): Vec3 {
  const length = Math.hypot(...normal);
  if (length === 0) fault(name, line, "nx,ny,nz is 0,0,0: give a direction such as 0,0,1");
  return normal.map((x) => x / length) as Vec3;
}

function checkUnit(name: string, positions: Vec3[]): void {
  const extents = [0, 1, 2].map((axis) => {
    const along = positions.map((at) => at[axis]);
    return along.reduce((a, b) => Math.max(a, b)) - along.reduce((a, b) => Math.min(a, b));
  });
  const extent = Math.max(...extents);
  const metres = "give positions in m, not in another unit";
  if (extent > LARGEST) fault(name, null, `the array is ${extent.toPrecision(3)} m large: ${metres}`);
  const near = nearest(positions);
  if (near < NEAREST || (near > SPARSE && near < Infinity)) {
    fault(name, null, `the nearest two transducers are ${Number(near.toPrecision(3))} m apart: ${metres}`);
  }
}

/** The distance of the nearest two places; Infinity of one. */
function nearest(places: Vec3[]): number {
  const sorted = places.toSorted((a, b) => a[0] - b[0]);
  let least = Infinity;
  for (let i = 0; i < sorted.length; i += 1) {
    const [x, y, z] = sorted[i];
    for (let j = i + 1; j < sorted.length && sorted[j][0] - x < least; j += 1) {
      least = Math.min(least, Math.hypot(sorted[j][0] - x, sorted[j][1] - y, sorted[j][2] - z));
    }
  }
  return least;
}

/** A number as Python writes it: the shortest that is read back to the same. */
function shortest(x: number): string {
  const size = Math.abs(x);
  if (size < 1e-4 && size > 0) return x.toExponential().replace(/e([+-])(\d)$/, "e$10$2");
  return Number.isInteger(x) ? `${Object.is(x, -0) ? "-" : ""}${x}.0` : String(x);
}

/** The CSV of `midair solve -o drive.csv`: positions (N) in m, a drive (N of re, im), phases in rad. */
export function writeDrive(positions: Vec3[], drive: Float32Array): string {
  const turn = 2 * Math.PI;
  const rows = positions.map((at, k) => {
    const [re, im] = drive.subarray(2 * k, 2 * k + 2);
    // Twice, because -1e-17 and a whole turn are a whole turn.
    const phase = ((Math.atan2(im, re) + turn) % turn) % turn;
    return [k, ...[...at, Math.hypot(re, im), phase].map(shortest)].join();
  });
  return `${["index,x,y,z,amplitude,phase", ...rows].join("\n")}\n`;
}

/** The drive (N of re, im) of such a CSV; positions are passed over. */
export function readDrive(text: string): Float32Array {
  const name = "drive";
  const rows = rowsOf(text);
  if (!rows.length) fault(name, null, `it is empty: ${DRIVE_CURE}`);
  const [head, ...body] = rows;
  const indexed = head.cells.some((cell) => cell.toLowerCase() === "index");
  const names = ["amplitude", "phase", ...(indexed ? ["index"] : [])];
  const columns = columnsOf(name, head, names, DRIVE_CURE);
  if (!body.length) fault(name, null, `no drive is in it: ${DRIVE_CURE}`);
  const drive = new Float32Array(2 * body.length);
  body.forEach((row, k) => {
    const [amplitude, phase, index] = picked(name, row, names, columns);
    if (indexed && index !== k) {
      fault(name, row.line, `index is ${index}: give ${k}, a row for every transducer`);
    }
    if (!(amplitude >= 0 && amplitude <= 1 + ROUNDING)) {
      fault(name, row.line, `amplitude is ${amplitude}: give 0 to 1`);
    }
    drive.set([amplitude * Math.cos(phase), amplitude * Math.sin(phase)], 2 * k);
  });
  return drive;
}
