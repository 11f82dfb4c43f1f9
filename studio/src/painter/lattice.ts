/** The field between the samples of a lattice: cubic B-splines through re and im. */

// A field has no detail below half a wavelength. So splines of the complex pressure through samples lambda/5.5 apart have
// errors of a fraction of a per cent. |p| has kinks at its zeros and must not be interpolated. The coefficients are computed
// here once per field; `sampleAt` and the shaders then sum 4 x 4 of them.

import type { Lattice, Vec3 } from "../state/types.ts";
import { along, dot } from "./camera.ts";

/**
 * Replaces n values (with this stride, from `start`) at slots 1 to n by the n + 2 coefficients of their spline, at slots 0 to n
 * + 1. The spline is one cubic over the first two and over the last two intervals ("not a knot").
 */
function filterLine(c: Float64Array | Float32Array, start: number, stride: number, n: number, ratios: Float64Array): void {
  const at = (slot: number) => start + slot * stride;
  const f0 = c[at(1)];
  const f1 = c[at(2)];
  const l1 = c[at(n - 1)];
  const l0 = c[at(n)];
  const second = (8 * f1 - f0 - c[at(3)]) / 6;
  const last = (8 * l1 - l0 - c[at(n - 2)]) / 6;
  // In between, c[i - 1] + 4 c[i] + c[i + 1] = 6 f[i]: forward elimination, then back substitution.
  c[at(2)] = second;
  for (let i = 3; i <= n - 2; i++) c[at(i)] = (6 * c[at(i)] - c[at(i - 1)]) * ratios[i];
  c[at(n - 1)] = last;
  for (let i = n - 2; i >= 3; i--) c[at(i)] -= ratios[i] * c[at(i + 1)];
  c[at(1)] = 6 * f1 - 4 * c[at(2)] - c[at(3)];
  c[at(0)] = 6 * f0 - 4 * c[at(1)] - c[at(2)];
  c[at(n)] = 6 * l1 - 4 * c[at(n - 1)] - c[at(n - 2)];
  c[at(n + 1)] = 6 * l0 - 4 * c[at(n)] - c[at(n - 1)];
}

/** Returns the reciprocal pivots of the elimination in `filterLine`: each is 1 / (4 - the one before). */
function pivots(n: number): Float64Array {
  const ratios = new Float64Array(n + 2);
  for (let i = 3; i <= n; i++) ratios[i] = 1 / (4 - ratios[i - 1]);
  return ratios;
}

const known = new WeakMap<Float32Array, Float32Array<ArrayBuffer>>();

/**
 * Returns the spline coefficients of `lattice`: (nu + 2) x (nv + 2) pairs of re and im, i fastest, with a border of one around
 * the samples. They are cached per `lattice.values`: a new field must be a new array.
 */
export function coefficients(lattice: Lattice): Float32Array<ArrayBuffer> {
  const { nu, nv, values } = lattice;
  const old = known.get(values);
  if (old) return old;
  if (nu < 4 || nv < 4 || values.length !== 2 * nu * nv) {
    const size = `${nu} x ${nv} places with ${values.length} numbers`;
    throw new Error(`lattice: ${size}: give 4 x 4 places or more and 2 nu nv numbers`);
  }
  const row = 2 * (nu + 2);
  const c = new Float32Array(row * (nv + 2));
  for (let j = 0; j < nv; j++) c.set(values.subarray(2 * nu * j, 2 * nu * (j + 1)), row * (j + 1) + 2);
  const across = pivots(nu);
  for (let j = 1; j <= nv; j++) for (const part of [0, 1]) filterLine(c, row * j + part, 2, nu, across);
  const up = pivots(nv);
  for (let i = 0; i < row; i++) filterLine(c, i, row, nv, up);
  known.set(values, c);
  return c;
}

/** Returns the four weights of a cubic B-spline at the part `f` (0 to 1) of an interval. */
function weights(f: number): [number, number, number, number] {
  const g = 1 - f;
  return [
    (g * g * g) / 6,
    (3 * f * f * f - 6 * f * f + 4) / 6,
    (3 * g * g * g - 6 * g * g + 4) / 6,
    (f * f * f) / 6,
  ];
}

/** Returns re and im of p (Pa) at `s`, `t` (0 to 1) along the lattice's `u` and `v`; outside of it, the values at its edge. */
export function sampleAt(lattice: Lattice, s: number, t: number): [number, number] {
  const { nu, nv } = lattice;
  const c = coefficients(lattice);
  const x = Math.min(Math.max(s, 0), 1) * (nu - 1);
  const y = Math.min(Math.max(t, 0), 1) * (nv - 1);
  const i = Math.min(Math.floor(x), nu - 2);
  const j = Math.min(Math.floor(y), nv - 2);
  const wx = weights(x - i);
  const wy = weights(y - j);
  let re = 0;
  let im = 0;
  for (let b = 0; b < 4; b++) {
    for (let a = 0; a < 4; a++) {
      const k = 2 * ((j + b) * (nu + 2) + i + a);
      re += wy[b] * wx[a] * c[k];
      im += wy[b] * wx[a] * c[k + 1];
    }
  }
  return [re, im];
}

/** Returns re and im of p (Pa) at `place` (m), projected onto the lattice's plane; `u` and `v` must be at right angles. */
export function sample(lattice: Lattice, place: Vec3): [number, number] {
  const away = along(place, -1, lattice.corner);
  const [s, t] = [lattice.u, lattice.v].map((side) => dot(away, side) / dot(side, side));
  return sampleAt(lattice, s, t);
}
