/** The studio: one state, its history, and the newest solutions for it. */

import type { Answer } from "./door.ts";
import type { Engine } from "./engine.ts";
import { sceneOf } from "../state/scene_file.ts";
import { History } from "../state/history.ts";
import { boxOf, gridOf } from "./lattices.ts";
import { planesOf } from "../state/plane.ts";
import { fits, signatureOf } from "../state/signature.ts";
import type { Grid, Outcome } from "./solve.worker.ts";
import type { Notice } from "../state/notice.ts";
import type { Lattice, Slot, State, Touched, TouchQuantity, Vec3, Volume } from "../state/types.ts";

/** The solution of a slot, or the reason why it has none. */
export interface Result {
  answer: Answer | null;
  lattice: Lattice | null;
  /** The other slices that cross it, if they are shown. */
  crossing: Lattice[];
  /** |p| at the ear in Pa. */
  atEar: number;
  /** How many traps hold their bead, and the number of traps; empty without traps. */
  beads: number[];
  /** The time of a solve in ms; NaN until it is measured while nothing moves. */
  milliseconds: number;
  refused: Notice | null;
  warnings: Notice[];
}

/** Results that are shown instead of the solutions; null: the slot shows its own. */
export interface Shown {
  points: State["points"];
  results: [Result | null, Result | null];
  /** The name that a slot shows instead of its method; "" for the method's name. */
  names: [string, string];
  /** The largest phase change from the frame before, in rad, for a path. */
  change?: number;
  /** The touch of a skin that A's slice shows, and which of its quantities. */
  touch?: (Touched & { quantity: TouchQuantity }) | null;
  /** Places of the beads in the traps in m. */
  beads?: Vec3[];
}

/** Everything that the page shows. */
export interface View {
  state: State;
  results: [Result, Result];
  /** The level that no drive exceeds; null until it is computed. */
  bound: number | null;
  volume: Volume | null;
  /** `array`: positions, then normals (2 N, 3). `positions`, `normals`: both in single precision, for the painter. */
  array: Float64Array;
  positions: Float32Array;
  normals: Float32Array;
  /** Results shown instead of the solutions: a frame of a path, or a drive from a file. */
  frame: Shown | null;
  /** Whether something is being moved. */
  moving: boolean;
}

const SLOTS: Slot[] = [0, 1];

/** Samples along a side of a slice while something moves. */
const COARSE = 64;

/** Time in ms without changes before the bound is computed. */
const REST = 500;

const nothing = (): Result => ({
  answer: null,
  lattice: null,
  crossing: [],
  atEar: 0,
  beads: [],
  milliseconds: NaN,
  refused: null,
  warnings: [],
});

/** Returns a slot's result from its worker's outcome. */
export function resultOf(outcome: Outcome): Result {
  if ("refused" in outcome) return { ...nothing(), refused: outcome.refused };
  const { answer, lattices: [lattice, ...crossing], atEar, beads } = outcome;
  return { ...nothing(), answer, lattice, crossing, atEar, beads, warnings: [...outcome.warnings, ...answer.said] };
}

/** Returns the parts of a solution that are played. */
export const playedOf = ({ drive, scale }: Answer) => ({ drive, scale });

/** Returns the results that both slots show. */
export const shownOf = ({ results, frame }: View) => results.map((result, slot) => frame?.results[slot] ?? result) as [Result, Result];

/** The state with its results, and the functions that change it. */
export class Studio {
  readonly view: View;
  readonly history: History;
  private readonly listeners = new Set<() => void>();
  /** For each slot, the scene whose time is known. */
  private readonly timed = ["", ""];
  /** The number of changes so far: slow work for an older state ends. */
  private changes = 0;
  /** The scenes, slices and ear that the results are for, and the array whose places are known, as text. */
  private solved = "";
  private located = "";
  private busy = false;
  private stopped = false;
  private timer = 0;
  private waiting: (() => void)[] = [];

  constructor(
    private readonly engine: Engine,
    initial: State,
  ) {
    this.view = {
      state: initial,
      results: [nothing(), nothing()],
      bound: null,
      volume: null,
      array: new Float64Array(),
      positions: new Float32Array(),
      normals: new Float32Array(),
      frame: null,
      moving: false,
    };
    this.history = new History(initial);
    void this.work();
  }

  /** Changes the state; changes of the same gesture are one step of undo. */
  change(partial: Partial<State>, gesture = ""): void {
    const before = this.view.state;
    const state = { ...before, ...partial };
    if (!state.pressures) state.filled = [];
    // Other points than those of the list are all like the first one.
    if (!fits(state.signature, state.points.length)) state.signature = signatureOf(state, [0]);
    this.view.state = state;
    this.history.keep(state, gesture);
    this.changed(before);
  }

  /** Sets whether something is being moved; pictures are then coarser. */
  setMoving(moving: boolean): void {
    this.view.moving = moving;
    if (!moving) {
      this.history.rest();
      // The picture painted while moving was coarse, even if its lattice was not.
      if (this.requested(this.grids()) === this.solved) this.notify();
    }
    void this.work();
  }

  undo = () => this.step(() => this.history.undo());
  redo = () => this.step(() => this.history.redo());

  /** Resolves when everything except the bound matches the state. */
  settled(): Promise<void> {
    const settled = new Promise<void>((resolve) => this.waiting.push(resolve));
    void this.work();
    return settled;
  }

  show(frame: View["frame"]): void {
    this.view.frame = frame;
    this.notify();
  }

