// The page as a person uses it: dragging, keys, undo, typed values, motion.
import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import type { Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { EIGHT, grab, point as pointOf, unfold, visit } from "./site.ts";

const open = shared();
let page: Page;

beforeEach(async () => {
  await page?.context().close();
  ({ page } = await visit(open.browser, open.url + EIGHT));
});

const points = () => page.evaluate(() => window.midair!.state().points as Vec3[]);
const point = (n: number) => pointOf(page, n);
const settled = () => page.evaluate(() => window.midair!.settled());

test("a drag leaves the point under the pointer, at its height; undo goes back", async () => {
  const before = await points();
  const [x, y] = await grab(page, 2);
  await page.mouse.move(x + 20, y + 5);
  await page.mouse.move(x + 40, y + 10);
  await page.mouse.up();
  await settled();
  const after = await points();
  const [left, top] = await page.evaluate((place) => window.midair!.project(place), after[1]);
  expect(Math.hypot(left - x - 40, top - y - 10)).toBeLessThan(2);
  expect(after[1][2]).toBe(before[1][2]);
  expect(after[1]).not.toEqual(before[1]);
  await page.keyboard.press("Control+z");
  expect(await points()).toEqual(before);
  await page.keyboard.press("Control+Shift+Z");
  expect(await points()).toEqual(after);
});

test("Shift lifts a point, and the slice with it", async () => {
  const before = (await points())[2];
  await page.keyboard.down("Shift");
  const [x, y] = await grab(page, 3);
  await page.mouse.move(x, y - 30, { steps: 3 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  const after = (await points())[2];
  expect(after.slice(0, 2)).toEqual(before.slice(0, 2));
  expect(after[2]).toBeGreaterThan(before[2] + 0.005);
  expect(await page.evaluate(() => (window.midair!.state().plane as { z: number }).z)).toBe(after[2]);
});

test("keys move by 1 and 10 mm, and take points away", async () => {
  const before = (await points())[0];
  await point(1).focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowUp");
  await page.keyboard.press("PageUp");
  const after = (await points())[0];
  const way = after.map((x, axis) => Math.round((x - before[axis]) * 1e7) / 1e7);
  expect(way).toEqual([0.001, 0.01, 0.001]);
  const count = (await points()).length;
  await page.keyboard.press("Delete");
  expect(await points()).toHaveLength(count - 1);
});

test("a double click makes a point, in space and on a slice", async () => {
  const count = (await points()).length;
  const slice = page.getByRole("img", { name: /^Slice/ });
  await slice.dblclick({ position: { x: 20, y: 30 } });
  expect(await points()).toHaveLength(count + 1);
  const [x, y] = await page.evaluate(() => {
    const { center, z } = window.midair!.state().plane as { center: number[]; z: number };
    return window.midair!.project([center[0] + 0.065, center[1] - 0.02, z]);
  });
  await page.mouse.dblclick(x, y);
  expect(await points()).toHaveLength(count + 2);
});

test("what is shown is the field, also after a drag", async () => {
  const compared = async () => {
    const places = (await points()).slice(0, 4);
    const [field, shown] = await page.evaluate(
      async (places) => [await window.midair!.field(0, places), window.midair!.shown(0, places)],
      places,
    );
    const largest = Math.max(...field.map(([re, im]) => Math.hypot(re, im)));
    return Math.max(...field.map(([re, im], k) => Math.hypot(shown[k]![0] - re, shown[k]![1] - im) / largest));
  };
  expect(await compared()).toBeLessThan(0.005);
  const [x, y] = await grab(page, 1);
  await page.mouse.move(x + 12, y + 2);
  await page.mouse.up();
  expect(await compared()).toBeLessThan(0.005);
});

test("a number is shown as it was taken", async () => {
  await unfold(page, "Control points");
  const typed = async (name: string, text: string) => {
    const input = page.getByRole("spinbutton", { name });
    await input.fill(text);
    await input.press("Enter");
    return input.inputValue();
  };
  expect(await typed("x of point 1 in mm", "12.3456")).toBe("12.35");
  expect(await typed("x of point 1 in mm", "99999")).toBe("10000");
  expect(await typed("x of point 1 in mm", "")).toBe("10000");
  expect(await typed("Pressure of point 1 in Pa", "-5")).toBe("");
  expect(await page.getByRole("alert").innerText()).toContain("-5 Pa at point 1");
});

test("pressures that the page fills in look filled, and one that is cleared clears no other", async () => {
  await unfold(page, "Control points");
  const cell = (n: number) => page.getByRole("spinbutton", { name: `Pressure of point ${n} in Pa` });
  const filled = () => page.locator(".points input.filled").count();
  const type = async (n: number, text: string) => {
    await cell(n).fill(text);
    await cell(n).press("Enter");
  };
  const count = (await points()).length;
  await type(1, "3000");
  expect(await filled()).toBe(count - 1);
  await type(2, "2000");
  expect(await filled()).toBe(count - 2);
  await type(2, "");
  expect(await cell(1).inputValue()).toBe("3000");
  expect(await filled()).toBe(count - 1);
  await type(1, "");
  expect(await page.evaluate(() => window.midair!.state().pressures)).toBeNull();
});

test("solve times are those of the methods shown, warm", async () => {
  const times = () => page.evaluate(() => (window.midair!.state().metrics as { milliseconds: number }[]).map((each) => each.milliseconds));
  await page.evaluate(() => window.midair!.set({ methods: ["lm", "naive"] }));
  await settled();
  const [slow, fast] = await times();
  expect(slow).toBeGreaterThan(2 * fast);
  await page.evaluate(() => window.midair!.set({ methods: ["naive", "naive"] }));
  await settled();
  expect((await times())[0]).toBeLessThan(slow / 2);
  await page.evaluate(() => window.midair!.set({ methods: ["lm", "naive"] }));
  await expect.poll(async () => Number.isNaN((await times())[0]), { timeout: 20_000, interval: 20 }).toBe(true);
});

/** A time limit that a busy machine can meet. */
const PATIENT = { timeout: 20_000 };

test("eight letters are typed, drawn by Enter, and fit the slice", async () => {
  await unfold(page, "Shapes");
  await page.getByRole("button", { name: "Letters" }).click();
  const field = page.getByRole("textbox", { name: "Letters" });
  expect((await field.boundingBox())!.width).toBeGreaterThan(60);
  await field.fill("ABCDEFGH");
  await field.press("Enter");
  await expect.poll(async () => (await points()).length, PATIENT).toBeGreaterThan(30);
  for (const [x, y] of await points()) expect(Math.max(Math.abs(x), Math.abs(y))).toBeLessThan(0.09);
});

test("a character without strokes of ours is traced from a font; one that no font has is refused", async () => {
  await unfold(page, "Shapes");
  await page.getByRole("button", { name: "Letters" }).click();
  const field = page.getByRole("textbox", { name: "Letters" });
  await field.fill("Ω");
  await field.press("Enter");
  // The shape has an arc that is open at the bottom, and two feet.
  await expect.poll(async () => (await points()).some(([x, y]) => Math.abs(x) < 0.004 && y > 0.015), PATIENT).toBe(true);
  const all = await points();
  const [x, y] = [0, 1].map((axis) => all.map((at) => at[axis]));
  expect(Math.max(...y) - Math.min(...y)).toBeGreaterThan(0.033);
  expect(Math.max(...x) + Math.min(...x)).toBeCloseTo(0, 2);
  expect(all.filter(([x, y]) => Math.abs(x) < 0.003 && y < 0.01)).toEqual([]);
  await field.fill("\u{10fffd}");
  await field.press("Enter");
  await expect.poll(() => page.getByRole("alert").innerText(), PATIENT).toContain("which no font here draws: give another");
});

test("a path is played with its changes and weakest points as curves; a path that stands still is reported", async () => {
  await page.evaluate(() =>
    window.midair!.set({ view: "slice", path: { kind: "circle", radius: 0.004, frequency: 40 } }),
  );
  await unfold(page, "Motion");
  await page.getByRole("button", { name: "Move", exact: true }).click();
  const chart = page.getByRole("img", { name: /^Motion: largest phase change/ });
  await chart.waitFor({ timeout: 60_000 });
  expect(await chart.innerText()).toMatch(/Largest phase change.*rad.*Weakest \|p\|.*Pa.*25 ms/s);
  await page.evaluate(() => window.midair!.set({ array: { preset: "ultraino_flat8x8", tiles: [1, 1] } }));
  await settled();
  expect(await chart.isVisible()).toBe(false);
  await page.getByRole("button", { name: "Move", exact: true }).click();
  await page.getByRole("img", { name: /^Motion: No phase moves/ }).waitFor({ timeout: 60_000 });
});

test("both methods, temperature and quantization change the answer", async () => {
  const metrics = () => page.evaluate(() => window.midair!.state().metrics as { uniformity: number }[]);
  const before = await metrics();
  await page.getByLabel("Method A").getByRole("combobox").selectOption("naive");
  await settled();
  const after = await metrics();
  expect(after[0].uniformity).toBeLessThan(before[0].uniformity);
  expect(after[0].uniformity).toBe(after[1].uniformity);
});
