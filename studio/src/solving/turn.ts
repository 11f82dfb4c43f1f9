/** Turn: one round of the points on their path, solved frame by frame by `glide`, and the contents of its frames. */

import { framesOf, lengthOf } from "../making/paths.ts";
import { planesOf } from "../state/plane.ts";
import { sceneOf } from "../state/scene_file.ts";
import { isTrap } from "../state/signature.ts";
import type { Path, Slot, State, TouchQuantity, Vec3 } from "../state/types.ts";
import { type BeadFlight, beadsAt } from "./beads.ts";
import type { Frame } from "./door.ts";
import type { Engine } from "./engine.ts";
import { gridOf } from "./lattices.ts";
import { resultOf, type Shown } from "./studio.ts";
import { predict, type Skin } from "./touch.ts";

/** Computed frames per second, if a turn then has between FEWEST and MOST frames. */
const RATE = 1000;

/** The most, in m, that a point moves from frame to frame, unless a turn then has more than MOST frames: glide can follow this. */
const STEP = 0.35e-3;

/** The fewest and the most frames of a turn. */
const FEWEST = 80;
const MOST = 1000;

/** The most frames from one picture to the next, and the fewest pictures of a turn, which takes some seconds. */
const STRIDE = 4;
const PICTURES = 40;

/** Samples along a side of a slice that moves. */
const COARSE = 80;

/** Time in ms for a frame of B, above which B is shown at rest. */
const PATIENCE = 300;

/** The fewest turns a second whose skin is predicted, and whose beads are simulated: slower turns take too long. */
export const SLOWEST = 2;

/** Returns the number of frames of a turn. */
export function countOf(path: Path): number {
  const fine = 4 * Math.ceil(lengthOf(path) / STEP / 4);
  return Math.max(FEWEST, Math.min(MOST, Math.max(fine, Math.round(RATE / path.frequency))));
}

/** Returns the part of a state that a turn depends on, as text. */
export const requestOf = (state: State) => JSON.stringify({ ...state, quantity: 0, scale: 0, slot: 0 });

/** A solved turn. The worker for slow work has its drives until it solves another. */
export class Turn {
  readonly request: string;
  readonly count: number;
  /** Frames per second. */
  readonly rate: number;
  /** The simulated motion of the beads so far. */
  readonly flights: BeadFlight[] = [];
  private skin: Skin | null = null;
  /** Whether B takes too long for an animation. */
  private slow = false;

  private constructor(
    private readonly engine: Engine,
    readonly state: State,
    private readonly places: Float64Array,
    readonly frames: Frame[],
  ) {
    this.request = requestOf(state);
    this.count = frames.length;
    this.rate = this.count * state.path!.frequency;
  }

  /** Solves the turn of a state that has a path. */
  static async solve(engine: Engine, state: State): Promise<Turn> {
    const path = state.path!;
    const count = countOf(path);
    const rate = count * path.frequency;
    const places = framesOf(state.points, path, rate, count / rate);
    const scene = JSON.stringify({ ...sceneOf(state, 0), solver: { ...state.options.glide, name: "glide", rate } });
    return new Turn(engine, state, places, await engine.slow.follow(scene, places, count));
  }

  /** The number of frames from one picture to the next. */
  get stride(): number {
    return Math.max(1, Math.min(STRIDE, Math.floor(this.count / PICTURES)));
  }

  /** The largest phase change of each frame, in rad. The first has that of the second, because no frame is before it. */
  get changes(): number[] {
    return this.frames.map(({ change }, t) => (t ? change : this.frames[1].change));
  }

  /** The points that are traps, from 0. */
  get traps(): number[] {
    return [...this.state.points.keys()].filter((point) => isTrap(this.state.signature, point));
  }

  private pointsAt(t: number): Vec3[] {
    const count = this.state.points.length;
    return this.state.points.map((_, j) => [...this.places.subarray(3 * (t * count + j), 3 * (t * count + j) + 3)] as Vec3);
  }

  /**
   * Returns a frame of both methods, B null while it is too slow; or null if `stopped` meanwhile. With a quantity, A's slice is
   * the touch of a skin above so many transducers. `lap` counts the turns of the beads.
   */
  async show(t: number, lap: number, quantity: TouchQuantity | null, transducers: number, stopped: () => boolean): Promise<Shown | null> {
    const { state, engine } = this;
    const points = this.pointsAt(t);
    const scene = (slot: Slot) => JSON.stringify(sceneOf({ ...state, points }, slot));
    const grids = quantity ? [] : planesOf(state).map((plane) => gridOf(state, COARSE, plane));
    const before = performance.now();
    const passing = async () => {
      const outcome = await engine.slots[1].update(scene(1), grids, state.ear, true);
      this.slow = performance.now() - before > PATIENCE;
      return resultOf(outcome);
    };
    const [outcome, b] = await Promise.all([engine.slow.frame(t, scene(0), grids, state.ear), this.slow || state.level === "play" ? null : passing()]);
    if (stopped()) return null;
    const a = resultOf(outcome);
    const beads = beadsAt(this.flights, lap * this.count + t, this.count, this.rate);
    const shown: Shown = { points, results: [a, b], names: ["glide", ""], change: this.frames[t].change, beads };
    if (!quantity) return shown;
    this.skin ??= await predict(engine.slow, state, transducers, this.rate);
    const lattice = quantity === "skin" ? await this.skin.moved(t) : this.skin[quantity];
    // The skin is predicted for A's frames only.
    return stopped() ? null : { ...shown, results: [{ ...a, lattice }, b && { ...b, lattice: null }], touch: { ...this.skin, quantity } };
  }

  /** Simulates the bead in the trap of a point; keeps it unless `stopped` meanwhile. */
  async fly(point: number, stopped: () => boolean): Promise<boolean> {
    const flight = { point, ...(await this.engine.slow.fly(point, this.rate)) };
    return !stopped() && Boolean(this.flights.push(flight));
  }
}
