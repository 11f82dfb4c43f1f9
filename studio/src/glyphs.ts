/** Glyphs: a character as a font of the browser draws it, such as a kanji, thinned to lines of single strokes. */

/** Pixels along the side of a character's square. */
const FINE = 72;

/** Strokes shorter than this, in pixels, are remains of the thinning, unless they stand alone. */
const SPUR = 6;

/** A stroke's vertices are this many pixels apart. */
const STEP = 3;

/** A row of pixels with a clear border on both sides. */
const ROW = FINE + 2;

/** The steps to the pixels around one, clockwise from above. */
const AROUND = [-ROW, 1 - ROW, 1, 1 + ROW, ROW, ROW - 1, -1, -1 - ROW];

/** Characters that have no glyph in any font. */
const NOWHERE = "\u{10ffff}";

/** 1 where the character has ink, rows from the top. */
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

/** The neighbours that both passes look at: a pixel stays where all three of one of them have ink. */
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

/** The lines of thin ink, from end or crossing to end or crossing, as pixels. */
function lines(ink: Uint8Array): number[][] {
  const beside = (at: number) => AROUND.filter((way, k) => ink[at + way] && (k % 2 === 0 || !(ink[at + AROUND[k - 1]] || ink[at + AROUND[(k + 1) % 8]]))).map((way) => at + way);
  const next = new Map([...ink.keys()].filter((at) => ink[at]).map((at) => [at, beside(at)]));
  const count = (at: number) => next.get(at)!.length;
  const gone = new Set<string>();
  const walk = (path: number[]) => {
    for (;;) {
      const [before, at] = path.slice(-2);
      gone.add(`${before} ${at}`).add(`${at} ${before}`);
      const on = count(at) === 2 && at !== path[0] ? next.get(at)!.find((other) => other !== before) : undefined;
      if (on === undefined) return path;
      path.push(on);
    }
  };
  const from = (at: number) => next.get(at)!.filter((other) => !gone.has(`${at} ${other}`)).map((other) => (gone.has(`${at} ${other}`) ? [] : walk([at, other])));
  const all = [...next.keys()];
  const found = all.filter((at) => count(at) !== 2).flatMap((at) => (count(at) ? from(at) : [[at]]));
  // The remaining strokes have neither end nor crossing.
  const rings = all.flatMap((at) => (next.get(at)!.some((other) => gone.has(`${at} ${other}`)) || !count(at) ? [] : from(at)));
  const crosses = (at: number) => count(at) > 2;
  return [...found, ...rings].filter((path) => path.length > (crosses(path[0]) || crosses(path.at(-1)!) ? SPUR : 0));
}

/** The strokes of a character in a square of that height: x, y from its lower left corner. */
export function traced(letter: string, height: number): number[][][] {
  const ink = inked(letter);
  const none = inked(NOWHERE);
  if (!ink.includes(1) || ink.every((is, at) => is === none[at])) throw new Error(`the text has "${letter}", which no font here draws: give another`);
  thin(ink);
  const unit = height / FINE;
  return lines(ink).map((path) => path.filter((_, k) => k % STEP === 0 || k === path.length - 1).map((at) => [unit * ((at % ROW) - 0.5), unit * (FINE + 0.5 - Math.floor(at / ROW))]));
}
