/** Look: the common colour scale of both methods. */

import type { Result, View } from "../solving/studio.ts";
import { FREQUENCY } from "../solving/lattices.ts";
import { isTouch } from "../solving/touch.ts";
import type { Look, Shade, State, Theme } from "../state/types.ts";

/** The shown wave is this many times slower than sound: 2 Hz, below the three flashes per second that can be harmful. */
const SLOWED = 2e4;

/** Returns w t of the slowed wave in rad, below 2 pi, after this many ms. */
export const turnAt = (milliseconds: number) => 2 * Math.PI * (((FREQUENCY / SLOWED) * milliseconds * 1e-3) % 1);

/**
 * The top of the scale is at most this many times the loudest point: a larger |p| is not in a focus but, for example, at a
 * transducer.
 */
const MOST = 1.5;

/**
 * Returns the quantity that colours the transducers. Unless phases are shown, the transducers are neutral, so that only the
 * field has colour.
 */
export function discsOf({ quantity, level }: State): Shade {
  if (isTouch(quantity)) return "modulus";
  return quantity === "modulus" && level === "engineer" ? "phase" : quantity;
}

/**
 * Returns the colour scale of all pictures: its top is the largest |p| of both slices, within limits, or the largest value of the
 * shown touch.
 */
export function lookOf(view: Pick<View, "state" | "frame"> & { results: Result[] }, theme: Theme, turn = 0): Look {
  const { state, results, frame } = view;
  if (frame?.touch) {
    const { quantity: touch, most, peak, pressed } = frame.touch;
    if (touch === "felt") return { quantity: "modulus", touch, scale: "decibel", top: most || 1, turn: 0, theme };
    if (touch === "push") return { quantity: "modulus", touch, scale: "linear", top: pressed || 1, turn: 0, theme };
    return { quantity: "wave", touch, scale: "linear", top: peak || 1e-6, turn: 0, theme };
  }
  const answers = results.flatMap(({ answer }) => answer ?? []);
  const points = answers.flatMap(({ pressures }) => pressures).map(([re, im]) => Math.hypot(re, im));
  const loudest = points.reduce((a, b) => Math.max(a, b), 0);
  let most = 0;
  for (const { values } of [...results, ...(frame?.results ?? [])].flatMap((result) => (result?.lattice ? [result.lattice, ...result.crossing] : []))) {
    for (let k = 0; k < values.length; k += 2) most = Math.max(most, values[k] ** 2 + values[k + 1] ** 2);
  }
  // The points of traps are quiet, so the loudest point does not limit the top of the scale.
  const top = state.signature ? Math.sqrt(most) : Math.max(loudest, Math.min(Math.sqrt(most), MOST * loudest));
  const { scale } = state;
  const quantity = isTouch(state.quantity) ? "modulus" : state.quantity;
  return { quantity, scale, top: top || 1, turn, theme };
}
