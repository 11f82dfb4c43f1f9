/** The studio: one state, its history, and the newest solutions for it. */

import type { Answer } from "./door.ts";
import type { Engine } from "./engine.ts";
import { sceneOf } from "../state/scene_file.ts";
import { createHistory } from "../state/history.ts";
import { boxOf, gridOf } from "./lattices.ts";
import { planesOf } from "../state/plane.ts";
import { fits, signatureOf } from "../state/signature.ts";
import type { Grid, Outcome } from "./solve.worker.ts";
import type { Lattice, Slot, State, Touched, TouchQuantity, Vec3, Volume } from "../state/types.ts";

/** The solution of a slot, or the reason why it has none. */
export interface Result {
  answer: Answer | null;
  lattice: Lattice | null;
  /** The other slices that cross it, if they are shown. */
  crossing: Lattice[];
  /** |p| at the ear in Pa. */
  atEar: number;
  /** The time of a solve in ms; NaN until it is measured while nothing moves. */
  milliseconds: number;
  refused: string;
  warnings: string[];
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

/** The state with its results, and the functions that change it. */
export interface Studio {
  readonly view: View;
  /** Changes the state; changes of the same gesture are one step of undo. */
  change(partial: Partial<State>, gesture?: string): void;
  /** Sets whether something is being moved; pictures are then coarser. */
  moving(is: boolean): void;
  undo(): boolean;
  redo(): boolean;
  canUndo(): boolean;
  canRedo(): boolean;
  /** Resolves when everything except the bound matches the state. */
  settled(): Promise<void>;
  show(frame: View["frame"]): void;
  /** Returns the scene file of a slot, as JSON text. */
  scene(slot: Slot): string;
  /** Calls `listener` at each change; returns a function that ends it. */
  listen(listener: () => void): () => void;
  stop(): void;
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
  milliseconds: NaN,
  refused: "",
  warnings: [],
});

/** Returns a slot's result from its worker's outcome. */
export function resultOf(outcome: Outcome): Result {
  if ("refused" in outcome) return { ...nothing(), refused: outcome.refused };
  const { answer, lattices: [lattice, ...crossing], atEar } = outcome;
  return { ...nothing(), answer, lattice, crossing, atEar, warnings: [...outcome.warnings, ...answer.said] };
}

/** Returns the parts of a solution that are played. */
export const playedOf = ({ drive, scale }: Answer) => ({ drive, scale });

/** Returns the results that both slots show. */
export const shownOf = ({ results, frame }: View) => results.map((result, slot) => frame?.results[slot] ?? result) as [Result, Result];

