/** Initial: the state that links are relative to, and the state of the page without a link. */

import keys from "../../../python/midair/_studio/keys.json";
import type { State, Vec3 } from "./types.ts";

/** The largest number of points on the page. */
export const MOST_POINTS = keys.points[0] as number;

/** Above this number of points they are dots without numbers and plumb lines, so that they do not hide the field. */
export const MANY = 20;

const RING = 0.04;
/** The height of the points above an array, in m. */
export const HEIGHT = 0.18;

function ring(count: number): Vec3[] {
  const angle = (index: number) => (2 * Math.PI * index) / count;
  const round = (x: number) => Math.round(x * 1e5) / 1e5;
  return Array.from({ length: count }, (_, k) => [
    round(RING * Math.cos(angle(k))),
    round(RING * Math.sin(angle(k))),
    HEIGHT,
  ]);
}

/**
 * The values that links leave out: seven points on a ring of 40 mm radius and one in its middle, 180 mm above four AUTD3
 * boards.
 */
export const initial: State = {
  array: { preset: "autd3", tiles: [2, 2] },
  quantization: "board",
  temperature: 25,
  absorption: null,
  density: null,
  points: [...ring(7), [0, 0, HEIGHT]],
  pressures: null,
  filled: [],
  methods: ["uniform", "naive"],
  options: {},
  signature: "",
  bead: null,
  obstacles: [],
  ear: null,
  plane: { axis: "z", z: HEIGHT, size: 0.18, center: [0, 0] },
  level: "play",
  view: "both",
  quantity: "modulus",
  slot: 0,
  scale: "linear",
  path: null,
};

/** The state without a link: three foci over one AUTD3 board, and their wave on an upright slice. */
export const first: State = {
  ...initial,
  array: { preset: "autd3", tiles: [1, 1] },
  points: [[-0.05, 0, 0.13], [0.05, 0, 0.13], [0, 0, 0.17]],
  plane: { axis: "y", z: 0.11, size: 0.2, center: [0, 0] },
  view: "slice",
  quantity: "wave",
};
