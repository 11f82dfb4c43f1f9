/** The camera of the 3-D view: it turns around a target, with perspective; z is up. */

import type { Axis, Vec3 } from "../state/types.ts";

/** `yaw` in rad (0: looks along +y, with x to the right), `pitch` in rad (pi/2: looks down from above). */
export interface Camera {
  target: Vec3;
  yaw: number;
  pitch: number;
  /** The distance from the target, m. */
  distance: number;
}

/** Focal length relative to the view's height: an angle of view of 35 degrees from bottom to top. */
export const FOCAL = 1.6;

export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** Returns a + f b. */
export const along = (a: Vec3, f: number, b: Vec3): Vec3 => [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]];
export const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** A flat piece: a corner (m), and its sides. */
export type Piece = { corner: Vec3; u: Vec3; v: Vec3 };

/** Returns the place that is `s` and `t` along the sides of a piece. */
export const placeIn = ({ corner, u, v }: Piece, s: number, t: number): Vec3 => along(along(corner, s, u), t, v);
/** Returns the vector of length 1 in the direction of `a`. */
export const unit = (a: Vec3) => along([0, 0, 0], 1 / Math.sqrt(dot(a, a)), a);

/** Returns the camera's own axes, of length 1, and its place (m). */
export function frame({ target, yaw, pitch, distance }: Camera) {
  const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
  const right: Vec3 = [cy, sy, 0];
  const up: Vec3 = [-sy * sp, cy * sp, cp];
  const ahead: Vec3 = [-sy * cp, cy * cp, -sp];
  return { right, up, ahead, eye: along(target, -distance, ahead) };
}

/** A place in a view, in CSS px from its upper left corner. */
export type Spot = [number, number];

/** Returns the unit vector along an axis, given by number. */
const axisOf = (axis: number) => [0, 0, 0].with(axis, 1) as Vec3;

/** The view of a camera, of this size in CSS px. */
export class Sight {
  private readonly frame;

  constructor(
    readonly camera: Camera,
    readonly size: Spot,
  ) {
    this.frame = frame(camera);
  }

  /** Returns where a place (m) is seen: x, y (CSS px, y down) and depth (m; 0 or less: behind the camera). */
  project(place: Vec3): Vec3 {
    const { right, up, ahead, eye } = this.frame;
    const [width, height] = this.size;
    const d = along(place, -1, eye);
    const depth = dot(d, ahead);
    const scale = (FOCAL * height) / depth;
    return [width / 2 + scale * dot(d, right), height / 2 - scale * dot(d, up), depth];
  }

  /** Returns the line of sight at a spot: eye + t way, t > 0. `way` has a depth of 1, not a length of 1. */
  ray([x, y]: Spot): { eye: Vec3; way: Vec3 } {
    const { right, up, ahead, eye } = this.frame;
    const [width, height] = this.size;
    const scale = 1 / (FOCAL * height);
    return { eye, way: along(along(ahead, (x - width / 2) * scale, right), (height / 2 - y) * scale, up) };
  }

  /** Returns where the plane through a place (m), normal to an axis or a vector, is seen at a spot; null if it is not. */
  meet(spot: Spot, place: Vec3, axis: number | Vec3): Vec3 | null {
    const normal = typeof axis === "number" ? axisOf(axis) : axis;
    const { eye, way } = this.ray(spot);
    const t = dot(along(place, -1, eye), normal) / dot(way, normal);
    // No result beyond the horizon, or so near to it that a pixel is metres.
    return t > 0 && t < 20 * this.camera.distance ? along(eye, t, way) : null;
  }

  /**
   * Returns the shift (m) of a drag between two spots in the plane through a place (m), null beyond the horizon. It is the
   * difference of two rays, so that nothing jumps when a drag begins.
   */
  slide(from: Spot, to: Spot, place: Vec3, axis: number | Vec3 = 2): Vec3 | null {
    const [a, b] = [from, to].map((spot) => this.meet(spot, place, axis));
    return a && b && along(b, -1, a);
  }

