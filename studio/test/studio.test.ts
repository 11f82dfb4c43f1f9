// The studio's state: what a change, undo and redo leave, and which results they drop. The engine solves nothing here.
import { afterEach, beforeEach, expect, test, vi } from "vitest";

import type { Engine } from "../src/solving/engine.ts";
import { type Shown, Studio } from "../src/solving/studio.ts";
import { initial } from "../src/state/initial.ts";
import type { State, Vec3 } from "../src/state/types.ts";

const hand = { update: async () => ({ refused: { code: "silent" } }), bound: async () => NaN };
const engine = { slots: [hand, hand], slow: hand } as unknown as Engine;
const shown = { points: [], results: [null, null], names: ["", ""] } as Shown;
const points: Vec3[] = [[0, 0, 0.1], [0.01, 0, 0.1], [0.02, 0, 0.1]];
let studio: Studio;

beforeEach(() => {
  globalThis.window = globalThis as unknown as typeof window;
  studio = new Studio(engine, initial);
});

afterEach(() => studio.stop());

test("undo and redo return whole states", () => {
  const changes: Partial<State>[] = [{ points, pressures: [1, 2, 0], filled: [1] }, { signature: "trap.focus.twin" }, { temperature: 30, quantization: "none" }];
  const states = [initial];
  for (const change of changes) {
    studio.change(change);
    states.push(studio.view.state);
  }
  expect(states.at(-1)).toEqual({ ...initial, ...changes[0], ...changes[1], ...changes[2] });
  for (const state of states.slice(0, -1).reverse()) {
    expect(studio.undo()).toBe(true);
    expect(studio.view.state).toEqual(state);
  }
  expect(studio.undo()).toBe(false);
  for (const state of states.slice(1)) {
    expect(studio.redo()).toBe(true);
    expect(studio.view.state).toEqual(state);
  }
  expect(studio.redo()).toBe(false);
});

test("while something moves there is no undo, and the movement is one step", () => {
  studio.setMoving(true);
  studio.change({ temperature: 10 }, "drag 1");
  studio.change({ temperature: 12 }, "drag 1");
  expect(studio.undo()).toBe(false);
  expect(studio.view.state.temperature).toBe(12);
  studio.setMoving(false);
  studio.change({ temperature: 14 }, "drag 1");
  studio.undo();
  expect(studio.view.state.temperature).toBe(12);
  studio.undo();
  expect(studio.view.state).toEqual(initial);
});

test("what depends on other parts of the state changes with them", () => {
  studio.change({ points, pressures: [1, 2, 0], filled: [1], signature: "trap.focus.twin" });
  studio.change({ pressures: null });
  expect(studio.view.state.filled).toEqual([]);
  studio.change({ points: points.slice(0, 2) });
  expect(studio.view.state.signature).toBe("trap");
});

test("undo drops what belongs to another state, and only that", () => {
  let calls = 0;
  studio.listen(() => (calls += 1));
  studio.change({ scale: initial.scale === "decibel" ? "linear" : "decibel" });
  studio.view.bound = 0.5;
  studio.show(shown);
  studio.undo();
  expect([studio.view.frame, studio.view.bound]).toEqual([shown, 0.5]);
  studio.change({ temperature: 30 });
  expect([studio.view.frame, studio.view.bound]).toEqual([null, null]);
  studio.view.bound = 0.5;
  studio.show(shown);
  calls = 0;
  studio.undo();
  expect([studio.view.frame, studio.view.bound]).toEqual([null, null]);
  expect(calls).toBeGreaterThan(0);
});

test("keys are one gesture until a pause, and the first of many states stays", () => {
  vi.useFakeTimers();
  for (const [after, temperature] of [[0, 1], [700, 2], [900, 3], [100, 4]]) {
    vi.advanceTimersByTime(after);
    studio.history.keep({ ...initial, temperature }, "key temperature");
  }
  expect(studio.history.undo()?.temperature).toBe(2);
  expect(studio.history.undo()).toEqual(initial);
  for (let temperature = 1; temperature < 600; temperature += 1) studio.history.keep({ ...initial, temperature }, "");
  let steps = 0;
  let first: State | null = null;
  for (let state = studio.history.undo(); state; state = studio.history.undo()) [steps, first] = [steps + 1, state];
  expect([steps, first]).toEqual([499, initial]);
  vi.useRealTimers();
});
