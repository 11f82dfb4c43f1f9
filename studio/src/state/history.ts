/** History: stores states as JSON text for undo and redo; a gesture is one step. */

import type { State } from "./types.ts";

/** Number of stored states; the first state is always kept. */
const MOST = 500;

/** A pause that ends a gesture of keys, in ms. */
const PAUSE = 800;

/** Undo and redo. */
export class History {
  private steps: string[];
  private at = 0;
  private last = "";
  private when = 0;

  constructor(initial: State) {
    this.steps = [JSON.stringify(initial)];
  }

  /** Stores a state. A state of the same gesture replaces the last one, until `rest` or, for keys, a pause. */
  keep(state: State, gesture: string): void {
    const text = JSON.stringify(state);
    if (text === this.steps[this.at]) return;
    const now = performance.now();
    const paused = !gesture.startsWith("drag") && now - this.when > PAUSE;
    const same = gesture !== "" && gesture === this.last && !paused;
    [this.last, this.when] = [gesture, now];
    this.steps = this.steps.slice(0, same ? this.at : this.at + 1);
    // A gesture that ends where it began adds no step.
    if (text === this.steps.at(-1)) this.last = "";
    else this.steps.push(text);
    if (this.steps.length > MOST) this.steps.splice(1, 1);
    this.at = this.steps.length - 1;
  }

  /** Ends the gesture. */
  rest(): void {
    this.last = "";
  }

  canUndo = () => this.at > 0;
  canRedo = () => this.at < this.steps.length - 1;
  undo = () => this.step(-1);
  redo = () => this.step(1);

  private step(way: number): State | null {
    this.rest();
    if (!(this.at + way in this.steps)) return null;
    this.at += way;
    return JSON.parse(this.steps[this.at]);
  }
}
