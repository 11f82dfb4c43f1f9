/** Touch: the slice on which a skin lies, and the predicted touch of this skin under frames that repeat for ever. */

import { type Lattice, type Quantity, type State, type Touched, TOUCHES, type TouchQuantity } from "../state/types.ts";
import type { Hand } from "./engine.ts";
import { gridOf } from "./lattices.ts";
import type { Grid } from "./solve.worker.ts";

/** Margin of the skin around the points and their path, in m. */
const MARGIN = 0.02;

/** The size of a skin is a multiple of this, in m. */
const STEP = 0.005;

/** The smallest size of a slice, in m. */
const LEAST = 0.04;

/** The most samples along a side, and the most entries of G, which the core then keeps for all frames. */
const MOST = 64;
const ENTRIES = 1 << 23;

/** Samples farther apart than this, in m, miss a focus. */
const APART = 2.5e-3;

export const isTouch = (quantity: Quantity): quantity is TouchQuantity => (TOUCHES as readonly string[]).includes(quantity);

/** Returns the quantity of a skin that a state shows, if its points move on a path; otherwise null. */
export const touchOf = ({ quantity, path }: State): TouchQuantity | null => (path && isTouch(quantity) ? quantity : null);

/** Returns a slice normal to z through the middle of the points, with their paths and a margin. */
export function skinPlane({ points, path }: State): State["plane"] {
  const [x, y, z] = [0, 1, 2].map((axis) => {
    const all = points.map((point) => point[axis]);
    return { least: Math.min(...all), most: Math.max(...all) };
  });
  const middle = ({ least, most }: typeof x) => Math.round(5e5 * (least + most)) / 1e6;
  const turn = path?.kind === "circle" ? 2 * path.radius : (path?.length ?? 0);
  const wide = Math.max(x.most - x.least, y.most - y.least) + turn + 2 * MARGIN;
  const size = Math.max(LEAST, Math.ceil(wide / STEP - 1e-6) * STEP);
  return { axis: "z", z: middle(z), size: Math.round(1e6 * size) / 1e6, center: [middle(x), middle(y)] };
}

/** The touch of a skin, and its pictures. */
export interface Skin extends Touched {
  /** The felt strength, 1 at the threshold. */
  felt: Lattice;
  /** The pressure in Pa that is felt as a push. */
  push: Lattice;
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
  const { strengths, pushes, ...touch } = await hand.skin(grid, rate);
  const [most, pressed] = [strengths, pushes].map((values) => values.reduce((a, b) => Math.max(a, b), 0));
  const moved = async (frame: number) => real(grid, await hand.moved(frame));
  return { ...touch, most, pressed, felt: real(grid, strengths), push: real(grid, pushes), moved };
}

/** Returns a lattice of real values. */
function real(grid: Grid, reals: Float64Array): Lattice {
  const values = new Float32Array(2 * reals.length);
  reals.forEach((value, k) => (values[2 * k] = value));
  return { ...grid, values };
}