  /** Returns the scene file of a slot, as JSON text. */
  scene = (slot: Slot) => JSON.stringify(sceneOf(this.view.state, slot));

  /** Calls `listener` at each change; returns a function that ends it. */
  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => void this.listeners.delete(listener);
  }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.timer);
  }

  private notify(): void {
    this.listeners.forEach((listener) => listener());
  }

  private step(of: () => State | null): boolean {
    const before = this.view.state;
    const next = this.view.moving ? null : of();
    if (next === null) return false;
    this.view.state = next;
    this.changed(before);
    return true;
  }

  /** Drops the results that the new state makes false, and begins to compute others. */
  private changed(before: State): void {
    const { view } = this;
    const solved = (state: State) => JSON.stringify({ ...state, scale: 0, quantity: 0 });
    this.changes += 1;
    clearTimeout(this.timer);
    if (solved(before) !== solved(view.state)) view.frame = view.volume = null;
    if (this.scene(0) !== JSON.stringify(sceneOf(before, 0))) view.bound = null;
    this.notify();
    void this.work();
  }

  private scenes = () => SLOTS.map(this.scene);

  /** Returns the slices of both slots; only the shown slot has those that cross, because they are in the 3-D view. */
  private grids(): Grid[][] {
    const { state, moving } = this.view;
    const all = planesOf(state).map((plane) => gridOf(state, moving ? COARSE : undefined, plane));
    return SLOTS.map((slot) => (slot === state.slot ? all : all.slice(0, 1)));
  }

  /** Returns the values that the pictures depend on, as text. */
  private requested = (grids: Grid[][]) => JSON.stringify([this.scenes(), grids, this.view.state.ear]);

  /** Computes until results, times and volume match the state, one after another. */
  private async work(): Promise<void> {
    const { view } = this;
    if (this.busy || this.stopped) return;
    this.busy = true;
    try {
      for (;;) {
        const grids = this.grids();
        if (this.requested(grids) !== this.solved) await this.solve(grids);
        else if (!view.moving && SLOTS.some(this.isUntimed)) await this.time();
        else if (!view.moving && ["volume", "both"].includes(view.state.view) && view.volume === null) await this.fill();
        else break;
      }
    } finally {
      this.busy = false;
    }
    if (view.moving || this.stopped) return;
    this.waiting.forEach((resolve) => resolve());
    this.waiting = [];
    clearTimeout(this.timer);
    if (view.bound === null) this.timer = window.setTimeout(() => this.limit(), REST);
  }

  private async solve(grids: Grid[][]): Promise<void> {
    const { view, engine } = this;
    const requested = this.requested(grids);
    const [scenes, array] = [this.scenes(), JSON.stringify(view.state.array)];
    const { ear } = view.state;
    const outcomes = await Promise.all(engine.slots.map((hand, slot) => hand.update(scenes[slot], grids[slot], ear)));
    if (this.stopped) return;
    if (array !== this.located && outcomes.some((outcome) => "answer" in outcome)) {
      view.array = await engine.slots["answer" in outcomes[0] ? 0 : 1].array();
      const half = view.array.length / 2;
      view.positions = Float32Array.from(view.array.subarray(0, half));
      view.normals = Float32Array.from(view.array.subarray(half));
      this.located = array;
    }
    view.results = SLOTS.map((slot) => {
      const result = resultOf(outcomes[slot]);
      // A change of slice or ear does not change the time of the solve.
      const { milliseconds } = result.answer && this.timed[slot] === this.scene(slot) ? view.results[slot] : result;
      return { ...result, milliseconds };
    }) as View["results"];
    this.solved = requested;
    view.volume = null;
    this.notify();
  }

  private isUntimed = (slot: Slot) => Boolean(this.view.results[slot].answer) && this.timed[slot] !== this.scene(slot);

  private async time(): Promise<void> {
    const { view } = this;
    const scenes = this.scenes();
    for (const slot of SLOTS.filter(this.isUntimed)) {
      const milliseconds = await this.engine.slots[slot].time(scenes[slot]).catch(() => NaN);
      if (this.stopped || view.moving || this.scene(slot) !== scenes[slot]) return;
      this.timed[slot] = scenes[slot];
      view.results[slot] = { ...view.results[slot], milliseconds };
    }
    this.notify();
  }

  /** Returns a function that tells whether the state has changed since this call. */
  private watch(): () => boolean {
    const { changes } = this;
    return () => changes !== this.changes || this.stopped;
  }

  /** Computes |p| in the box, one layer at a time; ends early when the state changes. */
  private async fill(): Promise<void> {
    const { view } = this;
    const late = this.watch();
    const box = boxOf(view.state, view.array);
    const { slot } = view.state;
    const { answer } = view.results[slot];
    const [nx, ny, nz] = box.count;
    const moduli = new Float32Array(nx * ny * nz);
    for (let layer = 0; answer && layer < nz; layer += 1) {
      const values = await this.engine.slow.layer(this.scene(slot), playedOf(answer), box, layer);
      if (late()) return;
      moduli.set(values, layer * nx * ny);
    }
    view.volume = { ...box, moduli };
    this.notify();
  }

  /** Computes the bound on the level. */
  private async limit(): Promise<void> {
    const late = this.watch();
    if (this.view.state.points.length > 64) return;
    const bound = await this.engine.slow.bound(this.scene(0)).catch(() => NaN);
    if (late()) return;
    this.view.bound = bound;
    this.notify();
  }
}
