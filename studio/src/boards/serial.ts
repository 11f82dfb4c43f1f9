/** Serial: plays a board at a serial port. Sends silence first and last, and the newest drive as fast as the line allows. */

// The start-up is that of docs/boards.md: silence, and silence once more when a restarted Arduino listens. Opening the port of
// an Arduino restarts it.

import type { BoardKind, Catalogue } from "../work/door.ts";

/** The used part of `SerialPort` of the Web Serial API. */
export interface SerialPortLike {
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  readonly writable: WritableStream<Uint8Array> | null;
  addEventListener(kind: "disconnect", listener: () => void): void;
}

/** The needed properties of a board at a serial port. A byte takes 10 bits, at `baud` bits per second. */
export type SerialBoard = Pick<BoardKind, "name" | "baud" | "restarts">;

/** "gone" means that the port has failed or was closed. */
export type PlayerState = "off" | "playing" | "gone";

export interface Player {
  readonly state: PlayerState;
  /** Plays a drive (N of re, im) until the next one; if drives come too fast, only the newest is sent. */
  play(drive: Float32Array): void;
  /** Turns everything off at once; resolves when the port has accepted the bytes. */
  off(): Promise<void>;
  /** Turns everything off and closes the port. */
  close(): Promise<void>;
}

/** Time in ms for which a restarted Arduino listens to its boot loader. */
const RESTART = 2000;
/** The port counts as stalled if a write takes this many ms longer than the line needs for all bytes so far. */
const STALLED = 1000;
/** The next frame is sent at most this long, in ms, before the last one has left the line. */
const MOST_AHEAD = 25;
const BITS = 10;

function reason(error: unknown): string {
  return String(error instanceof Error ? error.message : error).replace(/\s+/g, " ").slice(0, 80);
}

/** Returns a promise that fails if `promise` takes longer than `ms`. */
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

/** Returns the serial board that plays a preset; null if none does. */
export function boardOf({ presets, boards }: Catalogue, preset: string): SerialBoard | null {
  const name = presets.find((each) => each.name === preset)?.board;
  return boards.find((each) => each.name === name && each.baud > 0) ?? null;
}

/**
 * Opens a port and silences its board; throws a message of one line if the port cannot be opened.
 *
 * `encode` returns the bytes of a drive, `silence` turns the board off in any state. `report` is called with each new state,
 * and with one line if something failed. A player whose first silence failed is "gone".
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
  /** The number of calls of `off`: a drive that was given before the last call is not played. */
  let era = 0;
  /** The time at which the line has sent all its bytes, and the duration of the last write on the line, in ms. */
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

  /** Writes bytes to the line, after the earlier ones. */
  async function give(bytes: Uint8Array): Promise<void> {
    carries = bytes.length * byte;
    free = Math.max(free, performance.now()) + carries;
    const patience = free - performance.now() + STALLED;
    await within(patience, writer.write(bytes)).catch((error) => lose(reason(error)));
  }

  /** Ends after a failure of the port: drops bytes that were not sent, and tries to send silence once more. */
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
      // The message below reports this failure.
    }
    report("gone", `the port of ${board.name} is gone (${why}): ${cure}`);
    await port.close().catch(() => {});
  }

  async function run(): Promise<void> {
    while (waiting) {
      // At most a part of the last frame is still in the line when the next one is written, so that off takes effect at once.
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

/** The part of a document that tells whether it is visible. */
export type Seen = EventTarget & { readonly hidden: boolean; hasFocus(): boolean };

/**
 * Turns the player off on Escape, and when the page is hidden or loses the focus. Closes the port when the page is left or
 * opens another address, which another page can cause. Returns a function that ends this watch.
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

/** Waits for a player. Returns it, and whether the page was always visible, had the focus and stayed at its address. */
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
