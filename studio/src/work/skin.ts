/** Skin: the predicted touch of a skin on the slice, under frames that repeat for ever. */

import type { Hand } from "./engine.ts";
import { gridOf } from "./lattices.ts";
import type { Grid } from "./solve.worker.ts";
import type { Lattice, State, Touched } from "../state/types.ts";

/** The most samples along a side, and the most entries of G, which the core then keeps for all frames. */
const MOST = 64;
const ENTRIES = 1 << 23;

/** Samples farther apart than this, in m, miss a focus. */
const APART = 2.5e-3;

/** The touch of a skin, and its pictures. */
export interface Skin extends Touched {
  /** The felt strength, 1 at the threshold. */
  felt: Lattice;
  /** Returns the displacement in m at the start of a frame. */
  moved(frame: number): Promise<Lattice>;
}

/** Returns the largest size in m of a slice that can show a skin above this many transducers, and the samples along its side. */
export function limitsOf(transducers: number): { size: number; count: number } {
  const count = Math.max(8, Math.min(MOST, Math.floor(Math.sqrt(ENTRIES / transducers))));
  return { count, size: APART * (count - 1) };
}

/** Predicts the touch under the frames that `hand` has solved, repeated at `rate` frames per second. */
export async function predict(hand: Hand, state: State, transducers: number, rate: number): Promise<Skin> {
  const { count } = limitsOf(transducers);
  const grid: Grid = { ...gridOf(state), nu: count, nv: count };
  const { width, peak, strengths } = await hand.skin(grid, rate);
  const most = strengths.reduce((a, b) => Math.max(a, b), 0);
  return { width, peak, most, felt: real(grid, strengths), moved: async (frame) => real(grid, await hand.moved(frame)) };
}

/** Returns a lattice of real values. */
function real(grid: Grid, given: Float64Array): Lattice {
  const values = new Float32Array(2 * given.length);
  given.forEach((value, k) => (values[2 * k] = value));
  return { ...grid, values };
}
