/** Picture: the content that a painter draws, with WebGL2 (`createPainter`) or without (`createFlat`). */

import type { Lattice, Look, Obstacle, Shade, Vec3, Volume } from "../state/types.ts";
import type { Camera } from "./camera.ts";

/** A rectangle of the page, in CSS px from its upper left corner. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Red, green, blue, 0 to 255. */
export type Rgb = [number, number, number];

/**
 * The content of the 3-D view, lengths in m. A changed part must be a new array: painters upload a part only if its array is
 * another object.
 */
export interface Picture {
  camera: Camera;
  /** Positions of the transducers, N x 3. */
  positions: Float32Array;
  /** Unit normals of the transducers, N x 3. */
  normals: Float32Array;
  /** re and im of N drives of modulus 0 to 1; null while it is not known. */
  drive: Float32Array | null;
  /** The quantity that colours the transducers: none ("modulus"), the wave, or their phases. */
  discs: Shade;
  /** One slice, or several that cross in their middles; `key` names the texture of the lattice, as in `Painter.slice`. */
  slices: { lattice: Lattice; key: string }[];
  /** The wavelength of sound in m: the length of the bar on the first slice. */
  wavelength: number;
  volume: Volume | null;
  points: Vec3[];
  obstacles: Obstacle[];
  look: Look;
  theme: "dark" | "light";
  /** Whether something moves: the volume then takes fewer steps. */
  moving: boolean;
}

/** Paints any number of views on one canvas. A frame is a call of `begin`, then of its views. */
export interface Painter {
  /** Clears the canvas. The size is in CSS px, `ratio` is devicePixelRatio. */
  begin(width: number, height: number, ratio: number, background: Rgb): void;
  /**
   * Paints the lattice as a flat map that fills `box`, `v` up, clipped to `clip`. The texture `key` is uploaded again if the
   * values are another array.
   */
  slice(box: Box, lattice: Lattice, key: string, look: Look, clip?: Box): void;
  /** Paints the 3-D view. */
  scene(box: Box, picture: Picture): void;
  /** Whether the painter is fast enough for an animated wave. */
  readonly runs: boolean;
  /** Whether software renders, instead of a graphics card. */
  readonly slow: boolean;
  /** Whether the context is lost: then nothing is painted until `onRestored`. */
  readonly lost: boolean;
  /** Is called when the painter can paint again. */
  onRestored: (() => void) | null;
  dispose(): void;
}
