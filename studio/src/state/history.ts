/** History: stores states as JSON text for undo and redo; a gesture is one step. */

import type { State } from "./types.ts";

/** Undo and redo. */
export interface History {
  /** Stores a state. A state of the same gesture replaces the last one, until `rest` or, for keys, a pause. */
  keep(state: State, gesture: string): void;
  rest(): void;
  undo(): State | null;
  redo(): State | null;
  canUndo(): boolean;
  canRedo(): boolean;
}

/** Number of stored states; the first state is always kept. */
const MOST = 500;

/** A pause that ends a gesture of keys, in ms. */
const PAUSE = 800;

/** Makes a history that begins with a state. */
export function createHistory(initial: State): History {
  let steps = [JSON.stringify(initial)];
  let at = 0;
  let last = "";
  let when = 0;
  const read = (): State => JSON.parse(steps[at]);
  return {
    keep(state, gesture) {
      const text = JSON.stringify(state);
      if (text === steps[at]) return;
      const now = performance.now();
      const paused = !gesture.startsWith("drag") && now - when > PAUSE;
      const same = gesture !== "" && gesture === last && !paused;
      [last, when] = [gesture, now];
      steps = steps.slice(0, same ? at : at + 1);
      // A gesture that ends where it began adds no step.
      if (text === steps.at(-1)) last = "";
      else steps.push(text);
      if (steps.length > MOST) steps.splice(1, 1);
      at = steps.length - 1;
    },
    rest() {
      last = "";
    },
    undo() {
      last = "";
      if (at === 0) return null;
      at -= 1;
      return read();
    },
    redo() {
      last = "";
      if (at === steps.length - 1) return null;
      at += 1;
      return read();
    },
    canUndo: () => at > 0,
    canRedo: () => at < steps.length - 1,
  };
}
