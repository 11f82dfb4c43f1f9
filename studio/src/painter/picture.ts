/** Picture: the content that a painter draws, by WebGL2 (`createPainter`) or without it (`createFlat`). */

import type { Lattice, Look, Obstacle, Quantity, Vec3, Volume } from "../types.ts";
import type { Camera } from "./camera.ts";

/** A part of the page, CSS px from its left top corner. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Red, green, blue, 0 to 255. */
export type Rgb = [number, number, number];

/** The content of the 3-D view. Lengths in m. A changed part is a new array: its identity shows which parts to upload. */
export interface Picture {
  camera: Camera;
  /** N x 3. */
  positions: Float32Array;
  /** N x 3, of length 1. */
  normals: Float32Array;
  /** re and im of N drives of modulus 0 to 1; null: not known yet. */
  drive: Float32Array | null;
  /** The transducers' display of the drive: nothing ("modulus"), the wave, or their phases. */
  discs: Quantity;
  /** One, or some that cross in their middles; `key` names the texture that the lattice is kept in, as in `Painter.slice`. */
  slices: { lattice: Lattice; key: string }[];
  /** The wavelength of sound, the length of the bar on the first slice. */
  wavelength: number;
  volume: Volume | null;
  points: Vec3[];
  obstacles: Obstacle[];
  look: Look;
  theme: "dark" | "light";
  /** Something moves: the volume takes fewer steps. */
  moving: boolean;
}

/** Paints any number of views on one canvas. A frame is `begin`, then its views. */
export interface Painter {
  /** Clears all. Size in CSS px, `ratio` is devicePixelRatio. */
  begin(width: number, height: number, ratio: number, background: Rgb): void;
  /** The lattice as a flat map that fills `box`, `v` up, seen within `clip`; texture `key` follows the identity of its values. */
  slice(box: Box, lattice: Lattice, key: string, look: Look, clip?: Box): void;
  /** The 3-D view. */
  scene(box: Box, picture: Picture): void;
  /** Fast enough for a wave that runs. */
  readonly runs: boolean;
  /** Software paints, in place of a graphics card. */
  readonly slow: boolean;
  /** The graphics card has taken the context away: nothing is painted until `onRestored`. */
  readonly lost: boolean;
  /** Called when the painter can paint again: paint. */
  onRestored: (() => void) | null;
  dispose(): void;
}
