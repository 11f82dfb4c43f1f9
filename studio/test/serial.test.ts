import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { attended, type Connection, guard } from "../src/boards/connection.ts";
import { connect, type SerialBoard } from "../src/boards/serial.ts";

const SURFACE = { name: "sonicsurface", baud: 230400, restarts: false };
const SILENCE = Uint8Array.of(0, 0);

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

/** A simulated port that stores its bytes; with `fault`, writes fail, hang or take this many ms. */
function fakePort() {
  const port = {
    given: [] as number[][],
    opened: 0,
    closed: 0,
    delay: 0,
    fault: "" as "" | "throws" | "hangs" | "throws once",
    writable: null as WritableStream<Uint8Array> | null,
    unplug: () => {},
    async open({ baudRate }: { baudRate: number }) {
      port.opened = baudRate;
      port.writable = stream();
    },
    async close() {
      port.closed += 1;
    },
    addEventListener(_: "disconnect", listener: () => void) {
      port.unplug = () => {
        port.writable = null;
        listener();
      };
    },
  };
  function stream(): WritableStream<Uint8Array> {
    return new WritableStream({
      async write(bytes) {
        if (port.fault === "hangs") await new Promise(() => {});
        if (port.fault.startsWith("throws")) {
          port.fault = port.fault === "throws" ? "throws" : "";
          port.writable = stream();
          throw new Error("device\nlost");
        }
        await new Promise((done) => setTimeout(done, port.delay));
        port.given.push([...bytes]);
      },
    });
  }
  return port;
}

async function begin(port = fakePort(), board: SerialBoard = SURFACE) {
  const reports: string[] = [];
  const encode = async (drive: Float32Array) => {
    if (drive[0] < 0) throw new Error("2 transducers: give 256");
    return Uint8Array.from(drive);
  };
  const connected = connect(port, board, encode, SILENCE, (state, notice) => reports.push(notice?.text ?? state));
  await vi.runAllTimersAsync();
  return { port, reports, connection: await connected };
}

const drive = (...bytes: number[]) => Float32Array.from(bytes);

test("silence goes first and last, and the newest drive between", async () => {
  const { port, connection, reports } = await begin();
  expect(port.opened).toBe(230400);
  port.delay = 30;
  connection.play(drive(1, 1));
  await vi.advanceTimersByTimeAsync(10);
  for (const k of [2, 3, 4]) connection.play(drive(k, k));
  await vi.advanceTimersByTimeAsync(200);
  expect(connection.state).toBe("playing");
  await vi.runAllTimersAsync();
  const closed = connection.close();
  await vi.runAllTimersAsync();
  await closed;
  expect(port.given).toEqual([[0, 0], [1, 1], [4, 4], [0, 0]]);
  expect(port.closed).toBe(1);
  expect(reports).toEqual(["playing", "off", "gone"]);
});

test("an Arduino is silenced once more when it has restarted", async () => {
  const port = fakePort();
  const connected = connect(port, { name: "mega64", baud: 115200, restarts: true }, async () => SILENCE, SILENCE, () => {});
  await vi.advanceTimersByTimeAsync(1900);
  expect(port.given).toHaveLength(1);
  await vi.advanceTimersByTimeAsync(200);
  expect(port.given).toEqual([[0, 0], [0, 0]]);
  expect((await connected).state).toBe("off");
});

test("off drops what waits, and nothing follows silence before the next request", async () => {
  const { port, connection } = await begin();
  port.delay = 30;
  connection.play(drive(1));
  await vi.advanceTimersByTimeAsync(5);
  connection.play(drive(2));
  const silent = connection.off();
  await vi.runAllTimersAsync();
  await silent;
  expect(port.given).toEqual([[0, 0], [1], [0, 0]]);
  connection.play(drive(3));
  await vi.runAllTimersAsync();
  expect(port.given.at(-1)).toEqual([3]);
});

test("frames come no faster than the line carries them", async () => {
  const { port, connection } = await begin();
  const frame = drive(...new Array<number>(230).fill(7));
  for (let ms = 0; ms < 1000; ms += 1) {
    connection.play(frame);
    await vi.advanceTimersByTimeAsync(1);
  }
  // A frame of 230 bytes of 10 bits takes 10 ms at 230400 Bd. Two more frames may be in the line, and one write was silence.
  expect(port.given.length).toBeGreaterThan(90);
  expect(port.given.length).toBeLessThanOrEqual(103);
});

test("a drive that the board cannot play turns it off, in one line", async () => {
  const { port, connection, reports } = await begin();
  connection.play(drive(1));
  await vi.runAllTimersAsync();
  connection.play(drive(-1));
  await vi.runAllTimersAsync();
  expect(connection.state).toBe("off");
  expect(port.given).toEqual([[0, 0], [1], [0, 0]]);
  expect(reports.at(-1)).toBe("sonicsurface cannot play this (2 transducers: give 256): it is off");
});

test.each(["throws", "hangs"] as const)("a port that %s: a failed silence is reported", async (fault) => {
  const { port, connection, reports } = await begin();
  connection.play(drive(1));
  await vi.runAllTimersAsync();
  port.fault = fault;
  const silent = connection.off();
  await vi.runAllTimersAsync();
  await silent;
  expect(connection.state).toBe("gone");
  const why = fault === "throws" ? "device lost" : "it takes nothing";
  const cure = "the board may still play, switch its supply off and connect again";
  expect(reports.at(-1)).toBe(`the port of sonicsurface is gone (${why}): ${cure}`);
  expect(port.closed).toBe(1);
  connection.play(drive(2));
  await connection.off();
  await vi.runAllTimersAsync();
  expect(port.given).toEqual([[0, 0], [1]]);
});

