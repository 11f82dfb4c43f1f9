/** Connection: to a board that plays the page's drives, and is turned off when the page is left or hidden. */

import type { Notice } from "../state/notice.ts";

/** "gone" means that the connection has failed or was closed. */
export type ConnectionState = "off" | "playing" | "gone";

/** Is called with each new state, and with a notice if something failed. */
export type Report = (state: ConnectionState, notice?: Notice) => void;

export abstract class Connection {
  state: ConnectionState = "off";

  constructor(private readonly report: Report) {}

  /** Plays a drive (N of re, im) until the next one; if drives come too fast, only the newest is sent. */
  abstract play(drive: Float32Array): void;
  /** Turns everything off at once, and reports a notice; resolves when the board has accepted this. */
  abstract off(notice?: Notice): Promise<void>;
  /** Turns everything off and ends the connection. */
  abstract close(): Promise<void>;

  protected turn(next: ConnectionState, notice?: Notice): void {
    if (this.state === next && !notice) return;
    this.state = next;
    this.report(next, notice);
  }
}

/** The part of a document that tells whether it is visible. */
export type Seen = EventTarget & { readonly hidden: boolean; hasFocus(): boolean };

/**
 * Turns the board off on Escape, and when the page is hidden or loses the focus. Closes the port when the page is left or
 * opens another address, which another page can cause. Returns a function that ends this watch.
 *
 * A page that is killed can send nothing: the board then plays until its power is switched off.
 */
export function guard(connection: Pick<Connection, "off" | "close">, window: EventTarget, document: Seen): () => void {
  const off = () => void connection.off();
  const close = () => void connection.close();
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

/** Waits for a connection. Returns it, and whether the page was always visible, had the focus and stayed at its address. */
export async function attended<Each extends Connection>(begun: Promise<Each>, window: EventTarget, document: Seen): Promise<{ connection: Each; present: boolean }> {
  let [left, led] = [false, false];
  const off = async () => void (left = true);
  const close = async () => void (left = led = true);
  const end = guard({ off, close }, window, document);
  try {
    const connection = await begun;
    if (led) void connection.close();
    return { connection, present: !left && !document.hidden && document.hasFocus() };
  } finally {
    end();
  }
}
