/** Lettering: letters of single strokes, which make far fewer points than outlines. */

import { type Contour, placed } from "./contours.ts";
import strokes from "./strokes.json";
import type { Vec3 } from "./types.ts";

/** A capital is this many units high, letters are this many apart, and lines. */
const HEIGHT = 6;
const GAP = 2;
const SPACE = 3;
const LEADING = 3;

/** Strokes of each letter: pairs of digits x, y in units from its lower left corner. */
const STROKES: Record<string, string> = strokes;

/** Traced letters have more strokes: they are this many times as high. */
const LARGER = 2;

/** A word or line in units: its strokes from its lower left corner, and its width. */
interface Line {
  contours: Contour[];
  width: number;
}

/** The strokes of a letter that has none here, in a square of that height: x, y from its lower left corner. */
type Trace = (letter: string, height: number) => number[][][];

function word(text: string, trace: Trace): Line {
  const contours: Contour[] = [];
  let pen = 0;
  for (const letter of text) {
    const own = Object.hasOwn(STROKES, letter) && STROKES[letter].split(" ").map((stroke) => stroke.match(/../g)!.map((pair) => [...pair].map(Number)));
    const strokes = own || trace(letter, HEIGHT);
    const start = pen;
    contours.push(...strokes.map((stroke) => stroke.map(([x, y]): Vec3 => [start + x, y, 0])));
    pen += GAP + Math.max(...strokes.flat().map(([x]) => x));
  }
  return { contours, width: pen - GAP };
}

function refused(letter: string): never {
  throw new Error(`the text has "${letter}": give A to Z, 0 to 9, blanks and - + = / . : ! ? ♥`);
}

const shifted = (contours: Contour[], by: number, up: number) => contours.map((contour) => contour.map(([x, y, z]): Vec3 => [x + by, y + up, z]));

/** Words side by side. */
const joined = (words: Line[]): Line =>
  words.reduce((line, { contours, width }) => ({ contours: [...line.contours, ...shifted(contours, line.width + SPACE + GAP, 0)], width: line.width + SPACE + GAP + width }));

/** Lines of words, none wider than that if its words are not. */
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
 * The strokes of a text, capitals `height` high, larger where some are traced, or lower so that it is at most `width` wide and
 * high, its middle at a place; m.
 * It is broken at blanks where letters are larger then. `trace` draws what has no strokes here.
 * `apart`: how far letters are from one another at least, m.
 */
export function letters(text: string, height: number, width: number, at: Vec3, trace: Trace = refused): { contours: Contour[]; apart: number } {
  const plain = text.trim().toUpperCase().split(/\s+/).filter(Boolean);
  const high = plain.some((each) => [...each].some((letter) => !Object.hasOwn(STROKES, letter))) ? LARGER * height : height;
  const words = plain.map((each) => word(each, trace));
  if (!words.length) throw new Error("the text is empty: give at least a letter");
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
