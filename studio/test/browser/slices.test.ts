// Upright slices in the page: handles, the choice of the slice, points that move it, axes, and the values at the pointer.
import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import type { State, Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { grab, point, visit } from "./site.ts";

const open = shared();
const BOARD = { array: { preset: "sonicsurface", tiles: [1, 1] as [number, number] }, points: [[-0.03, 0.01, 0.15], [0.03, 0.01, 0.15]] as Vec3[], view: "slice" as const, level: "engineer" as const };
const UPRIGHT = { ...BOARD, plane: { axis: "y" as const, z: 0.15, size: 0.12, center: [0, 0.01] as [number, number] } };
let page: Page;
let complaints: string[];

beforeEach(async () => {
  await page?.context().close();
  ({ page, complaints } = await visit(open.browser, `${open.url}#v=1`));
  await set(UPRIGHT);
});

async function set(state: object) {
  await page.evaluate((state) => window.midair!.set(state), state);
  await settled();
}
const settled = () => page.evaluate(() => window.midair!.settled());
const state = () => page.evaluate(() => window.midair!.state() as unknown as State);
const handle = (axis: string) => page.getByRole("slider", { name: `Slice normal to ${axis}` });

test("an upright slice shows the field that is computed, and its link brings it back", async () => {
  const places = [0, 1, 2].map((k): Vec3 => [-0.03 + 0.02 * k, 0.01, 0.13 + 0.015 * k]);
  const [field, shown] = await page.evaluate(async (places) => [await window.midair!.field(0, places), window.midair!.shown(0, places)], places);
  const largest = Math.max(...field.map(([re, im]) => Math.hypot(re, im)));
  field.forEach(([re, im], k) => expect(Math.hypot(shown[k]![0] - re, shown[k]![1] - im)).toBeLessThan(0.005 * largest));
  expect(await page.evaluate(() => window.midair!.shown(0, [[0, 0.02, 0.15]]))).toEqual([null]);
  const link = await page.evaluate(() => window.midair!.permalink());
  expect(link).toContain("&n=y");
  await set({ plane: { axis: "z" } });
  await page.evaluate((link) => void (location.hash = new URL(link).hash), link);
  await expect.poll(async () => (await state()).plane).toEqual(UPRIGHT.plane);
});

test("the slice is chosen by its axes, three can be shown, and undo goes back", async () => {
  const choice = page.getByRole("group", { name: "The slice is normal to" });
  await choice.getByRole("button", { name: "y–z" }).click();
  expect((await state()).plane.axis).toBe("x");
  await choice.getByRole("button", { name: "Three slices" }).click();
  await settled();
  expect((await state()).view).toBe("planes");
  for (const axis of ["x", "y", "z"]) await handle(axis).waitFor();
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  expect((await state()).plane.axis).toBe("y");
  await handle("z").waitFor({ state: "hidden" });
});

test("a handle pushes its slice along its normal, by the pointer and by keys", async () => {
  await set({ view: "planes" });
  const before = (await state()).plane;
  // The slices of the last state may still be shown.
  await handle("x").waitFor();
  const box = (await handle("z").boundingBox())!;
  await page.mouse.move(box.x + 12, box.y + 12);
  await page.mouse.down();
  await page.mouse.move(box.x + 12, box.y - 18, { steps: 3 });
  await page.mouse.up();
  const pushed = (await state()).plane;
  expect(pushed.z).toBeGreaterThan(before.z + 0.003);
  expect(pushed).toEqual({ ...before, z: pushed.z });
  await expect.poll(async () => Math.abs((await handle("z").boundingBox())!.y - box.y + 30)).toBeLessThan(2);
  await handle("x").focus();
  await page.keyboard.press("Shift+ArrowUp");
  expect((await state()).plane.center[0]).toBeCloseTo(0.01, 9);
  await expect.poll(() => handle("x").getAttribute("aria-valuetext")).toBe("x 10 mm");
});

test("points are dragged along an upright slice; one that leaves it takes it along", async () => {
  const [x, y] = await grab(page, 1);
  await page.mouse.move(x + 15, y - 25, { steps: 3 });
  await page.mouse.up();
  await settled();
  const [[px, py, pz]] = (await state()).points;
  expect(py).toBe(0.01);
  expect(px).toBeGreaterThan(-0.03);
  expect(pz).toBeGreaterThan(0.155);
  const [left, top] = await page.evaluate((place) => window.midair!.project(place), [px, py, pz] as Vec3);
  expect(Math.hypot(left - x - 15, top - y + 25)).toBeLessThan(2);
  await point(page, 1).focus();
  await page.keyboard.press("ArrowUp");
  const after = await state();
  expect(after.points[0][1]).toBeCloseTo(0.011, 9);
  expect(after.plane.center[1]).toBeCloseTo(0.011, 9);
});

test("the values under the pointer are those of the core, on the slice and in space, and by keys", async () => {
  const picture = page.getByRole("img", { name: /^Slice/ }).first();
  const readout = page.locator(".instrument .readout").first();
  const box = (await picture.boundingBox())!;
  const [right, up] = [0.3, 0.6];
  await page.mouse.move(box.x + right * box.width, box.y + (1 - up) * box.height);
  await expect.poll(() => readout.innerText()).toContain("dB SPL");
  const text = await readout.innerText();
  const [x, y, z] = text.match(/x (\S+)  y (\S+)  z (\S+) mm/)!.slice(1).map(Number);
  expect(Math.abs(x / 1000 - (right - 0.5) * 0.12)).toBeLessThan(0.0006);
  expect(y).toBe(10);
  expect(Math.abs(z / 1000 - 0.15 - (up - 0.5) * 0.12)).toBeLessThan(0.0006);
  const [[re, im]] = await page.evaluate((place) => window.midair!.field(0, [place]), [x / 1000, y / 1000, z / 1000] as Vec3);
  const peak = Math.hypot(re, im);
  const [, shown, unit] = text.match(/\|p\| ([\d.]+) (k?Pa)/)!;
  expect(Number(shown) * (unit === "kPa" ? 1000 : 1)).toBeCloseTo(peak, -1);
  expect(Number(text.match(/([\d.]+) dB SPL/)![1])).toBeCloseTo(20 * Math.log10(peak / Math.SQRT2 / 20e-6), 1);
  expect(Number(text.match(/phase (\S+) rad/i)![1])).toBeCloseTo(Math.atan2(im, re), 1);
  // |p|^2/(rho c^2) in air at 25 degrees C.
  expect(Number(text.match(/pressure ([\d.]+) Pa/)![1]) / (peak ** 2 / (1.184 * 346.1 ** 2))).toBeCloseTo(1, 1);
  await page.mouse.move(box.x - 40, box.y - 20);
  await expect.poll(() => readout.isVisible()).toBe(false);
  await page.keyboard.press("Tab");
  await picture.focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(() => readout.isVisible()).toBe(true);
  await expect.poll(() => page.getByRole("status").first().innerText()).toContain("dB SPL");
  const [sx, sy] = await page.evaluate(() => window.midair!.project([0, 0.01, 0.17]));
  await page.mouse.move(sx, sy);
  await expect.poll(() => page.locator(".stage > .readout").innerText()).toMatch(/x -?0.\d+|x 0/);
  expect(complaints).toEqual([]);
});

test("axes in mm and a bar of one wavelength lie over the slice", async () => {
  const picture = page.getByRole("img", { name: /^Slice/ }).first();
  const box = (await picture.boundingBox())!;
  const bar = (await picture.locator(".wavelength").boundingBox())!;
  expect(bar.width / box.width).toBeCloseTo(346.13 / 40e3 / 0.12, 2);
  expect(await picture.locator(".wavelength").innerText()).toBe("λ 8.7");
  const marks = await picture.locator(".marks.up span").allInnerTexts();
  expect(marks.filter(Boolean)).toEqual(["100", "150", "200"]);
  expect(await picture.locator(".marks b").allInnerTexts()).toEqual(["x mm", "z mm"]);
});

test("some points are selected by a box or by Shift, moved together, and taken away", async () => {
  await set({ ...BOARD, points: [[-0.03, 0, 0.15], [0, 0.03, 0.15], [0.03, 0, 0.15]], plane: { axis: "z", z: 0.15, size: 0.12, center: [0, 0] } });
  for (const n of [1, 3]) await point(page, n).click({ modifiers: ["Shift"] });
  expect(await page.locator(".point.selected").count()).toBe(2);
  const before = (await state()).points;
  const [x, y] = await grab(page, 1);
  await page.mouse.move(x + 20, y - 10, { steps: 3 });
  await page.mouse.up();
  const after = (await state()).points;
  expect(after[1]).toEqual(before[1]);
  expect(after[0]).not.toEqual(before[0]);
  [0, 1, 2].forEach((axis) => expect(after[2][axis] - before[2][axis]).toBeCloseTo(after[0][axis] - before[0][axis], 5));
  await page.keyboard.press("Escape");
  expect(await page.locator(".point.selected").count()).toBe(0);
  const view = (await page.locator(".view3d").boundingBox())!;
  await page.keyboard.down("Shift");
  await page.mouse.move(view.x + 40, view.y + 80);
  await page.mouse.down();
  await page.mouse.move(view.x + view.width - 20, view.y + view.height - 80, { steps: 3 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  expect(await page.locator(".point.selected").count()).toBe(3);
  await page.keyboard.press("Escape");
});

test("the view is shifted by the right button, and looks from above, from the side and as at first", async () => {
  const seen = () => page.evaluate(() => [[0, 0, 0], [0, 0, 0.1], [0, 0.05, 0]].map((place) => window.midair!.project(place as Vec3)));
  const before = await seen();
  const view = (await page.locator(".view3d").boundingBox())!;
  await page.mouse.move(view.x + 60, view.y + 200);
  await page.mouse.down({ button: "right" });
  await page.mouse.move(view.x + 90, view.y + 180, { steps: 3 });
  await page.mouse.up({ button: "right" });
  const shifted = await seen();
  expect(shifted[0][0] - before[0][0]).toBeGreaterThan(15);
  expect(shifted[0][1] - before[0][1]).toBeLessThan(-10);
  await page.getByRole("button", { name: "From above" }).click();
  const above = await seen();
  expect(Math.abs(above[2][0] - above[0][0])).toBeLessThan(1);
  expect(above[2][1]).toBeLessThan(above[0][1] - 20);
  await page.getByRole("button", { name: "From the side" }).click();
  const side = await seen();
  expect(side[1][1]).toBeLessThan(side[0][1] - 40);
  expect(Math.abs(side[1][0] - side[0][0])).toBeLessThan(1);
  await page.getByRole("button", { name: "As at first" }).click();
  await expect.poll(async () => Math.hypot(...(await seen())[0].map((x, k) => x - before[0][k]))).toBeLessThan(2);
});

test("a point is lifted by touch, by the sign above it", async () => {
  await page.context().close();
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  ({ page } = await visit(open.browser, `${open.url}#v=1`, phone));
  await set({ ...BOARD, plane: { axis: "z", z: 0.15, size: 0.12, center: [0, 0] } });
  await point(page, 1).tap();
  const sign = page.locator(".lifter");
  const box = (await sign.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const touch = await page.context().newCDPSession(page);
  const send = (type: string, points: { x: number; y: number }[]) => touch.send("Input.dispatchTouchEvent", { type: type as "touchStart", touchPoints: points });
  await send("touchStart", [{ x, y }]);
  for (const k of [1, 2, 3]) await send("touchMove", [{ x, y: y - 10 * k }]);
  await send("touchEnd", []);
  const { points, plane } = await state();
  expect(points[0][2]).toBeGreaterThan(0.155);
  expect(points[0].slice(0, 2)).toEqual(BOARD.points[0].slice(0, 2));
  expect(plane.z).toBe(points[0][2]);
});
