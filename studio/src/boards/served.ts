/** Served: a board of `midair studio --on`. Python on this machine plays the page's drives. */

import { Connection, type Report } from "./connection.ts";
import { type Notice, notice, noticeOf } from "../state/notice.ts";
import type { ArrayChoice } from "../state/types.ts";

/** A board as the server describes it; its array is written as in scene files. */
export interface ServedBoard {
  name: string;
  array: { preset: string; tiles?: [number, number]; mask?: unknown } | { positions: number[][]; mask?: unknown };
}

/** Interval in ms at which a drive is sent again. The server turns the board off if a page sends nothing for a second. */
const AGAIN = 250;

/** Returns whether the drives of an array fit a board. */
export function fits({ array: board }: ServedBoard, array: ArrayChoice): boolean {
  if (JSON.stringify(board.mask) !== JSON.stringify(array.parts?.mask)) return false;
  if ("preset" in board) return "preset" in array && array.preset === board.preset && array.tiles.join() === (board.tiles ?? [1, 1]).join();
  return "positions" in array && JSON.stringify(array.positions) === JSON.stringify(board.positions);
}

/** A board that Python plays. */
export class Served extends Connection {
  private drive: Float32Array | null = null;
  private runs = false;
  private wake = () => undefined as void;

  constructor(
    private readonly name: string,
    report: Report,
  ) {
    super(report);
  }

  play(drive: Float32Array): void {
    if (this.state === "gone") return;
    this.drive = drive;
    this.turn("playing");
    this.wake();
    if (!this.runs) void this.run();
  }

  async off(notice?: Notice): Promise<void> {
    if (this.state === "gone") return;
    this.drive = null;
    this.wake();
    this.turn("off", notice);
    await this.give(new Float32Array());
  }

  async close(): Promise<void> {
    await this.off();
    this.turn("gone");
  }

  /**
   * Sends the server a drive, or silence if it is empty. The time in the address lets the server ignore requests that arrive
   * out of order. Returns the server's error message, or "".
   */
  private async give(content: Float32Array): Promise<string> {
    const at = (performance.timeOrigin + performance.now()).toFixed(3);
    const body = new Float32Array(content);
    const headers = { "Content-Type": "application/octet-stream" };
    try {
      // With `keepalive`, silence is sent even while the page is being closed.
      const answer = await fetch(`board?${at}`, { method: "POST", body, headers, keepalive: content.length === 0 });
      return answer.ok ? "" : (await answer.text()).split("\n")[0];
    } catch {
      this.drive = null;
      this.turn("gone", notice("studio-gone", { item: this.name }));
      return "";
    }
  }

  private async run(): Promise<void> {
    this.runs = true;
    while (this.drive) {
      const { drive } = this;
      const refused = await this.give(drive);
      if (refused) await this.off(noticeOf(refused));
      if (this.drive !== drive) continue;
      await new Promise<void>((done) => {
        this.wake = done;
        setTimeout(done, AGAIN);
      });
    }
    this.runs = false;
  }
}
