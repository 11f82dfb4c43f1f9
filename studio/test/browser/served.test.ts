// A board of `midair studio --on`: Python's own server and page, the drive that the board plays, and rejected clients.
import { type ChildProcess, spawn } from "node:child_process";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

import { afterAll, beforeAll, expect, test } from "vitest";

import { shared } from "./setup.ts";
import { point, serve, visit } from "./site.ts";

const open = shared();
const root = join(import.meta.dirname, "../../..");

/** A program that serves a simulated board; it prints the state and the loudest transducer whenever they change. */
const PROGRAM = `
import contextlib, threading, time
import numpy as np, midair
from midair._studio.view import greeting, scene_text
from midair._studio.server import HOLD, PagesBoard, Server
with contextlib.suppress(KeyboardInterrupt), midair.connect("sonicsurface:null", hold=HOLD) as surface:
    scene = scene_text(greeting(surface.board.array))
    server = Server(scene, board=PagesBoard(surface, scene))
    print(server.address, flush=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    last = None
    while True:
        now = f"{surface.state} {hash(surface.emitting.tobytes())}"
        if now != last:
            print(now, flush=True)
            last = now
        time.sleep(0.02)
`;

let program: ChildProcess;
let address = "";
const states: string[] = [];

beforeAll(async () => {
  program = spawn(join(root, ".venv/bin/python"), ["-c", PROGRAM], { stdio: ["ignore", "pipe", "inherit"] });
  const lines = createInterface({ input: program.stdout! });
  await new Promise<void>((done) => {
    lines.on("line", (line) => {
      if (address) states.push(line);
      else address = line;
      done();
    });
  });
});
afterAll(() => void program.kill("SIGINT"));

const state = () => states.at(-1)?.split(" ")[0];

test("the page plays the board through Python, and it is off by Escape, blur, silence, another array and when the page is left", async () => {
  const { page, context, complaints } = await visit(open.browser, address);
  const button = page.locator("button.board");
  expect(await button.innerText()).toBe("Play on sonicsurface");
  await expect.poll(state).toBe("off");
  await button.click();
  await expect.poll(state).toBe("playing");
  await expect.poll(() => button.innerText()).toBe("Playing: turn off");
  // The board continues to play while the drive is sent again and again.
  await page.waitForTimeout(2500);
  expect(state()).toBe("playing");
  const before = states.at(-1);
  await point(page, 1).focus();
  await page.keyboard.press("Shift+ArrowRight");
  await expect.poll(() => states.at(-1)).not.toBe(before);
  expect(state()).toBe("playing");
  for (const act of [
    () => page.keyboard.press("Escape"),
    () => page.evaluate(() => window.dispatchEvent(new Event("blur"))),
    () => button.click(),
  ]) {
    await act();
    await expect.poll(state).toBe("off");
    await button.click();
    await expect.poll(state).toBe("playing");
  }
  await page.evaluate(() => window.midair!.set({ array: { preset: "autd3", tiles: [1, 1] } }));
  await expect.poll(state).toBe("off");
  expect(await page.getByRole("alert").innerText()).toContain("sonicsurface is off");
  await page.evaluate(() => window.midair!.set({ array: { preset: "sonicsurface", tiles: [1, 1] } }));
  await page.evaluate(() => window.midair!.settled());
  await button.click();
  await expect.poll(state).toBe("playing");
  await page.goto("about:blank");
  await expect.poll(state, { timeout: 900 }).toBe("off");
  expect(complaints).toEqual([]);
  await context.close();
});

test("a page that dies leaves silence within the second and a half", async () => {
  const { page, context } = await visit(open.browser, address);
  await page.locator("button.board").click();
  await expect.poll(state).toBe("playing");
  await context.setOffline(true);
  await expect.poll(state, { timeout: 1500 }).toBe("off");
  await context.close();
});

test("a page of another origin cannot play it", async () => {
  // This page has no policy of its own that would forbid the request.
  const folder = await mkdtemp(join(tmpdir(), "foreign-"));
  await writeFile(join(folder, "index.html"), "<!doctype html><title>foreign</title>");
  const foreign = await serve(folder, false);
  const context = await open.browser.newContext();
  const page = await context.newPage();
  await page.goto(foreign.url);
  const answers = await page.evaluate(async (address) => {
    const body = new Float32Array(512).fill(0.5);
    const at = `${new URL("board", address)}?${Date.now() + 1e6}`;
    const ask = async (init: RequestInit) => fetch(at, { method: "POST", body, ...init }).then(({ type, status }) => `${type} ${status}`, () => "refused");
    return [await ask({ headers: { "Content-Type": "application/octet-stream" } }), await ask({ mode: "no-cors" }), await ask({})];
  }, address);
  expect(answers).toEqual(["refused", "refused", "refused"]);
  await page.waitForTimeout(300);
  expect(state()).toBe("off");
  await context.close();
  foreign.close();
});
