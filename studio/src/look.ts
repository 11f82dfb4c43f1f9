/** Look: one colour scale for both methods. */

import type { View } from "./studio.ts";
import { FREQUENCY } from "./lattices.ts";
import type { Look, Quantity, State, Theme } from "./types.ts";

/** The wave is this many times slower than sound: 2 Hz, below the three flashes a second that can harm. */
const SLOWED = 2e4;

/** w t of the slowed wave in rad, below 2 pi, after this many ms. */
export const turnAt = (milliseconds: number) => 2 * Math.PI * (((FREQUENCY / SLOWED) * milliseconds * 1e-3) % 1);

/** A top above this many times the loudest point is something else's, such as a transducer's. */
const MOST = 1.5;

/** The colour of the transducers: neutral, so that the field has all the colour, except where phases are shown. */
export const discsOf = ({ quantity, level }: State): Quantity => (quantity === "modulus" && level === "engineer" ? "phase" : quantity);

/** The colour scale of all that is shown: its top is the loudest |p| of both slices. */
export function lookOf(view: View, theme: Theme, turn = 0): Look {
  const { state, results, frame } = view;
  const answers = results.flatMap(({ answer }) => answer ?? []);
  const points = answers.flatMap(({ pressures }) => pressures).map(([re, im]) => Math.hypot(re, im));
  const loudest = points.reduce((a, b) => Math.max(a, b), 0);
  let most = 0;
  for (const lattice of [...results, ...(frame?.results ?? [])].map((result) => result?.lattice)) {
    if (!lattice) continue;
    const { values } = lattice;
    for (let k = 0; k < values.length; k += 2) most = Math.max(most, values[k] ** 2 + values[k + 1] ** 2);
  }
  // The points of a trap are dark: their targets are shown beside them.
  const top = state.signature ? Math.sqrt(most) : Math.max(loudest, Math.min(Math.sqrt(most), MOST * loudest));
  const { quantity, scale } = state;
  return { quantity, scale, top: top || 1, turn, theme };
}
