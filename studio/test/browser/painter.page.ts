/** The part of painter.test.ts that runs in the page: it paints slices and reads their pixels. */

import { drawSlice } from "../../src/app/figure.ts";
import { sampleAt } from "../../src/painter/lattice.ts";
import { colour } from "../../src/painter/maps.ts";
import { Painter } from "../../src/painter/painter.ts";
import type { Box } from "../../src/painter/picture.ts";
import { type Lattice, type Look, SCALES } from "../../src/state/types.ts";
import { focused, plane, square } from "../field.ts";

function canvas(): HTMLCanvasElement {
  const made = document.createElement("canvas");
  document.body.append(made);
  return made;
}

function read(from: HTMLCanvasElement, x: number, y: number): number[] {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [1, 1];
  const pen = copy.getContext("2d")!;
  pen.drawImage(from, -x, -y);
  return [...pen.getImageData(0, 0, 1, 1).data];
}

/** Returns the greatest difference (of 255) between a painted slice and `colour(look, sample)`, at 50 places per look. */
function worst(on: HTMLCanvasElement, paint: (box: Box, lattice: Lattice, look: Look) => void): number {
  const positions = square(10);
  const lattice = plane(
    positions,
    focused(positions, [
      [0, 0, 0.1],
      [0.02, 0.01, 0.1],
    ]),
    0.1,
    0.1,
    65,
  );
  const box = { x: 30, y: 20, width: 200, height: 180 };
  let most = 0;
  const rest = { scale: SCALES[0], top: 2500 };
  const looks: Look[] = (["dark", "light"] as const).flatMap((theme) => SCALES.map((scale): Look => ({ quantity: "modulus", scale, top: 2500, turn: 0, theme })));
  for (const theme of ["dark", "light"] as const) for (const turn of [0, 1, 2.5, 4, 5.5]) looks.push({ ...rest, quantity: "wave", turn, theme });
  looks.push({ ...rest, quantity: "phase", turn: 2, theme: "dark" });
  for (const look of looks) {
    paint(box, lattice, look);
    for (let i = 0; i < 50; i++) {
      const x = Math.floor(((i * 0.7548776662) % 1) * box.width);
      const y = Math.floor(((i * 0.569840291) % 1) * box.height);
      const p = sampleAt(lattice, (x + 0.5) / box.width, 1 - (y + 0.5) / box.height);
      const want = colour(look, ...p);
      const got = read(on, box.x + x, box.y + y);
      want.forEach((value, k) => (most = Math.max(most, Math.abs(value - got[k]))));
    }
    const outside = read(on, box.x - 2, box.y + 5);
    if (outside[0] !== 12)
      throw new Error(`slice: outside its box the page is ${outside}, 12 15 20 is meant`);
  }
  return most;
}

const painted = (painter: Painter, on: HTMLCanvasElement) =>
  worst(on, (box, lattice, look) => {
    painter.begin(300, 240, 1, [12, 15, 20]);
    painter.slice(box, lattice, "A", look);
  });

export const checks = {
  webgl(): number {
    const on = canvas();
    const painter = Painter.of(on);
    if (!painter) throw new Error("painter: this browser has no WebGL2");
    const most = painted(painter, on);
    painter.dispose();
    on.remove();
    return most;
  },
  /** The slices of an exported figure. */
  figure(): number {
    const [on, slice] = [canvas(), document.createElement("canvas")];
    const most = worst(on, (box, lattice, look) => {
      [on.width, on.height, slice.width, slice.height] = [300, 240, box.width, box.height];
      const pen = on.getContext("2d")!;
      pen.fillStyle = "rgb(12 15 20)";
      pen.fillRect(0, 0, on.width, on.height);
      drawSlice(slice, lattice, look);
      pen.drawImage(slice, box.x, box.y);
    });
    on.remove();
    return most;
  },
  /** Loses and restores the context; returns true if the slice then looks as before. */
  async restored(): Promise<boolean> {
    const on = canvas();
    const painter = Painter.of(on)!;
    const loser = on.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
    const before = painted(painter, on);
    const back = new Promise<void>((done) => (painter.onRestored = done));
    loser.loseContext();
    await new Promise((done) => setTimeout(done, 50));
    if (!painter.lost) return false;
    loser.restoreContext();
    await back;
    const same = painted(painter, on) === before && !painter.lost;
    on.remove();
    return same;
  },
};

Object.assign(window, { checks });
