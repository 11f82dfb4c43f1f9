/** The camera of the 3-D view: it turns about a target, sees in perspective, z is up. */

import type { Vec3 } from "../types.ts";

/** Turned by `yaw` (rad, 0: looks along +y, x to the right) and raised by `pitch` (rad, pi/2: from above). */
export interface Camera {
  target: Vec3;
  yaw: number;
  pitch: number;
  /** From the target, m. */
  distance: number;
}

/** Focal length over the view's height: 35 degrees of view from bottom to top. */
export const FOCAL = 1.6;

export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** a + f b. */
export const along = (a: Vec3, f: number, b: Vec3): Vec3 => [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]];

/** The camera's own axes, of length 1, and where it stands (m). */
export function frame({ target, yaw, pitch, distance }: Camera): { right: Vec3; up: Vec3; ahead: Vec3; eye: Vec3 } {
  const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
  const ahead: Vec3 = [-sy * cp, cy * cp, -sp];
  return { right: [cy, sy, 0], up: [-sy * sp, cy * sp, cp], ahead, eye: along(target, -distance, ahead) };
}

/** Where `place` (m) is seen: x, y (CSS px of the view, y down) and depth (m; 0 or less: behind the camera). */
export function project(camera: Camera, place: Vec3, width: number, height: number): Vec3 {
  const { right, up, ahead, eye } = frame(camera);
  const d = along(place, -1, eye);
  const depth = dot(d, ahead);
  const scale = (FOCAL * height) / depth;
  return [width / 2 + scale * dot(d, right), height / 2 - scale * dot(d, up), depth];
}

/** What is seen at x, y (CSS px of the view) lies at from + t * along, t > 0; `along` is 1 deep, not 1 long. */
export function ray(camera: Camera, x: number, y: number, width: number, height: number): { from: Vec3; along: Vec3 } {
  const { right, up, ahead, eye } = frame(camera);
  const scale = 1 / (FOCAL * height);
  return { from: eye, along: along(along(ahead, (x - width / 2) * scale, right), (height / 2 - y) * scale, up) };
}

/** Where the ray through `at` (px) meets the plane with that normal through `place`; null: it does not. */
function meet(camera: Camera, at: [number, number], size: [number, number], place: Vec3, normal: Vec3): Vec3 | null {
  const { from, along: way } = ray(camera, at[0], at[1], size[0], size[1]);
  const t = dot(along(place, -1, from), normal) / dot(way, normal);
  // Beyond the horizon, or so near to it that a pixel is metres.
  return t > 0 && t < 20 * camera.distance ? along(from, t, way) : null;
}

/**
 * The shift (m) in the horizontal plane at height z (m) of a drag from `from` to `to` (CSS px of the view of that
 * size): the difference of two rays, so that nothing jumps when a drag begins. Null: beyond the horizon.
 */
export function slide(
  camera: Camera,
  from: [number, number],
  to: [number, number],
  z: number,
  size: [number, number],
): Vec3 | null {
  const a = meet(camera, from, size, [0, 0, z], [0, 0, 1]);
  const b = meet(camera, to, size, [0, 0, z], [0, 0, 1]);
  return a && b && along(b, -1, a);
}

/** The shift in height (m) of a drag of what is at `place` (m): as `slide`, in the upright plane that faces the camera. */
export function lift(
  camera: Camera,
  from: [number, number],
  to: [number, number],
  place: Vec3,
  size: [number, number],
): number | null {
  const normal: Vec3 = [-Math.sin(camera.yaw), Math.cos(camera.yaw), 0];
  const a = meet(camera, from, size, place, normal);
  const b = meet(camera, to, size, place, normal);
  return a && b && b[2] - a[2];
}

/** A camera that shows all transducers (N x 3, m) and points (m) in a view of that size (CSS px). */
export function fit(positions: Float32Array, points: Vec3[], width: number, height: number): Camera {
  const camera: Camera = { target: [0, 0, 0], yaw: 0.5, pitch: 0.5, distance: 1 };
  const { right, up, ahead } = frame(camera);
  const all = [...points];
  for (let i = 0; i < positions.length; i += 3) all.push([positions[i], positions[i + 1], positions[i + 2]]);
  // Of q's coordinate c and depth d, seen from e: |c - e| <= slope (d + back). All bounds on e and `back` are linear.
  const side = (axis: Vec3, slope: number) => {
    let [most, least] = [-Infinity, Infinity];
    for (const q of all) {
      most = Math.max(most, dot(q, axis) - slope * dot(q, ahead));
      least = Math.min(least, dot(q, axis) + slope * dot(q, ahead));
    }
    return { middle: (most + least) / 2, back: (most - least) / 2 / slope };
  };
  const across = side(right, (0.86 * width) / 2 / (FOCAL * height));
  const upward = side(up, 0.86 / 2 / FOCAL);
  const depths = all.map((q) => dot(q, ahead));
  const middle = depths.reduce((sum, d) => sum + d, 0) / depths.length;
  const target = along(along(along([0, 0, 0], across.middle, right), upward.middle, up), middle, ahead);
  return { ...camera, target, distance: Math.max(across.back, upward.back, 0.05 - middle) + middle };
}