test("a frame that fails is followed by silence where the port still takes it", async () => {
  const { port, connection, reports } = await begin();
  port.fault = "throws once";
  connection.play(drive(1));
  await vi.runAllTimersAsync();
  expect(port.given).toEqual([[0, 0], [0, 0]]);
  expect(connection.state).toBe("gone");
  expect(reports.at(-1)).toContain("the board was turned off, connect again");
});

test("an unplugged board is reported once", async () => {
  const { port, connection, reports } = await begin();
  port.unplug();
  await vi.runAllTimersAsync();
  expect(connection.state).toBe("gone");
  expect(reports).toHaveLength(1);
  expect(reports[0]).toContain("gone (it was unplugged): the board may still play");
});

test("a port that cannot be opened is an error of one line", async () => {
  const port = { ...fakePort(), open: () => Promise.reject(new Error("Failed to\nopen")) };
  const opened = connect(port, SURFACE, async () => SILENCE, SILENCE, () => {});
  await expect(opened).rejects.toThrow("the port of sonicsurface cannot be opened (Failed to open): plug");
});

test("a first silence that fails is a connection that is gone", async () => {
  const port = fakePort();
  port.fault = "throws";
  const { connection, reports } = await begin(port);
  expect(connection.state).toBe("gone");
  expect(reports).toHaveLength(1);
});

/** Returns a document that is visible and has the focus. */
const seen = () => Object.assign(new EventTarget(), { hidden: false as boolean, hasFocus: (): boolean => true });

test("blur, a hidden or left page and Escape turn off, until that is ended", () => {
  const off = vi.fn(async () => {});
  const connection: Pick<Connection, "off" | "close"> = { off, close: off };
  const window = new EventTarget();
  const document = seen();
  const key = (name: string) => Object.assign(new Event("keydown"), { key: name });
  const end = guard(connection, window, document);
  const count = (event: Event, target: EventTarget) => {
    off.mockClear();
    target.dispatchEvent(event);
    return off.mock.calls.length;
  };
  expect(count(new Event("blur"), window)).toBe(1);
  expect(count(new Event("pagehide"), window)).toBe(1);
  expect(count(key("Escape"), window)).toBe(1);
  expect(count(key("a"), window)).toBe(0);
  expect(count(new Event("visibilitychange"), document)).toBe(0);
  document.hidden = true;
  expect(count(new Event("visibilitychange"), document)).toBe(1);
  end();
  for (const event of [new Event("blur"), new Event("pagehide"), key("Escape")]) {
    expect(count(event, window)).toBe(0);
  }
  expect(count(new Event("visibilitychange"), document)).toBe(0);
});

test.each(["hashchange", "popstate", "pagehide"])("%s lets go of the port: nothing is played before a new request", async (kind) => {
  const { port, connection, reports } = await begin();
  const window = new EventTarget();
  guard(connection, window, seen());
  connection.play(drive(1));
  await vi.runAllTimersAsync();
  window.dispatchEvent(new Event(kind));
  // Another page has opened another scene at this page's address; the drive of that scene follows at once.
  expect(connection.state).not.toBe("playing");
  connection.play(drive(9));
  await vi.runAllTimersAsync();
  expect(port.given).toEqual([[0, 0], [1], [0, 0]]);
  expect(port.closed).toBe(1);
  expect(reports.at(-1)).toBe("gone");
});

const LEAVING: [string, (window: EventTarget, document: ReturnType<typeof seen>) => void, boolean][] = [
  ["nothing happens", () => {}, true],
  ["the window loses the focus", (window) => window.dispatchEvent(new Event("blur")), false],
  ["the window lost it before", (_, document) => void (document.hasFocus = () => false), false],
  ["the page is hidden", (_, document) => void (document.hidden = true), false],
  [
    "the page is hidden and shown again",
    (_, document) => {
      document.hidden = true;
      document.dispatchEvent(new Event("visibilitychange"));
      document.hidden = false;
    },
    false,
  ],
  ["Escape is pressed", (window) => window.dispatchEvent(Object.assign(new Event("keydown"), { key: "Escape" })), false],
  ["the page is led elsewhere", (window) => window.dispatchEvent(new Event("hashchange")), false],
];

test.each(LEAVING)("while an Arduino restarts %s", async (_, happens, stays) => {
  const port = fakePort();
  const window = new EventTarget();
  const document = seen();
  const mega = { name: "mega64", baud: 115200, restarts: true };
  const begun = attended(connect(port, mega, async () => SILENCE, SILENCE, () => {}), window, document);
  await vi.advanceTimersByTimeAsync(1000);
  happens(window, document);
  await vi.runAllTimersAsync();
  const { connection, present } = await begun;
  await vi.runAllTimersAsync();
  expect(present).toBe(stays);
  expect(connection.state).toBe(_ === "the page is led elsewhere" ? "gone" : "off");
  expect(port.given.flat().every((byte) => byte === 0)).toBe(true);
});
