/** Lettering: letters of single strokes, which make far fewer points than outlines. */

import { type Contour, placed } from "./contours.ts";
import strokes from "./strokes.json";
import type { Vec3 } from "./types.ts";

/** A capital is so many units high, and letters are so many apart. */
const HEIGHT = 6;
const GAP = 2;
const SPACE = 3;

/** Strokes of each letter: pairs of digits x, y in units from its lower left corner. */
const STROKES: Record<string, string> = strokes;

/** The strokes of a line of text, capitals `height` high or lower so that it is at most `width` wide, its middle at a place; m. */
export function letters(text: string, height: number, width: number, at: Vec3): Contour[] {
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
  const unit = Math.min(height / HEIGHT, width / Math.max(pen - GAP, 1));
  return placed(contours, [unit, unit], at);
}
