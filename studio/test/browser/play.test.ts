// A board through a port that the browser is given: silence first, frames while it plays, silence by Escape and blur.
import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { shared } from "./setup.ts";
import { point, visit } from "./site.ts";

const open = shared();

/** A port that keeps what it is given, in place of the browser's own. */
async function withPort(page: Page) {
  await page.evaluate(() => {
    const given: number[][] = [];
    const port = {
      open: async ({ baudRate }: { baudRate: number }) => void given.push([baudRate]),
      close: async () => undefined,
      addEventListener: () => undefined,
      writable: new WritableStream<Uint8Array>({ write: (bytes) => void given.push([...bytes]) }),
    };
    Object.assign(window, { given });
    Object.defineProperty(navigator, "serial", { value: { requestPort: async () => port }, configurable: true });
  });
}

const given = (page: Page) => page.evaluate(() => (window as unknown as { given: number[][] }).given);

test("a SonicSurface plays, and is off by Escape and blur", async () => {
  const { page, context } = await visit(open.browser, `${open.url}#v=1&a=sonicsurface&p=0,0,150`);
  await withPort(page);
  await page.getByRole("button", { name: /connect/i }).click();
  await expect.poll(async () => (await given(page)).length, { timeout: 20_000 }).toBeGreaterThanOrEqual(3);
  const [[baud], silence, frame] = await given(page);
  expect(baud).toBe(230400);
  expect(frame).not.toEqual(silence);
  expect(frame.length).toBeGreaterThan(256);
  const off = page.getByRole("button", { name: /play/i });
  for (const act of [
    () => page.keyboard.press("Escape"),
    () => page.evaluate(() => window.dispatchEvent(new Event("blur"))),
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

test("an array that no serial board plays is told so", async () => {
  const { page, context } = await visit(open.browser, open.url);
  await withPort(page);
  await page.getByRole("button", { name: /connect/i }).click();
  expect(await page.getByRole("alert").innerText()).toContain("sonicsurface");
  await context.close();
});

test("a page that is led to another address lets go of its board, and asks anew", async () => {
  const { page, context } = await visit(open.browser, `${open.url}#v=1&a=sonicsurface&p=0,0,150`);
  await withPort(page);
  await page.getByRole("button", { name: /connect/i }).click();
  await expect.poll(async () => (await given(page)).length, { timeout: 20_000 }).toBeGreaterThanOrEqual(3);
  const [, silence] = await given(page);
  await page.evaluate(() => void (location.hash = "#v=1&a=sonicsurface&p=60,60,80"));
  await page.getByRole("button", { name: /connect/i }).waitFor();
  await expect.poll(async () => (await given(page)).at(-1), { timeout: 10_000 }).toEqual(silence);
  const count = (await given(page)).length;
  await point(page, 1).focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(500);
  expect(await given(page)).toHaveLength(count);
  await context.close();
});
