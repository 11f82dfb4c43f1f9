/** The studio: one state, its history, and the newest answers to it. */

import type { Answer } from "./door.ts";
import type { Engine } from "./engine.ts";
import { sceneOf } from "./scene_file.ts";
import { createHistory } from "./history.ts";
import { boxOf, gridOf } from "./lattices.ts";
import { planesOf } from "./plane.ts";
import type { Grid, Outcome } from "./solve.worker.ts";
import type { Lattice, Slot, State, Volume } from "./types.ts";

/** A slot's answer, or the reason why it has none. */
export interface Result {
  answer: Answer | null;
  lattice: Lattice | null;
  /** The slices that cross it, where they are shown. */
  crossing: Lattice[];
  /** |p| at the ear in Pa. */
  atEar: number;
  /** The time of a solve in ms, NaN until it was measured at rest. */
  milliseconds: number;
  refused: string;
  warnings: string[];
}

/** The replacement of the results; null: that slot is unchanged. */
export interface Shown {
  points: State["points"];
  results: [Result | null, Result | null];
  /** The name that a slot shows in place of its method; "": the method's name. */
  names: [string, string];
  /** The largest change of a phase of a path from the frame before, rad. */
  change?: number;
}

/** Everything that the page shows. */
export interface View {
  state: State;
  results: [Result, Result];
  /** The level that no drive exceeds; null while it is looked for. */
  bound: number | null;
  volume: Volume | null;
  /** Positions and normals (2 N, 3) of the array, and the same for the painter. */
  array: Float64Array;
  positions: Float32Array;
  normals: Float32Array;
  /** The replacement of the results: a frame of what moves, or a drive that came by file. */
  frame: Shown | null;
  /** Whether something is being moved. */
  moving: boolean;
}

/** The state, changed step by step, and its results. */
export interface Studio {
  readonly view: View;
  /** Changes the state; changes of one gesture are one step of undo. */
  change(partial: Partial<State>, gesture?: string): void;
  /** Whether something is being moved: pictures are coarser then. */
  moving(is: boolean): void;
  undo(): boolean;
  redo(): boolean;
  canUndo(): boolean;
  canRedo(): boolean;
  /** When everything but the bound is as the state asks. */
  settled(): Promise<void>;
  show(frame: View["frame"]): void;
  /** The scene file of a slot, as JSON text. */
  scene(slot: Slot): string;
  /** Calls at each change; returns the function that ends it. */
  listen(listener: () => void): () => void;
  stop(): void;
}

const SLOTS: Slot[] = [0, 1];

/** Places along a side while something moves. */
const COARSE = 64;

/** Rest before the bound is looked for, in ms. */
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

/** A slot's result from its worker's. */
export function resultOf(outcome: Outcome): Result {
  if ("refused" in outcome) return { ...nothing(), refused: outcome.refused };
  const { answer, lattices: [lattice, ...crossing], atEar } = outcome;
  return { ...nothing(), answer, lattice, crossing, atEar, warnings: [...outcome.warnings, ...answer.said] };
}

/** The played part of an answer, without the parts that a worker does not need. */
export const playedOf = ({ drive, scale }: Answer) => ({ drive, scale });

/** The display of both slots. */
export const shownOf = ({ results, frame }: View) => results.map((result, slot) => frame?.results[slot] ?? result) as [Result, Result];

/** A studio with its engine. */
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
  /** The scenes whose times are known. */
  const timed = ["", ""];
  let wanted = 0;
  let shown = "";
  let arrayShown = "";
  let busy = false;
  let stopped = false;
  let rest = 0;
  let waiting: (() => void)[] = [];
  const tell = () => listeners.forEach((listener) => listener());

  /** The values that the pictures depend on. */
  const key = (grids: Grid[][]) => JSON.stringify([scenes(), grids, view.state.ear]);
  /** The slices of both slots: those that cross are in the 3-D view alone. */
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
    // With another slice or ear the same solve takes as long as before.
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

  /** |p| in the box, a layer at a time; given up when the state changes. */
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
      history.keep(view.state, gesture);
      moved(before);
    },
    moving(is) {
      view.moving = is;
      if (!is) {
        history.rest();
        // The picture was a coarse one, even where its lattice was not.
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
