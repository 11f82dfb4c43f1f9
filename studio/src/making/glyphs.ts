/** Glyphs: draws a character, such as a kanji, in a font of the browser, and thins it to single strokes. */

import { refuse } from "../state/notice.ts";

/** Pixels along the side of a character's square. */
const FINE = 72;

/** Strokes shorter than this, in pixels, are artefacts of the thinning, unless they are isolated. */
const SPUR = 6;

/** Distance of a stroke's vertices, in pixels. */
const STEP = 3;

/** Length of a row of pixels, with an empty border on both sides. */
const ROW = FINE + 2;

/** Index offsets to the eight neighbours of a pixel, clockwise from above. */
const AROUND = [-ROW, 1 - ROW, 1, 1 + ROW, ROW, ROW - 1, -1, -1 - ROW];

/** A character without a glyph in any font. */
const NOWHERE = "\u{10ffff}";

/** Returns 1 for each pixel with ink and 0 for others, rows from the top. */
function inked(letter: string): Uint8Array {
  const pen = new OffscreenCanvas(FINE, FINE).getContext("2d", { willReadFrequently: true })!;
  pen.font = `${0.86 * FINE}px system-ui, "Hiragino Sans", "Noto Sans CJK JP", sans-serif`;
  const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down } = pen.measureText(letter);
  pen.fillText(letter, (FINE + left - right) / 2, (FINE + up - down) / 2);
  const { data } = pen.getImageData(0, 0, FINE, FINE);
  const ink = new Uint8Array(ROW * ROW);
  for (let y = 0; y < FINE; y += 1) for (let x = 0; x < FINE; x += 1) ink[(y + 1) * ROW + x + 1] = Number(data[4 * (y * FINE + x) + 3] > 127);
  return ink;
}

/** Neighbours of the two passes of `thin`: a pixel stays if all three neighbours of one triple have ink. */
const PASSES = [[[0, 2, 4], [2, 4, 6]], [[0, 2, 6], [0, 4, 6]]];

/** Thins ink to lines of one pixel, by Zhang and Suen 1984. */
function thin(ink: Uint8Array): void {
  for (let left = PASSES.length, pass = 0; left; pass = 1 - pass) {
    const off = [...ink.keys()].filter((at) => {
      if (!ink[at]) return false;
      const near = AROUND.map((way) => ink[at + way]);
      const count = near.reduce((a, b) => a + b);
      const rises = near.filter((each, k) => !each && near[(k + 1) % 8]).length;
      return count >= 2 && count <= 6 && rises === 1 && PASSES[pass].every((three) => three.some((k) => !near[k]));
    });
    for (const at of off) ink[at] = 0;
    left = off.length ? PASSES.length : left - 1;
  }
}

/** Returns the lines of thinned ink as pixels, each from an end or crossing to the next. */
function lines(ink: Uint8Array): number[][] {
  const beside = (at: number) => AROUND.filter((way, k) => ink[at + way] && (k % 2 === 0 || !(ink[at + AROUND[k - 1]] || ink[at + AROUND[(k + 1) % 8]]))).map((way) => at + way);
  const next = new Map([...ink.keys()].filter((at) => ink[at]).map((at) => [at, beside(at)]));
  const count = (at: number) => next.get(at)!.length;
  const walked = new Set<string>();
  const walk = (path: number[]) => {
    for (;;) {
      const [before, at] = path.slice(-2);
      walked.add(`${before} ${at}`).add(`${at} ${before}`);
      const on = count(at) === 2 && at !== path[0] ? next.get(at)!.find((other) => other !== before) : undefined;
      if (on === undefined) return path;
      path.push(on);
    }
  };
  const from = (at: number) => next.get(at)!.filter((other) => !walked.has(`${at} ${other}`)).map((other) => (walked.has(`${at} ${other}`) ? [] : walk([at, other])));
  const all = [...next.keys()];
  const open = all.filter((at) => count(at) !== 2).flatMap((at) => (count(at) ? from(at) : [[at]]));
  // Closed lines have neither an end nor a crossing.
  const rings = all.flatMap((at) => (next.get(at)!.some((other) => walked.has(`${at} ${other}`)) || !count(at) ? [] : from(at)));
  const crosses = (at: number) => count(at) > 2;
  return [...open, ...rings].filter((path) => path.length > (crosses(path[0]) || crosses(path.at(-1)!) ? SPUR : 0));
}

/** Returns the strokes of a character in a square of this height, as x, y from its lower left corner. */
export function traced(letter: string, height: number): number[][][] {
  const ink = inked(letter);
  const none = inked(NOWHERE);
  if (!ink.includes(1) || ink.every((pixel, at) => pixel === none[at])) refuse("letter-undrawn", { value: letter });
  thin(ink);
  const unit = height / FINE;
  return lines(ink).map((path) => path.filter((_, k) => k % STEP === 0 || k === path.length - 1).map((at) => [unit * ((at % ROW) - 0.5), unit * (FINE + 0.5 - Math.floor(at / ROW))]));
}
