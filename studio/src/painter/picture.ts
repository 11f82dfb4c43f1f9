/** Picture: the content that the painter draws. */

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
 * The content of the 3-D view, lengths in m. A changed part must be a new array: the painter uploads a part only if its array is
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
