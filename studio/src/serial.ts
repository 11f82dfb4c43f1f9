/** Serial: a board at a serial port: the newest drive is played, silence goes first and last, a clock paces. */

// Start-up is that of docs/boards.md: silence, and once more when an Arduino listens, which restarts when its
// port is opened.

import type { BoardKind, Catalogue } from "./door.ts";

/** The used part of a `SerialPort` of the Web Serial API. */
export interface SerialPortLike {
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  readonly writable: WritableStream<Uint8Array> | null;
  addEventListener(kind: "disconnect", listener: () => void): void;
}

/** Facts about a board at a serial port; a byte takes 10 of its bits a second. */
export type SerialBoard = Pick<BoardKind, "name" | "baud" | "restarts">;

/** "gone": the port has failed, or was closed. */
export type PlayerState = "off" | "playing" | "gone";

export interface Player {
  readonly state: PlayerState;
  /** Plays a drive (N of re, im) until the next; of those that come too fast the newest. */
  play(drive: Float32Array): void;
  /** Everything off, at once; settles when the port has taken it. */
  off(): Promise<void>;
  /** Off, and the port free for others. */
  close(): Promise<void>;
}

/** An Arduino that restarts listens to its boot loader for so long, in ms. */
const RESTART = 2000;
/** A port that takes no byte for this long behind the bytes in its line is stalled, in ms. */
const STALLED = 1000;
/** Of long frames less than one is in the line when the next one comes: this part of its time, in ms. */
const MOST_AHEAD = 25;
const BITS = 10;

function reason(error: unknown): string {
  return String(error instanceof Error ? error.message : error).replace(/\s+/g, " ").slice(0, 80);
}

/** A promise that fails when it takes longer, in ms. */
async function within<T>(ms: number, promise: Promise<T>): Promise<T> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const late = new Promise<never>((_, fail) => {
    timer = setTimeout(() => fail(new Error("it takes nothing")), ms);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

function sleep(ms: number): Promise<void> {
  return new Promise((done) => setTimeout(done, Math.max(ms, 0)));
}

/** The serial board that plays a preset; null if none does. */
export function boardOf({ presets, boards }: Catalogue, preset: string): SerialBoard | null {
  const name = presets.find((each) => each.name === preset)?.board;
  return boards.find((each) => each.name === name && each.baud > 0) ?? null;
}

/**
 * Opens a port and silences the board at it; an error is one line.
 *
 * `encode` makes the bytes of a drive, `silence` turns the board off from any state. `report` gets
 * each new state, with one line where something failed; a player whose first silence failed is "gone".
 */
export async function connect(
  port: SerialPortLike,
  board: SerialBoard,
  encode: (drive: Float32Array) => Promise<Uint8Array>,
  silence: Uint8Array,
  report: (state: PlayerState, line: string) => void,
): Promise<Player> {
  const byte = (1000 * BITS) / board.baud;
  let state: PlayerState = "off";
  let closing = false;
  let waiting: Float32Array | null = null;
  let pump: Promise<void> | null = null;
  /** Drives that were given before the last off are not played. */
  let era = 0;
  /** When the line will have carried all it was given, and how long it carries the last of it, in ms. */
  let free = 0;
  let carries = 0;

  try {
    await port.open({ baudRate: board.baud });
  } catch (error) {
    const cure = "plug the board in and close the other program that holds it";
    throw new Error(`the port of ${board.name} cannot be opened (${reason(error)}): ${cure}`);
  }
  const writer = port.writable!.getWriter();
  port.addEventListener("disconnect", () => void lose("it was unplugged"));

  function turn(next: PlayerState, line = ""): void {
    if (state === next && !line) return;
    state = next;
    report(state, line);
  }

  /** Gives bytes to the line behind the earlier ones. */
  async function give(bytes: Uint8Array): Promise<void> {
    carries = bytes.length * byte;
    free = Math.max(free, performance.now()) + carries;
    const patience = free - performance.now() + STALLED;
    await within(patience, writer.write(bytes)).catch((error) => lose(reason(error)));
  }

  /** Ends with a port that failed: drops the bytes that it has not sent, and tries silence once more. */
  async function lose(why: string): Promise<void> {
    if (state === "gone") return;
    state = "gone";
    waiting = null;
    era += 1;
    let cure = "the board may still play, switch its supply off and connect again";
    try {
      await within(STALLED, writer.abort()).catch(() => {});
      writer.releaseLock();
      const last = port.writable!.getWriter();
      await within(STALLED, last.write(silence));
      last.releaseLock();
      cure = "the board was turned off, connect again";
    } catch {
      // The line tells it.
    }
    report("gone", `the port of ${board.name} is gone (${why}): ${cure}`);
    await port.close().catch(() => {});
  }

  async function run(): Promise<void> {
    while (waiting) {
      // One frame at most is still in the line when the next one comes, so that off comes at once.
      await sleep(free - performance.now() - Math.min(carries, MOST_AHEAD));
      const [drive, own]: [Float32Array | null, number] = [waiting, era];
      waiting = null;
      if (!drive) break;
      try {
        const bytes = await encode(drive);
        if (own === era) await give(bytes);
      } catch (error) {
        if (own === era) await off(`${board.name} cannot play this (${reason(error)}): it is off`);
      }
    }
    pump = null;
  }

  async function off(line = ""): Promise<void> {
    if (state === "gone") return;
    waiting = null;
    era += 1;
    turn("off", line);
    await give(silence);
  }

  async function close(): Promise<void> {
    if (state === "gone") return;
    closing = true;
    await off();
    await sleep(free - performance.now());
    turn("gone");
    writer.releaseLock();
    await port.close().catch(() => {});
  }

  await give(silence);
  if (board.restarts) {
    await sleep(RESTART);
    await give(silence);
  }
  return {
    get state() {
      return state;
    },
    play(drive) {
      if (state === "gone" || closing) return;
      waiting = drive;
      turn("playing");
      pump ??= run();
    },
    off: () => off(),
    close,
  };
}

/** The part of a document that says whether it is visible. */
export type Seen = EventTarget & { readonly hidden: boolean; hasFocus(): boolean };

/**
 * Turns the player off on Escape, and when the page is hidden or loses the focus. Closes the port when the page is left
 * or opens another address, which another page can cause. Returns a function that ends this.
 *
 * A page that is killed can send nothing: the board then plays until its power is switched off.
 */
export function guard(player: Pick<Player, "off" | "close">, window: EventTarget, document: Seen): () => void {
  const off = () => void player.off();
  const close = () => void player.close();
  const hidden = () => document.hidden && off();
  const escape = (event: Event) => (event as KeyboardEvent).key === "Escape" && off();
  const ending = new AbortController();
  const { signal } = ending;
  window.addEventListener("blur", off, { signal });
  for (const kind of ["pagehide", "hashchange", "popstate"]) window.addEventListener(kind, close, { signal });
  window.addEventListener("keydown", escape, { signal, capture: true });
  document.addEventListener("visibilitychange", hidden, { signal });
  return () => ending.abort();
}

/** Waits for a player; answers it, and whether the page was present all the time: seen, in focus, at its address. */
export async function attended(
  begun: Promise<Player>,
  window: EventTarget,
  document: Seen,
): Promise<{ player: Player; present: boolean }> {
  let [left, led] = [false, false];
  const off = async () => void (left = true);
  const close = async () => void (left = led = true);
  const end = guard({ off, close }, window, document);
  try {
    const player = await begun;
    if (led) void player.close();
    return { player, present: !left && !document.hidden && document.hasFocus() };
  } finally {
    end();
  }
}
