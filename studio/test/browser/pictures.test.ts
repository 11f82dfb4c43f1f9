// Pixels of the pictures: colours by map and scale, the animated wave, resolution; and the direction of the camera.
import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import { colour, entry } from "../../src/painter/maps.ts";
import type { Look, Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { EIGHT, grab, visit } from "./site.ts";

const open = shared();
let page: Page;

beforeEach(async () => {
  await page?.context().close();
  ({ page } = await visit(open.browser, open.url + EIGHT));
});

const points = () => page.evaluate(() => window.midair!.state().points as Vec3[]);
const settled = () => page.evaluate(() => window.midair!.settled());

/** Returns the colour of the screen at a place, in CSS px. */
async function pixel(x: number, y: number): Promise<number[]> {
  const clip = { x: Math.floor(x), y: Math.floor(y), width: 1, height: 1 };
  const shot = [...(await page.screenshot({ clip, timeout: 150_000 }))];
  return page.evaluate(async (shot) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(shot)]));
    const pen = new OffscreenCanvas(1, 1).getContext("2d")!;
    pen.drawImage(bitmap, 0, 0);
    return [...pen.getImageData(0, 0, 1, 1).data.slice(0, 3)];
  }, shot);
}

test("what was painted coarsely in a drag is painted in full at rest, where the lattice stays as it was, too", async () => {
  await page.evaluate(() => window.midair!.set({ view: "slice", plane: { z: 0.18, size: 0.05, center: [0.04, 0] } }));
  await settled();
  const width = () => page.evaluate(() => document.querySelector<HTMLCanvasElement>("canvas.canvas")!.width);
  const [x, y] = await grab(page, 1);
  await page.mouse.move(x + 10, y + 2);
  await expect.poll(width).toBe(720);
  await page.mouse.up();
  await expect.poll(width).toBe(1440);
});

/** Returns the pixels of the first three points on the slice while it shows only B, B's field there, and the state. */
async function onSlice() {
  await page.getByLabel("Wiper between A and B").fill("0");
  const state = (await page.evaluate(() => window.midair!.state())) as unknown as Look & {
    plane: { size: number; center: [number, number] };
  };
  const { plane } = state;
  const box = (await page.getByRole("img", { name: /^Slice/ }).boundingBox())!;
  const metres = plane.size / box.width;
  // A pixel shows the colour of its middle, which is up to half a pixel away from the point.
  const pixels = (await points()).slice(0, 3).map(([x, y]) => [
    Math.floor(box.x + box.width / 2 + (x - plane.center[0]) / metres) + 0.5,
    Math.floor(box.y + box.height / 2 - (y - plane.center[1]) / metres) + 0.5,
  ]);
  const [, , z] = (await points())[0];
  const places = pixels.map(([x, y]): Vec3 => [
    plane.center[0] + (x - box.x - box.width / 2) * metres,
    plane.center[1] - (y - box.y - box.height / 2) * metres,
    z,
  ]);
  const field = await page.evaluate(async (places) => window.midair!.field(1, places), places);
  return { pixels, field, state };
}

test.each(["linear", "squared", "decibel"] as const)("a point on a slice has the map's colour: %s", async (scale) => {
  await page.evaluate((scale) => window.midair!.set({ scale }), scale);
  await settled();
  await page.waitForTimeout(500);
  const { pixels, field, state: { top } } = await onSlice();
  for (const [k, [x, y]] of pixels.entries()) {
    const want = colour({ quantity: "modulus", scale, top, turn: 0, theme: "light" }, Math.hypot(...field[k]));
    (await pixel(x, y)).forEach((value, channel) => expect(Math.abs(value - want[channel])).toBeLessThanOrEqual(8));
  }
});

/** Returns the button of a quantity that the slices can show. */
const shows = (name: string) => page.getByRole("group", { name: "What the slices show" }).getByRole("button", { name, exact: true });

test("at the points the wave follows the cosine of their phases, half a period a quarter of a second", async () => {
  // Software renders animations at half the resolution; in a small slice, even such a pixel is less than a millimetre wide.
  await page.evaluate(() => window.midair!.set({ plane: { z: 0.18, size: 0.05, center: [0.032, 0.016] } }));
  await settled();
  // The test replaces the page's clock.
  await page.evaluate(() => {
    const soon = window.requestAnimationFrame.bind(window);
    const clock = window as unknown as { instant: number };
    clock.instant = 0;
    window.requestAnimationFrame = (act) => soon(() => act(clock.instant));
  });
  await shows("Wave").click();
  expect(await shows("Wave").getAttribute("aria-pressed")).toBe("true");
  const { pixels, field, state: { top } } = await onSlice();
  for (const instant of [0, 125, 200, 250, 375, 1000]) {
    await page.evaluate((instant) => void Object.assign(window, { instant }), instant);
    // The third point is not on the slice.
    for (const [k, [x, y]] of pixels.slice(0, 2).entries()) {
      const [re, im] = field[k];
      const now = (Math.hypot(re, im) / top) * Math.cos(Math.atan2(im, re) - (2 * Math.PI * instant) / 500);
      const want = entry("wave_light", Math.min(Math.max(0.5 + now / 2, 0), 1));
      const off = async () => Math.max(...(await pixel(x, y)).map((value, channel) => Math.abs(value - want[channel])));
      await expect.poll(off, { message: `point ${k + 1} at ${instant} ms`, timeout: 10_000 }).toBeLessThanOrEqual(10);
    }
  }
});

test("the wave runs and can be stopped; it stands where less motion is wanted", async () => {
  await settled();
  const { pixels } = await onSlice();
  const colours = async () => (await Promise.all(pixels.map(([x, y]) => pixel(x, y)))).flat();
  const changes = async () => {
    await page.waitForTimeout(1000);
    const before = await colours();
    await page.waitForTimeout(130);
    return (await colours()).some((value, k) => Math.abs(value - before[k]) > 3);
  };
  expect(await changes()).toBe(false);
  await shows("Wave").click();
  await expect.poll(changes).toBe(true);
  await page.emulateMedia({ reducedMotion: "reduce" });
  expect(await changes()).toBe(false);
  await page.emulateMedia({ reducedMotion: "no-preference" });
  await expect.poll(changes).toBe(true);
  await shows("Phase").click();
  expect(await changes()).toBe(false);
  expect(await page.evaluate(() => window.midair!.permalink())).toContain("&d=phase");
});

test("the camera goes after a point that comes to lie out of sight, and back with it", async () => {
  const seen = (place: Vec3) => page.evaluate((place) => window.midair!.project(place), place);
  const put = async (place: Vec3) => {
    await page.evaluate((place) => window.midair!.set({ points: [place] }), place);
    await settled();
    return seen(place);
  };
  const before = await put([0, 0, 0.18]);
  const box = (await page.getByRole("group", { name: "Array and field in space" }).boundingBox())!;
  const [x, y] = await put([0.7, 0, 0.18]);
  expect(x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height).toBe(true);
  const after = await put([0, 0, 0.18]);
  expect(Math.hypot(after[0] - before[0], after[1] - before[1])).toBeLessThan(1);
});
