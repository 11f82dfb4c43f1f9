/** Pixels: a picture as points whose targets are the brightness of its pixels, like `midair.image` of the package. */

import { placeOn } from "../state/plane.ts";
import type { State, Vec3 } from "../state/types.ts";
import { refuse } from "../state/notice.ts";

/** A pixel below this part of white is dark and gives no point. */
const DARK = 0.05;

/** The target of a white pixel, in Pa. */
const WHITE = 1000;

/** Largest number of pixels along a side before averaging. */
const FINE = 1024;

/** Returns a function that computes the mean brightness, 0 to 1, of cells, rows from the top; transparent pixels are black. */
function brightness(bitmap: ImageBitmap): (columns: number, rows: number) => number[] {
  const scale = Math.min(1, FINE / Math.max(bitmap.width, bitmap.height));
  const [width, height] = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * scale)));
  const pen = new OffscreenCanvas(width, height).getContext("2d")!;
  pen.fillRect(0, 0, width, height);
  pen.drawImage(bitmap, 0, 0, width, height);
  const { data } = pen.getImageData(0, 0, width, height);
  return (columns, rows) => {
    const [sums, counts] = [new Float64Array(columns * rows), new Float64Array(columns * rows)];
    for (let y = 0, at = 0; y < height; y += 1)
      for (let x = 0; x < width; x += 1, at += 4) {
        const cell = Math.floor((y * rows) / height) * columns + Math.floor((x * columns) / width);
        sums[cell] += (0.299 * data[at] + 0.587 * data[at + 1] + 0.114 * data[at + 2]) / 255;
        counts[cell] += 1;
      }
    return [...sums].map((sum, k) => sum / (counts[k] || 1));
  };
}

/** Returns at most `most` points on the slice, at least `pitch` m apart; the longer side of the picture is `size` m. */
export async function pictured(file: Blob, plane: State["plane"], size: number, pitch: number, most: number): Promise<Pick<State, "points" | "pressures" | "filled">> {
  const bitmap = await createImageBitmap(file).catch(() => refuse("picture-unreadable"));
  const { width, height } = bitmap;
  const of = brightness(bitmap);
  for (let pixels = Math.max(1, Math.floor(size / pitch)); ; pixels -= 1) {
    const [columns, rows] = [width, height].map((side) => Math.max(1, Math.round((side * pixels) / Math.max(width, height))));
    const all = of(columns, rows).map((light, k) => ({ light, column: k % columns, row: Math.floor(k / columns) }));
    const lit = all.filter(({ light }) => light >= DARK);
    if (!lit.length) refuse("picture-dark");
    if (lit.length > most) continue;
    const step = size / pixels / plane.size;
    const points = lit.map(({ column, row }): Vec3 => placeOn(plane, 0.5 + (column - (columns - 1) / 2) * step, 0.5 - (row - (rows - 1) / 2) * step));
    const pressures = lit.map(({ light }) => Math.round(WHITE * light));
    return { points, pressures: new Set(pressures).size > 1 ? pressures : null, filled: [] };
  }
}
