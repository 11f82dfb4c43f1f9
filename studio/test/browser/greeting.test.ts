// The first view: three foci, their wave on an upright slice, one sentence, and an animated hand that drags a focus once.
import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { first } from "../../src/state/initial.ts";
import type { State } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { visit } from "./site.ts";

const open = shared();
const MOVES = { reducedMotion: "no-preference" } as const;

const state = (page: Page) => page.evaluate(() => window.midair!.state()) as unknown as Promise<State>;
const hand = (page: Page) => page.locator(".ghost").count();

test("three foci, their wave on an upright slice, and one sentence about one large number", async () => {
  const { page, context } = await visit(open.browser, open.url);
  const { array, plane, points, quantity, level } = await state(page);
  expect([array, plane.axis, points.length, quantity, level]).toEqual([{ preset: "autd3", tiles: [1, 1] }, "y", 3, "wave", "play"]);
  await expect.poll(() => page.locator(".sentence p").innerText()).toMatch(/^3 foci of \d\.\d\d kPa \(1\d\d dB\),\nevenness 100 %, solved in [\d.]+ (µs|ms)$/);
  expect(await page.locator(".sentence small").innerText()).toBe("40 kHz sound from 249 small speakers meets at the marked points: drag one.");
  const sizes = await page.locator(".sentence b, .sentence strong").evaluateAll((all) => all.map((each) => parseFloat(getComputedStyle(each).fontSize)));
  expect(sizes.filter((size) => size > 40)).toHaveLength(1);
  await page.waitForTimeout(3500);
  expect([await hand(page), (await state(page)).points]).toEqual([0, first.points]);
  await context.close();
});

test("a hand drags the first focus once, and leaves all as it was", async () => {
  const { page, context } = await visit(open.browser, open.url, MOVES);
  expect(await hand(page)).toBe(0);
  await expect.poll(async () => (await state(page)).points, { timeout: 10_000 }).not.toEqual(first.points);
  expect(await hand(page)).toBe(1);
  expect((await state(page)).points.slice(1)).toEqual(first.points.slice(1));
  await expect.poll(() => hand(page), { timeout: 10_000 }).toBe(0);
  expect((await state(page)).points).toEqual(first.points);
  expect(await page.getByRole("button", { name: "Undo" }).isDisabled()).toBe(true);
  await page.waitForTimeout(4000);
  expect([await hand(page), (await state(page)).points]).toEqual([0, first.points]);
  await context.close();
});

test("the hand stops at the first input, and does not come to what is opened by a link", async () => {
  const { page, context } = await visit(open.browser, open.url, MOVES);
  await expect.poll(async () => (await state(page)).points, { timeout: 10_000 }).not.toEqual(first.points);
  await page.keyboard.press("Tab");
  expect([await hand(page), (await state(page)).points]).toEqual([0, first.points]);
  await context.close();
  const linked = await visit(open.browser, `${open.url}#v=1&p=0,0,150`, MOVES);
  await linked.page.waitForTimeout(4000);
  expect([await hand(linked.page), (await state(linked.page)).points]).toEqual([0, [[0, 0, 0.15]]]);
  await linked.context.close();
});
