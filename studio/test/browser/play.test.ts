// A board at a simulated serial port: silence first, frames while it plays, silence when the page is left.
import type { BrowserContext, Page } from "playwright-core";
import { expect, test } from "vitest";

import { shared } from "./setup.ts";
import { built, point, ready, serve, visit } from "./site.ts";

const open = shared();

/**
 * Replaces the browser's serial port. The bytes sent to it stay stored when the page is left. With `led`, another page opens
 * this address while the user chooses a port.
 */
async function withPort(page: Page, led = "") {
  await page.evaluate((led) => {
    localStorage.given = "[]";
    const keep = (bytes: number[]) => void (localStorage.given = JSON.stringify([...JSON.parse(localStorage.given), bytes]));
    const port = {
      open: async ({ baudRate }: { baudRate: number }) => keep([baudRate]),
      close: async () => undefined,
      addEventListener: () => undefined,
      writable: new WritableStream<Uint8Array>({ write: (bytes) => keep([...bytes]) }),
    };
    const requestPort = async () => {
      if (led) location.hash = led;
      // The event of the new address comes while the user chooses a port.
      await new Promise((done) => setTimeout(done, 300));
      return port;
    };
    Object.defineProperty(navigator, "serial", { value: { requestPort }, configurable: true });
  }, led);
}

const given = (page: Page) => page.evaluate(() => JSON.parse(localStorage.given) as number[][]);
const HERE = "#v=1&a=sonicsurface&p=0,0,150";
const ELSEWHERE = "#v=1&a=sonicsurface&p=60,60,80";

/** Connects a board and plays; returns its bytes of silence. */
async function connected(page: Page): Promise<number[]> {
  await withPort(page);
  await page.getByRole("button", { name: /connect/i }).click();
  await expect.poll(async () => (await given(page)).length, { timeout: 20_000 }).toBeGreaterThanOrEqual(3);
  const [, silence, frame] = await given(page);
  expect(frame).not.toEqual(silence);
  return silence;
}

test("a SonicSurface plays, and is off by Escape and blur", async () => {
  const { page, context } = await visit(open.browser, open.url + HERE);
  const silence = await connected(page);
  const [[baud], , frame] = await given(page);
  expect(baud).toBe(230400);
  expect(frame.length).toBeGreaterThan(256);
  const off = page.getByRole("button", { name: /^play(ing| again)/i });
  for (const act of [
    () => page.keyboard.press("Escape"),
    () => page.evaluate(() => window.dispatchEvent(new Event("blur"))),
    () =>
      page.evaluate(() => {
        Object.defineProperty(document, "hidden", { value: true, configurable: true });
        document.dispatchEvent(new Event("visibilitychange"));
      }),
  ]) {
    await act();
    await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).toEqual(silence);
    await off.click();
    await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).toEqual(frame);
  }
  await point(page, 1).focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).not.toEqual(frame);
  await off.click();
  await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).toEqual(silence);
  await context.close();
});

test("an array that no serial board plays is answered by the boards that do, each with its array, and by the command for others", async () => {
  const { page, context } = await visit(open.browser, open.url);
  await withPort(page);
  await page.getByRole("button", { name: /connect/i }).click();
  const dialog = page.getByRole("dialog");
  expect(await dialog.innerText()).toMatch(/sonicsurface[^]*ultraino_flat8x8[^]*midair studio --on autd3/);
  await dialog.getByRole("button", { name: /^sonicsurface/ }).click();
  await expect.poll(async () => (await given(page)).length, { timeout: 20_000 }).toBeGreaterThanOrEqual(3);
  expect(await page.evaluate(() => window.midair!.state().array)).toEqual({ preset: "sonicsurface", tiles: [1, 1] });
  await context.close();
});

/** Ways to lead a page that plays to another address. */
const LEADING: [string, (context: BrowserContext) => Promise<[Page, () => Promise<unknown>]>][] = [
  [
    "by itself",
    async (context) => {
      const page = await context.newPage();
      await page.goto(open.url + HERE);
      return [page, () => page.evaluate((to) => void (location.hash = to), ELSEWHERE)];
    },
  ],
  [
    "by the foreign page that opened it",
    async (context) => {
      const foreign = await serve(`${built}/site`);
      const opener = await context.newPage();
      await opener.goto(foreign.url);
      const [page] = await Promise.all([
        context.waitForEvent("page"),
        opener.evaluate((url) => void Object.assign(window, { opened: window.open(url) }), open.url + HERE),
      ]);
      const lead = (url: string) => void ((window as unknown as { opened: Window }).opened.location.href = url);
      return [page, () => opener.evaluate(lead, open.url + ELSEWHERE).finally(() => foreign.close())];
    },
  ],
];

test.each(LEADING)("a page that is led to another address %s lets go of its board, and asks anew", async (_, opening) => {
  const context = await open.browser.newContext();
  const [page, lead] = await opening(context);
  await ready(page);
  const silence = await connected(page);
  await lead();
  await page.getByRole("button", { name: /connect/i }).waitFor();
  await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).toEqual(silence);
  const count = (await given(page)).length;
  await point(page, 1).focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(500);
  expect(await given(page)).toHaveLength(count);
  await context.close();
});

test("a page that is left turns its board off", async () => {
  const { page, context } = await visit(open.browser, open.url + HERE);
  const silence = await connected(page);
  await page.goto(`${open.url}?elsewhere`);
  expect((await given(page)).at(-1)).toEqual(silence);
  await context.close();
});

test("a page that is led to another address while a port is chosen does not open it", async () => {
  const { page, context } = await visit(open.browser, open.url + HERE);
  await withPort(page, ELSEWHERE);
  await page.getByRole("button", { name: /connect/i }).click();
  await page.waitForTimeout(2000);
  expect(await given(page)).toEqual([]);
  await page.getByRole("button", { name: /connect/i }).waitFor();
  await context.close();
});