  /** Returns the shift (m) along an axis for a drag of a place (m), in the plane along the axis that faces the camera. */
  lift(from: Spot, to: Spot, place: Vec3, axis = 2): number | null {
    const { ahead } = this.frame;
    return this.slide(from, to, place, along(ahead, -ahead[axis], axisOf(axis)))?.[axis] ?? null;
  }
}

function extent(positions: Float32Array, axis: number): number {
  const values = positions.filter((_, i) => i % 3 === axis);
  return values.reduce((a, b) => Math.max(a, b), -Infinity) - values.reduce((a, b) => Math.min(a, b), Infinity);
}

/**
 * Returns a camera that shows all transducers (N x 3, m) and points (m) in a view of this size (CSS px). `way` is its yaw and
 * pitch; without it they suit the slice normal to `axis`, which with `above` is seen from above, unless a board covers it.
 */
export function fit(positions: Float32Array, points: Vec3[], [width, height]: Spot, axis: Axis = "z", way?: [number, number], above = false): Camera {
  // The camera is so high that points at the same height appear apart, but not above a board that covers the points.
  const roofed = positions.some((z, i) => i % 3 === 2 && points.every((point) => point[2] < z));
  const [yaw, pitch] = way ?? (above && axis === "z" && !roofed ? [0, 1.57] : [axis === "x" ? Math.PI / 2 - 0.5 : 0.5, axis !== "z" ? 0.3 : roofed ? 0.45 : 0.72]);
  const camera: Camera = { target: [0, 0, 0], yaw, pitch, distance: 1 };
  const { right, up, ahead } = frame(camera);
  const all = [...points];
  // Margin around each transducer, for the axes and their marks at the array's edge.
  const room = 0.1 * Math.max(...[0, 1].map((axis) => extent(positions, axis)), 0.1);
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = positions.subarray(i, i + 3);
    for (const a of [-room, room]) for (const b of [-room, room]) all.push([x + a, y + b, z]);
  }
  // A point q is in view if |c - e| <= slope (d + back). c and e are the coordinates of q and of the camera across the view, d
  // is q's depth, and `back` the camera's distance behind depth 0. The condition is linear in e and `back`.
  const side = (axis: Vec3, slope: number) => {
    let [most, least] = [-Infinity, Infinity];
    for (const q of all) {
      most = Math.max(most, dot(q, axis) - slope * dot(q, ahead));
      least = Math.min(least, dot(q, axis) + slope * dot(q, ahead));
    }
    return { middle: (most + least) / 2, back: (most - least) / 2 / slope };
  };
  const wide = (0.91 * width) / 2 / (FOCAL * height);
  const high = 0.91 / 2 / FOCAL;
  const back = Math.max(side(right, wide).back, side(up, high).back);
  // At this distance one direction has space left: a smaller slope that just contains all points centres them.
  const centre = (axis: Vec3, slope: number) => {
    for (let i = 0; i < 8; i++) slope *= side(axis, slope).back / back;
    return side(axis, slope).middle;
  };
  const depths = all.map((q) => dot(q, ahead));
  const middle = depths.reduce((sum, d) => sum + d, 0) / depths.length;
  const target = along(along(along([0, 0, 0], centre(right, wide), right), centre(up, high), up), middle, ahead);
  return { ...camera, target, distance: Math.max(back + middle, 0.05) };
}

/** Returns the camera between two with the same yaw and pitch, or on the way from one to another; `part` is 0 at the first. */
export function between(from: Camera, to: Camera, part: number): Camera {
  const mix = (a: number, b: number) => a + part * (b - a);
  return { target: from.target.map((x, k) => mix(x, to.target[k])) as Vec3, yaw: mix(from.yaw, to.yaw), pitch: mix(from.pitch, to.pitch), distance: mix(from.distance, to.distance) };
}
