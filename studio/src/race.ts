/** Race: who computes slices, the workers or the graphics card, by a timed pass over the array that is shown. */

import type { Answer } from "./door.ts";
import type { Hand } from "./engine.ts";
import { gridOf, wavelength } from "./lattices.ts";
import type { Summing, Waves } from "./painter/summing.ts";
import type { Grid } from "./solve.worker.ts";
import type { State } from "./types.ts";

/** Places along a side of the lattice that both compute. */
const PLACES = 32;

/** Cosines at which the directivity is asked for. */
const COSINES = 257;

/** The card's values may differ by so much of the largest. */
const AGREED = 1e-3;

/** A card that is slower by this factor is none, whatever the array. */
const HOPELESS = 3;

/** Who computes. */
export interface Race {
  /** Who computes what the state asks. */
  engine(state: State): "gpu" | "worker";
  /** Whether a real graphics card paints: then nothing need be spared while something moves. */
  swift(): boolean;
  /** Hands over what gives the card's sum; null where it has none. */
  lend(summing: () => Summing | null): void;
  /** Whether the timed pass is still to be run for such an array, air and obstacles. */
  open(state: State): boolean;
  /** Runs it with a worker that has just found the answer to that scene. */
  run(hand: Hand, scene: string, state: State, answer: Answer, array: Float64Array): Promise<void>;
  /** The field of an answer on a lattice, by the card. */
  sum(answer: Answer, grid: Grid): Float32Array;
}

const keyOf = ({ array, temperature, obstacles }: State) => JSON.stringify([array, temperature, obstacles]);
const played = ({ drive, scale }: Answer) => drive.map((q) => q * scale);

/** A race that is open; `forced` spares the card the timing, not the comparison. */
export function createRace(forced: boolean): Race {
  let summing: () => Summing | null = () => null;
  let raced = "";
  let waves: Waves | null = null;
  let swift = false;
  let hopeless = false;

  async function compare(hand: Hand, scene: string, state: State, answer: Answer, array: Float64Array) {
    const half = array.length / 2;
    const length = wavelength(state);
    const found: Waves = {
      positions: Float32Array.from(array.subarray(0, half)),
      normals: Float32Array.from(array.subarray(half)),
      wavelength: length,
      pattern: await hand.pattern(scene, length, COSINES),
    };
    const grid = gridOf(state, PLACES);
    const { values, milliseconds } = await hand.timed(grid);
    const drive = played(answer);
    const sum = summing()!;
    // The first time compiles.
    sum(found, drive, grid);
    const begin = performance.now();
    const own = sum(found, drive, grid);
    const taken = performance.now() - begin;
    const most = values.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
    const agreed = values.every((value, k) => Math.abs(value - own[k]) <= AGREED * most);
    swift = taken < milliseconds;
    hopeless = taken > HOPELESS * milliseconds && !forced;
    return agreed && (swift || forced) ? found : null;
  }

  return {
    engine: (state) => (waves && summing() && keyOf(state) === raced ? "gpu" : "worker"),
    swift: () => swift,
    lend(given) {
      summing = given;
    },
    open: (state) => !hopeless && keyOf(state) !== raced && summing() !== null,
    async run(hand, scene, state, answer, array) {
      raced = keyOf(state);
      waves = await compare(hand, scene, state, answer, array).catch(() => null);
    },
    sum: (answer, grid) => summing()!(waves!, played(answer), grid),
  };
}
