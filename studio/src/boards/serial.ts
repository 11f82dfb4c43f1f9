/** Serial: plays a board at a serial port. Sends silence first and last, and the newest drive as fast as the line allows. */

// The start-up is that of docs/boards.md: silence, and silence once more when a restarted Arduino listens. Opening the port of
// an Arduino restarts it.

import type { BoardKind, Catalogue } from "../solving/door.ts";
import { type Notice, notice, noticeOf, refuse, Refusal } from "../state/notice.ts";
import { Connection, type Report } from "./connection.ts";

/** The used part of `SerialPort` of the Web Serial API. */
export interface SerialPortLike {
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  readonly writable: WritableStream<Uint8Array> | null;
  addEventListener(kind: "disconnect", listener: () => void): void;
}

/** The needed properties of a board at a serial port. A byte takes 10 bits, at `baud` bits per second. */
export type SerialBoard = Pick<BoardKind, "name" | "baud" | "restarts">;

/** Time in ms for which a restarted Arduino listens to its boot loader. */
const RESTART = 2000;
/** The port counts as stalled if a write takes this many ms longer than the line needs for all bytes so far. */
const STALLED = 1000;
/** The next frame is sent at most this long, in ms, before the last one has left the line. */
const MOST_AHEAD = 25;
const BITS = 10;

/** Returns a short notice of an error. */
function reason(error: unknown): Notice {
  const given = noticeOf(error);
  const short = given.text.replace(/\s+/g, " ").slice(0, 80);
  return { ...given, text: short, plain: short };
}

/** Returns a promise that fails if `promise` takes longer than `ms`. */
async function within<T>(ms: number, promise: Promise<T>): Promise<T> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const late = new Promise<never>((_, fail) => {
    timer = setTimeout(() => fail(new Refusal(notice("stalled"))), ms);
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

/** A board at an open port. */
class Line extends Connection {
  private writer: WritableStreamDefaultWriter<Uint8Array>;
  private closing = false;
  private waiting: Float32Array | null = null;
  private pump: Promise<void> | null = null;
  /** The number of calls of `off`: a drive that was given before the last call is not played. */
  private era = 0;
  /** The time at which the line has sent all its bytes, and the duration of the last write on the line, in ms. */
  private free = 0;
  private carries = 0;

  constructor(
    private readonly port: SerialPortLike,
    private readonly board: SerialBoard,
    private readonly encode: (drive: Float32Array) => Promise<Uint8Array>,
    private readonly silence: Uint8Array,
    report: Report,
  ) {
    super(report);
    this.writer = port.writable!.getWriter();
    port.addEventListener("disconnect", () => void this.lose(notice("unplugged")));
  }

  /** Silences the board, and once more after a restart. */
  async begin(): Promise<this> {
    await this.give(this.silence);
    if (this.board.restarts) {
      await sleep(RESTART);
      await this.give(this.silence);
    }
    return this;
  }

  play(drive: Float32Array): void {
    if (this.state === "gone" || this.closing) return;
    this.waiting = drive;
    this.turn("playing");
    this.pump ??= this.run();
  }

  async off(given?: Notice): Promise<void> {
    if (this.state === "gone") return;
    this.waiting = null;
    this.era += 1;
    this.turn("off", given);
    await this.give(this.silence);
  }

  async close(): Promise<void> {
    if (this.state === "gone") return;
    this.closing = true;
    await this.off();
    await sleep(this.free - performance.now());
    this.turn("gone");
    this.writer.releaseLock();
    await this.port.close().catch(() => {});
  }

  /** Writes bytes to the line, after the earlier ones. */
  private async give(bytes: Uint8Array): Promise<void> {
    this.carries = (bytes.length * 1000 * BITS) / this.board.baud;
    this.free = Math.max(this.free, performance.now()) + this.carries;
    const patience = this.free - performance.now() + STALLED;
    await within(patience, this.writer.write(bytes)).catch((error) => this.lose(reason(error)));
  }

  /** Sends the newest drives. */
  private async run(): Promise<void> {
    while (this.waiting) {
      // At most a part of the last frame is still in the line when the next one is written, so that off takes effect at once.
      await sleep(this.free - performance.now() - Math.min(this.carries, MOST_AHEAD));
      const { waiting: drive, era } = this;
      this.waiting = null;
      if (!drive) break;
      try {
        const bytes = await this.encode(drive);
        if (era === this.era) await this.give(bytes);
      } catch (error) {
        if (era === this.era) await this.off(notice("unplayable", { item: this.board.name, value: reason(error) }));
      }
    }
    this.pump = null;
  }

  /** Ends after a failure of the port: drops bytes that were not sent, and tries to send silence once more. */
  private async lose(why: Notice): Promise<void> {
    if (this.state === "gone") return;
    this.state = "gone";
    this.waiting = null;
    this.era += 1;
    let code: "port-lost" | "port-gone" = "port-lost";
    try {
      await within(STALLED, this.writer.abort()).catch(() => {});
      this.writer.releaseLock();
      const last = this.port.writable!.getWriter();
      await within(STALLED, last.write(this.silence));
      last.releaseLock();
      code = "port-gone";
    } catch {
      // The message below reports this failure.
    }
    this.turn("gone", notice(code, { item: this.board.name, value: why }));
    await this.port.close().catch(() => {});
  }
}

/**
 * Opens a port and silences its board; throws a message of one line if the port cannot be opened.
 *
 * `encode` returns the bytes of a drive, `silence` turns the board off in any state. A connection whose first silence failed is
 * "gone".
 */
export async function connect(port: SerialPortLike, board: SerialBoard, encode: (drive: Float32Array) => Promise<Uint8Array>, silence: Uint8Array, report: Report): Promise<Connection> {
  try {
    await port.open({ baudRate: board.baud });
  } catch (error) {
    refuse("port-shut", { item: board.name, value: reason(error) });
  }
  return new Line(port, board, encode, silence, report).begin();
}
