import { expect, test } from "vitest";
import { sample, sampleAt } from "../src/painter/lattice.ts";
import type { Lattice, Vec3 } from "../src/state/types.ts";
import { focused, plane, pressure, square, WAVELENGTH } from "./field.ts";

test("the spline is within 0.3 % of the peak of the exact field", () => {
  const positions = square(20);
  const points: Vec3[] = [
    [0, 0, 0.15],
    [0.03, 0.01, 0.15],
    [-0.02, 0.035, 0.15],
  ];
  const drive = focused(positions, points);
  const n = 65;
  const size = ((n - 1) * WAVELENGTH) / 5.5;
  const lattice = plane(positions, drive, 0.15, size, n);
  let peak = 0;
  for (const point of points) peak = Math.max(peak, Math.hypot(...pressure(positions, drive, point)));
  let worst = 0;
  let squares = 0;
  const count = 1500;
  for (let i = 0; i < count; i++) {
    // A low-discrepancy sequence over the whole plane, with its edges.
    const place: Vec3 = [
      (((i * 0.7548776662) % 1) - 0.5) * size,
      (((i * 0.569840291) % 1) - 0.5) * size,
      0.15,
    ];
    const [re, im] = pressure(positions, drive, place);
    const [a, b] = sample(lattice, place);
    const error = Math.hypot(a - re, b - im) / peak;
    worst = Math.max(worst, error);
    squares += error * error;
  }
  const percent = [worst, Math.sqrt(squares / count)].map((error) => (100 * error).toFixed(4));
  console.log(`spline at lambda/5.5: worst ${percent[0]} %, rms ${percent[1]} % of the peak`);
  expect(worst).toBeLessThan(3e-3);
});

test("the spline goes through the places and gives cubics exactly, at the edges too", () => {
  const [nu, nv] = [7, 4];
  const cubic = (x: number, y: number) => [x ** 3 - 2 * x * y + 1, y ** 3 * (1 + x) - x];
  const values = new Float32Array(2 * nu * nv);
  for (let j = 0; j < nv; j++) {
    for (let i = 0; i < nu; i++) values.set(cubic(i / (nu - 1), j / (nv - 1)), 2 * (j * nu + i));
  }
  const lattice: Lattice = { corner: [1, 2, 3], u: [2, 0, 0], v: [0, 0, 0.5], nu, nv, values };
  for (const [x, y] of [
    [0, 0],
    [1, 1],
    [0.5, 1 / 3],
    [0.03, 0.97],
    [0.71, 0.4],
    [0.99, 0.01],
  ]) {
    const [re, im] = cubic(x, y);
    const got = sampleAt(lattice, x, y);
    expect(got[0]).toBeCloseTo(re, 5);
    expect(got[1]).toBeCloseTo(im, 5);
    const placed = sample(lattice, [1 + 2 * x, 7, 3 + 0.5 * y]);
    expect(Math.hypot(placed[0] - got[0], placed[1] - got[1])).toBeLessThan(1e-12);
  }
  expect(sampleAt(lattice, 2, -1)).toEqual(sampleAt(lattice, 1, 0));
});

test("a lattice too small for a spline is refused in one line", () => {
  const lattice: Lattice = {
    corner: [0, 0, 0],
    u: [1, 0, 0],
    v: [0, 1, 0],
    nu: 3,
    nv: 9,
    values: new Float32Array(54),
  };
  expect(() => sampleAt(lattice, 0, 0)).toThrow("3 x 9");
});
