// Undo: a gesture is one step, and the last undo returns the very first state.
import { expect, test } from "vitest";

import { History } from "../src/state/history.ts";
import { initial } from "../src/state/initial.ts";

const warmer = (temperature: number) => ({ ...initial, temperature });

test("a gesture that ends where it began is no step", () => {
  const history = new History(initial);
  history.keep(warmer(26), "drag 1");
  history.keep(initial, "drag 1");
  expect([history.canUndo(), history.canRedo()]).toEqual([false, false]);
  history.keep(warmer(27), "drag 1");
  expect(history.undo()).toEqual(initial);
});

test("a drag is one step, however long it takes", () => {
  const history = new History(initial);
  for (let k = 0; k < 9; k += 1) history.keep(warmer(k), "drag 1");
  history.rest();
  history.keep(warmer(20), "drag 2");
  expect(history.undo()).toEqual(warmer(8));
  expect(history.undo()).toEqual(initial);
  expect(history.undo()).toBeNull();
  expect(history.redo()).toEqual(warmer(8));
});

test("something new ends what could be done again", () => {
  const history = new History(initial);
  history.keep(warmer(1), "");
  history.undo();
  history.keep(warmer(2), "");
  expect(history.canRedo()).toBe(false);
  expect(history.undo()).toEqual(initial);
});

test("what changes nothing is no step", () => {
  const history = new History(initial);
  history.keep({ ...initial }, "");
  expect(history.canUndo()).toBe(false);
});