/** Makes a studio. */
export function createStudio(engine: Engine, initial: State): Studio {
  const view: View = {
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
  const history = createHistory(initial);
  const listeners = new Set<() => void>();
  /** For each slot, the scene whose time is known. */
  const timed = ["", ""];
  let wanted = 0;
  let shown = "";
  let arrayShown = "";
  let busy = false;
  let stopped = false;
  let rest = 0;
  let waiting: (() => void)[] = [];
  const tell = () => listeners.forEach((listener) => listener());

  /** The values that the pictures depend on, as text. */
  const key = (grids: Grid[][]) => JSON.stringify([scenes(), grids, view.state.ear]);
  /** Returns the slices of both slots; only the shown slot has those that cross, because they are in the 3-D view. */
  const grids = () => {
    const all = planesOf(view.state).map((plane) => gridOf(view.state, view.moving ? COARSE : undefined, plane));
    return SLOTS.map((slot) => (slot === view.state.slot ? all : all.slice(0, 1)));
  };
  const scenes = (): [string, string] => [0, 1].map((slot) => text(slot as Slot)) as [string, string];
  const text = (slot: Slot) => JSON.stringify(sceneOf(view.state, slot));

  async function pump() {
    if (busy || stopped) return;
    busy = true;
    try {
      for (;;) {
        const wished = grids();
        if (key(wished) !== shown) await update(wished);
        else if (!view.moving && SLOTS.some(isUntimed)) await time();
        else if (!view.moving && ["volume", "both"].includes(view.state.view) && view.volume === null) await fill();
        else break;
      }
    } finally {
      busy = false;
    }
    if (view.moving || stopped) return;
    waiting.forEach((resolve) => resolve());
    waiting = [];
    clearTimeout(rest);
    if (view.bound === null) rest = window.setTimeout(bind, REST);
  }

  async function update(wished: Grid[][]) {
    const requested = key(wished);
    const [given, array] = [scenes(), JSON.stringify(view.state.array)];
    const { ear } = view.state;
    const outcomes = await Promise.all(engine.slots.map((hand, slot) => hand.update(given[slot], wished[slot], ear)));
    if (stopped) return;
    if (array !== arrayShown && outcomes.some((outcome) => "answer" in outcome)) {
      view.array = await engine.slots["answer" in outcomes[0] ? 0 : 1].array();
      const half = view.array.length / 2;
      view.positions = Float32Array.from(view.array.subarray(0, half));
      view.normals = Float32Array.from(view.array.subarray(half));
      arrayShown = array;
    }
    outcomes.forEach((outcome, slot) => take(slot as Slot, outcome));
    shown = requested;
    view.volume = null;
    tell();
  }

  function take(slot: Slot, outcome: Outcome) {
    const result = resultOf(outcome);
    // A change of slice or ear does not change the time of the solve.
    if (result.answer && timed[slot] === text(slot)) result.milliseconds = view.results[slot].milliseconds;
    view.results[slot] = result;
  }

  const isUntimed = (slot: Slot) => Boolean(view.results[slot].answer) && timed[slot] !== text(slot);

  async function time() {
    const given = scenes();
    for (const slot of SLOTS.filter(isUntimed)) {
      const milliseconds = await engine.slots[slot].time(given[slot]).catch(() => NaN);
      if (stopped || view.moving || text(slot) !== given[slot]) return;
      timed[slot] = given[slot];
      view.results[slot] = { ...view.results[slot], milliseconds };
    }
    tell();
  }

  /** Computes |p| in the box, one layer at a time; ends early when the state changes. */
  async function fill() {
    const began = wanted;
    const box = boxOf(view.state, view.array);
    const slot = view.state.slot;
    const { answer } = view.results[slot];
    const [nx, ny, nz] = box.count;
    const moduli = new Float32Array(nx * ny * nz);
    for (let layer = 0; answer && layer < nz; layer += 1) {
      const given = await engine.slow.layer(text(slot), playedOf(answer), box, layer);
      if (began !== wanted || stopped) return;
      moduli.set(given, layer * nx * ny);
    }
    view.volume = { ...box, moduli };
    tell();
  }

  async function bind() {
    const began = wanted;
    if (view.state.points.length > 64) return;
    const found = await engine.slow.bound(text(0)).catch(() => NaN);
    if (began !== wanted || stopped) return;
    view.bound = found;
    tell();
  }

  function moved(before: State) {
    wanted += 1;
    clearTimeout(rest);
    if (JSON.stringify({ ...before, scale: 0, quantity: 0 }) !== JSON.stringify({ ...view.state, scale: 0, quantity: 0 })) {
      view.frame = null;
      view.volume = null;
    }
    if (text(0) !== JSON.stringify(sceneOf(before, 0))) view.bound = null;
    tell();
    void pump();
  }

  function step(next: State | null): boolean {
    if (next === null) return false;
    const before = view.state;
    view.state = next;
    moved(before);
    return true;
  }

  void pump();
  return {
    view,
    change(partial, gesture = "") {
      const before = view.state;
      view.state = { ...before, ...partial };
      if (!view.state.pressures) view.state.filled = [];
      // Other points than those of the list are all like the first one.
      if (!fits(view.state.signature, view.state.points.length)) view.state.signature = signatureOf(view.state, [0]);
      history.keep(view.state, gesture);
      moved(before);
    },
    moving(is) {
      view.moving = is;
      if (!is) {
        history.rest();
        // The picture painted while moving was coarse, even if its lattice was not.
        if (key(grids()) === shown) tell();
      }
      void pump();
    },
    undo: () => !view.moving && step(history.undo()),
    redo: () => !view.moving && step(history.redo()),
    canUndo: () => history.canUndo(),
    canRedo: () => history.canRedo(),
    settled() {
      const promise = new Promise<void>((resolve) => waiting.push(resolve));
      void pump();
      return promise;
    },
    show(frame) {
      view.frame = frame;
      tell();
    },
    scene: text,
    listen(listener) {
      listeners.add(listener);
      return () => void listeners.delete(listener);
    },
    stop() {
      stopped = true;
      clearTimeout(rest);
    },
  };
}
