/** Random states for tests: the same seed gives the same states. */

import { AXES, LEVELS, QUANTITIES, SCALES, VIEWS } from "../src/state/types.ts";
import type { Obstacle, State, Vec3 } from "../src/state/types.ts";

/** Returns a generator of numbers in [0, 1), mulberry32. */
export function generator(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Returns a state whose lengths are multiples of 0.01 mm; its array is a preset. */
export function randomState(random: () => number): State {
  const below = (count: number) => Math.floor(random() * count);
  const one = <T>(of: readonly T[]): T => of[below(of.length)];
  const length = (least: number, most: number) =>
    Math.round(1e5 * (least + random() * (most - least))) / 1e5 + 0;
  const place = (): Vec3 => [length(-0.2, 0.2), length(-0.2, 0.2), length(0, 0.4)];
  const kind = () => one(["rigid", "soft"] as const);
  const obstacle = (): Obstacle =>
    random() < 0.5
      ? { center: place(), radius: length(0.001, 0.05), kind: kind() }
      : { point: place(), normal: [random() - 0.5, random() - 0.5, random()], kind: kind() };
  const points = Array.from({ length: 1 + below(64) }, place);
  const pressures = random() < 0.5 ? null : points.map(() => (random() < 0.2 ? 0 : 5000 * random()));
  const frequency = 0.1 + random();
  return {
    array: one([
      { preset: "autd3", tiles: [1 + below(8), 1 + below(8)] },
      { preset: "openmpd_pair", tiles: [1, 1] },
    ]),
    quantization: one(["board", "none"]),
    temperature: below(1200) / 10 - 60,
    absorption: one([null, random()]),
    density: one([null, 1 + random()]),
    points,
    pressures,
    filled: pressures ? points.map((_, k) => k).filter(() => random() < 0.3) : [],
    methods: [one(["uniform", "greedy"]), one(["naive", "gspat"])],
    options: one<State["options"]>([{}, { greedy: { seed: below(9), order: "random" } }]),
    bead: one([null, { radius: length(0.0005, 0.002), density: 20 + random(), sound_speed: 900, gravity: [0, 0, -9.81] }]),
    signature: one(["", "trap", "twin", "vortex", ...(points.length > 1 ? [points.map((_, k) => ["trap", "focus"][k % 2]).join(".")] : [])]),
    obstacles: Array.from({ length: below(3) }, obstacle),
    ear: random() < 0.5 ? null : place(),
    plane: {
      axis: one(AXES),
      z: length(0, 0.3),
      size: length(0.01, 0.3),
      center: random() < 0.5 ? [0, 0] : [length(-0.1, 0.1), length(-0.1, 0.1)],
    },
    level: one(LEVELS),
    view: one(VIEWS),
    quantity: one(QUANTITIES),
    slot: one([0, 1]),
    scale: one(SCALES),
    path: one([
      null,
      { kind: "circle", radius: length(0.001, 0.05), frequency },
      { kind: "line", length: length(0.001, 0.05), frequency },
    ]),
  };
}
