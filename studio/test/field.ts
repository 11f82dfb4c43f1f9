/** A field for tests: the sum of e^{jkr}/r of N transducers. */

import type { Lattice, Vec3 } from "../src/state/types.ts";

export const WAVELENGTH = 8.5e-3;

/** Returns the positions of side x side transducers, 10 mm apart, in z = 0. */
export function square(side: number): Float32Array {
  const positions = new Float32Array(3 * side * side);
  for (let i = 0; i < side * side; i++) {
    positions[3 * i] = ((i % side) - (side - 1) / 2) * 0.01;
    positions[3 * i + 1] = (Math.floor(i / side) - (side - 1) / 2) * 0.01;
  }
  return positions;
}

/** Returns a drive of full amplitude: its phases are those of the sum of the conjugate waves of all points. */
export function focused(positions: Float32Array, points: Vec3[]): Float32Array {
  const drive = new Float32Array((positions.length / 3) * 2);
  for (let i = 0; i < positions.length / 3; i++) {
    let [re, im] = [0, 0];
    for (const [j, point] of points.entries()) {
      const r = Math.hypot(...[0, 1, 2].map((axis) => point[axis] - positions[3 * i + axis]));
      const phase = (-2 * Math.PI * r) / WAVELENGTH + 2.4 * j * j;
      re += Math.cos(phase) / r;
      im += Math.sin(phase) / r;
    }
    const size = Math.hypot(re, im);
    drive.set([re / size, im / size], 2 * i);
  }
  return drive;
}

/** Returns re and im of p (Pa) at a place, for a source pressure of 4.386 Pa m. */
export function pressure(positions: Float32Array, drive: Float32Array, place: Vec3): [number, number] {
  let re = 0;
  let im = 0;
  for (let i = 0; i < positions.length / 3; i++) {
    const dx = place[0] - positions[3 * i];
    const dy = place[1] - positions[3 * i + 1];
    const dz = place[2] - positions[3 * i + 2];
    const r = Math.sqrt(dx * dx + dy * dy + dz * dz);
    const c = (Math.cos((2 * Math.PI * r) / WAVELENGTH) * 4.386) / r;
    const s = (Math.sin((2 * Math.PI * r) / WAVELENGTH) * 4.386) / r;
    re += c * drive[2 * i] - s * drive[2 * i + 1];
    im += c * drive[2 * i + 1] + s * drive[2 * i];
  }
  return [re, im];
}

/** Returns the field on a horizontal square lattice of n x n samples. */
export function plane(
  positions: Float32Array,
  drive: Float32Array,
  z: number,
  size: number,
  n: number,
): Lattice {
  const values = new Float32Array(2 * n * n);
  for (let j = 0; j < n; j++) {
    for (let i = 0; i < n; i++) {
      const place: Vec3 = [(i / (n - 1) - 0.5) * size, (j / (n - 1) - 0.5) * size, z];
      values.set(pressure(positions, drive, place), 2 * (j * n + i));
    }
  }
  return { corner: [-size / 2, -size / 2, z], u: [size, 0, 0], v: [0, size, 0], nu: n, nv: n, values };
}
