/** Served: a board of `midair studio --on`. Python on this machine plays the page's drives. */

import type { Player, PlayerState } from "./serial.ts";
import type { ArrayChoice } from "../state/types.ts";

/** A board as the server describes it; its array is written as in scene files. */
export interface ServedBoard {
  name: string;
  array: { preset: string; tiles?: [number, number]; mask?: unknown } | { positions: number[][]; mask?: unknown };
}

/** Interval in ms at which a drive is sent again. The server turns the board off if a page sends nothing for a second. */
const AGAIN = 250;

/** Returns whether the drives of an array fit a board. */
export function fits({ array: own }: ServedBoard, array: ArrayChoice): boolean {
  if (JSON.stringify(own.mask) !== JSON.stringify(array.parts?.mask)) return false;
  if ("preset" in own) return "preset" in array && array.preset === own.preset && array.tiles.join() === (own.tiles ?? [1, 1]).join();
  return "positions" in array && JSON.stringify(array.positions) === JSON.stringify(own.positions);
}

/** Makes the player of a served board; `report` is called with each new state, and with one line if something failed. */
export function createServed(name: string, report: (state: PlayerState, line: string) => void): Player {
  let state: PlayerState = "off";
  let drive: Float32Array | null = null;
  let runs = false;
  let wake = () => undefined as void;

  function turn(next: PlayerState, line = "") {
    if (state === next && !line) return;
    state = next;
    report(state, line);
  }

  /**
   * Sends the server a drive, or silence if it is empty. The time in the address lets the server ignore requests that arrive
   * out of order. Returns the server's error message, or "".
   */
  async function give(content: Float32Array): Promise<string> {
    const at = (performance.timeOrigin + performance.now()).toFixed(3);
    const body = new Float32Array(content);
    const headers = { "Content-Type": "application/octet-stream" };
    try {
      // With `keepalive`, silence is sent even while the page is being closed.
      const answer = await fetch(`board?${at}`, { method: "POST", body, headers, keepalive: content.length === 0 });
      return answer.ok ? "" : (await answer.text()).split("\n")[0];
    } catch {
      drive = null;
      turn("gone", `midair studio, which has ${name}, is gone: the board is off, start it again`);
      return "";
    }
  }

  async function run() {
    runs = true;
    while (drive) {
      const given: Float32Array = drive;
      const refused = await give(given);
      if (refused) await off(refused);
      if (drive !== given) continue;
      await new Promise<void>((done) => {
        wake = done;
        setTimeout(done, AGAIN);
      });
    }
    runs = false;
  }

  async function off(line = "") {
    if (state === "gone") return;
    drive = null;
    wake();
    turn("off", line);
    await give(new Float32Array());
  }

  return {
    get state() {
      return state;
    },
    play(next) {
      if (state === "gone") return;
      drive = next;
      turn("playing");
      wake();
      if (!runs) void run();
    },
    off: () => off(),
    async close() {
      await off();
      turn("gone");
    },
  };
}
