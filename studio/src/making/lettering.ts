/** Lettering: letters of single strokes, which need far fewer points than outlines. */

import { type Contour, placed } from "./contours.ts";
import strokes from "./strokes.json";
import type { Vec3 } from "../state/types.ts";
import { refuse } from "../state/notice.ts";

/** In units of `strokes.json`: height of a capital, gap between letters, width of a blank, gap between lines. */
const HEIGHT = 6;
const GAP = 2;
const SPACE = 3;
const LEADING = 3;

/** Strokes of each letter: pairs of digits x, y in these units from its lower left corner. */
const STROKES: Record<string, string> = strokes;

/** Traced letters have more strokes, so a text that has some is this many times as high. */
const LARGER = 2;

/** A word or a line: its strokes from its lower left corner, and its width, in units. */
interface Line {
  contours: Contour[];
  width: number;
}

/** Returns the strokes of a letter that is not in STROKES, in a square of this height: x, y from its lower left corner. */
type Trace = (letter: string, height: number) => number[][][];

function word(text: string, trace: Trace): Line {
  const contours: Contour[] = [];
  let pen = 0;
  for (const letter of text) {
    const known = Object.hasOwn(STROKES, letter) && STROKES[letter].split(" ").map((stroke) => stroke.match(/../g)!.map((pair) => [...pair].map(Number)));
    const strokes = known || trace(letter, HEIGHT);
    const start = pen;
    contours.push(...strokes.map((stroke) => stroke.map(([x, y]): Vec3 => [start + x, y, 0])));
    pen += GAP + Math.max(...strokes.flat().map(([x]) => x));
  }
  return { contours, width: pen - GAP };
}

function refused(letter: string): never {
  return refuse("letter-unknown", { value: letter });
}

const shifted = (contours: Contour[], by: number, up: number) => contours.map((contour) => contour.map(([x, y, z]): Vec3 => [x + by, y + up, z]));

/** Joins words to one line. */
const joined = (words: Line[]): Line =>
  words.reduce((line, { contours, width }) => ({ contours: [...line.contours, ...shifted(contours, line.width + SPACE + GAP, 0)], width: line.width + SPACE + GAP + width }));

/** Breaks words into lines of at most this width; a single word can be wider. */
function wrapped(words: Line[], most: number): Line[] {
  const lines: Line[][] = [];
  for (const each of words) {
    const last = lines.at(-1);
    if (last && joined([...last, each]).width <= most) last.push(each);
    else lines.push([each]);
  }
  return lines.map(joined);
}

/**
 * Returns the strokes of a text, in m, with its middle at a place. Capitals have the given height (larger if letters are
 * traced), or less, so that the text is at most `width` wide and high. The text is broken at blanks where that makes its
 * letters larger. `trace` draws letters that are not in STROKES. `apart` is the least distance between letters.
 */
export function letters(text: string, height: number, width: number, at: Vec3, trace: Trace = refused): { contours: Contour[]; apart: number } {
  const plain = text.trim().toUpperCase().split(/\s+/).filter(Boolean);
  const high = plain.some((each) => [...each].some((letter) => !Object.hasOwn(STROKES, letter))) ? LARGER * height : height;
  const words = plain.map((each) => word(each, trace));
  if (!words.length) refuse("text-empty");
  const widths = words.flatMap((_, k) => words.slice(k).map((_, n) => joined(words.slice(k, k + n + 1)).width));
  const ways = widths.map((most) => {
    const lines = wrapped(words, most);
    const tall = lines.length * (HEIGHT + LEADING) - LEADING;
    return { lines, tall, unit: Math.min(high / HEIGHT, width / Math.max(...lines.map((line) => line.width), 1), width / tall) };
  });
  const { lines, tall, unit } = ways.toSorted((a, b) => b.unit - a.unit || a.lines.length - b.lines.length)[0];
  const middle = Math.max(...lines.map((line) => line.width)) / 2;
  const contours = lines.flatMap((line, k) => shifted(line.contours, middle - line.width / 2, tall - HEIGHT - k * (HEIGHT + LEADING)));
  return { contours: placed(contours, [unit, unit], at), apart: GAP * unit };
}
