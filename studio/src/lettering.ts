/** Lettering: letters of single strokes, which make far fewer points than outlines. */

import { type Contour, placed } from "./contours.ts";
import type { Vec3 } from "./types.ts";

/** A capital is so many units high, and letters are so many apart. */
const HEIGHT = 6;
const GAP = 2;
const SPACE = 3;

/** Strokes of each letter: pairs of digits x, y in units from its lower left corner. */
const STROKES: Record<string, string> = {
  A: "0004264440 0242",
  B: "00063645443303 3342413000",
  C: "4536160501103041",
  D: "00063645413000",
  E: "46060040 0333",
  F: "460600 0333",
  G: "45361605011030414323",
  H: "0006 4046 0343",
  I: "0006",
  J: "4641301001",
  K: "0006 460340",
  L: "060040",
  M: "0006234640",
  N: "00064046",
  O: "103041453616050110",
  P: "00063645443303",
  Q: "103041453616050110 2240",
  R: "00063645443303 2340",
  S: "453616050413334241301001",
  T: "0646 2620",
  U: "060110304146",
  V: "062046",
  W: "0610233046",
  X: "0046 0640",
  Y: "062346 2320",
  Z: "06460040",
  0: "103041453616050110",
  1: "051610",
  2: "05163645440040",
  3: "0516364544334241301001 1333",
  4: "30360242",
  5: "460603334241301001",
  6: "4536160501103041423303",
  7: "064610",
  8: "130405163645443313 130201103041423313",
  9: "0110304145361605041343",
  "-": "0323",
  "+": "0343 2125",
  "=": "0242 0444",
  "/": "0046",
  ".": "00",
  ":": "01 04",
  "!": "0206 00",
  "?": "05163645442322 20",
  "♥": "200305162536454320",
};

/** The strokes of a line of text, capitals `height` high, its middle at a place; m. */
export function letters(text: string, height: number, at: Vec3): Contour[] {
  const unit = height / HEIGHT;
  const contours: Contour[] = [];
  let pen = 0;
  for (const letter of text.trim().toUpperCase()) {
    if (letter === " ") {
      pen += SPACE;
      continue;
    }
    if (!Object.hasOwn(STROKES, letter)) {
      throw new Error(`the text has "${letter}": give A to Z, 0 to 9, blanks and - + = / . : ! ? ♥`);
    }
    const strokes = STROKES[letter].split(" ").map((stroke) => stroke.match(/../g)!);
    const start = pen;
    contours.push(...strokes.map((stroke) => stroke.map(([x, y]): Vec3 => [start + +x, +y, 0])));
    pen += GAP + Math.max(...strokes.flat().map(([x]) => +x));
  }
  if (!contours.length) throw new Error("the text is empty: give at least a letter");
  return placed(contours, [unit, unit], at);
}
