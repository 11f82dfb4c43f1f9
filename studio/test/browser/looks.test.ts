// Layout of the gallery's scenes, on a wide screen and on a phone: numbers cover neither rings nor each other, the 3-D view
// contains all its parts, no text is cut, nothing overflows, and the canvas has the right number of pixels.
import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { gallery } from "../../src/state/gallery.ts";
import { first } from "../../src/state/initial.ts";
import { placeOn, planesOf } from "../../src/state/plane.ts";
import { isTrap } from "../../src/state/signature.ts";
import type { State, Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { visit } from "./site.ts";

const open = shared();

/** Returns the visible faults, one line each. */
const faults = (page: Page) =>
  page.evaluate(() => {
    const found: string[] = [];
    const view = document.querySelector(".view3d")!.getBoundingClientRect();
    const buttons = view.width ? [...document.querySelectorAll<HTMLElement>(".point")] : [];
    const rings = buttons.map((button) => {
      const { left, top, width, height } = button.getBoundingClientRect();
      const radius = parseFloat(getComputedStyle(button).getPropertyValue("--ring")) / 2;
      return { x: left + width / 2, y: top + height / 2, radius };
    });
    rings.forEach(({ x, y }, k) => {
      if (x < view.left || x > view.right || y < view.top || y > view.bottom) found.push(`ring ${k + 1} is out of sight`);
    });
    const numbers = buttons.map((button) => button.firstElementChild!.getBoundingClientRect());
    numbers.forEach((box, k) => {
      if (!box.width) return;
      rings.forEach(({ x, y, radius }, other) => {
        const away = Math.hypot(Math.max(box.left - x, x - box.right, 0), Math.max(box.top - y, y - box.bottom, 0));
        if (away < radius - 0.1) found.push(`number ${k + 1} covers ring ${other + 1}`);
      });
      numbers.slice(0, k).forEach((second, other) => {
        const wide = Math.min(box.right, second.right) - Math.max(box.left, second.left);
        const high = Math.min(box.bottom, second.bottom) - Math.max(box.top, second.top);
        if (second.width && wide > 0.1 && high > 0.1) found.push(`number ${k + 1} covers number ${other + 1}`);
      });
    });
    for (const place of document.querySelectorAll<HTMLElement>("button, label, output, th, td, .ticks span, .summary, .sentence, h1, h2")) {
      if (place.classList.contains("point") || !place.clientWidth) continue;
      if (place.scrollWidth > place.clientWidth + 1) found.push(`cut: ${place.innerText}`);
    }
    const ticks = [...document.querySelectorAll<HTMLElement>(".ticks")].map((each) => each.innerText);
    for (const text of ticks) if (!/Pa|dB/.test(text)) found.push(`no unit: ${text}`);
    if (document.documentElement.scrollWidth > innerWidth) found.push("the page is wider than its window");
    const canvas = document.querySelector<HTMLCanvasElement>(".canvas")!;
    const gl = canvas.getContext("webgl2")!;
    if (gl.drawingBufferHeight !== canvas.height) found.push(`the canvas has ${gl.drawingBufferHeight} of ${canvas.height} px`);
    return found;
  });

const wide = { viewport: { width: 1440, height: 900 } };
const phone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3, hasTouch: true, isMobile: true };

test.each([
  { ...wide, locale: "en-GB" },
  { ...wide, locale: "ja-JP" },
  { ...phone, locale: "en-GB" },
  { ...phone, locale: "ja-JP" },
])("$viewport.width $locale", async (options) => {
  const { page, context } = await visit(open.browser, open.url, options);
  for (const level of ["play", "compare", "engineer"] as const) {
    await page.evaluate((level) => window.midair!.set({ level }), level);
    expect([level, ...(await faults(page))]).toEqual([level]);
  }
  for (const { name, state } of gallery) {
    await page.evaluate((state) => window.midair!.set({ ...state, level: "engineer" } as never), state);
    await page.evaluate(() => window.midair!.settled());
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    expect([name[0], ...(await faults(page))]).toEqual([name[0]]);
  }
  await context.close();
});

test("on a phone the menu folds when something was taken from it", async () => {
  const { page, context } = await visit(open.browser, open.url, phone);
  await page.getByRole("button", { name: "Menu" }).tap();
  await page.getByRole("button", { name: "Export scene" }).tap();
  expect(await page.getByRole("button", { name: "Export scene" }).isVisible()).toBe(false);
  expect(await page.evaluate(() => document.activeElement?.getAttribute("aria-label"))).toBe("Menu");
  await context.close();
});

/** Places a quarter and half a wavelength around a trap, where the sound that holds its bead is. */
const AROUND = [0.0022, 0.0043].flatMap((away) => [0, 1, 2].flatMap((axis) => [-away, away].map((x) => [0, 0, 0].with(axis, x))));

/**
 * Returns the part of the points, without quiet ones, at which |p| is above half of the slice's largest |p|, and the part of the
 * 3-D view that the box around slice and points fills.
 */
async function seen(page: Page): Promise<[loud: number, filled: number]> {
  await page.evaluate(() => window.midair!.settled());
  const state = (await page.evaluate(() => window.midair!.state())) as unknown as State;
  const moduli = async (places: Vec3[]) => (await page.evaluate((places) => window.midair!.field(0, places), places)).map(([re, im]) => Math.hypot(re, im));
  const steps = Array.from({ length: 81 }, (_, k) => k / 80);
  const top = Math.max(...(await moduli(steps.flatMap((right) => steps.map((up) => placeOn(state.plane, right, up))))));
  const points = state.points.filter((_, k) => state.pressures?.[k] !== 0);
  const trapped = points.map((_, k) => isTrap(state.signature, k));
  const near = await Promise.all(points.map((point, k) => moduli(trapped[k] ? AROUND.map((way) => point.map((x, axis) => x + way[axis]) as Vec3) : [point])));
  const loud = near.filter((all) => Math.max(...all) > top / 2).length / points.length;
  const corners = planesOf(state).flatMap((plane) => [0, 1].flatMap((right) => [0, 1].map((up) => placeOn(plane, right, up))));
  const box = (await page.locator(".view3d").boundingBox())!;
  const spots = await page.evaluate((places) => places.map((place) => window.midair!.project(place)), [...state.points, ...corners]);
  const [wide, high] = [[box.x, box.width], [box.y, box.height]].map(([least, side], axis) => {
    const all = spots.map((spot) => Math.min(Math.max(spot[axis], least), least + side));
    return (Math.max(...all) - Math.min(...all)) / side;
  });
  return [loud, wide * high];
}

test.each([wide, phone])("in Play each shape, preset and gallery scene is loud at its points and fills the view: $viewport.width", async (options) => {
  const { page, context } = await visit(open.browser, open.url, options);
  const begin = (state: State) => page.evaluate((state) => window.midair!.set(state), { ...state, level: "play" as const });
  const faint: string[] = [];
  const judge = async (name: string) => {
    const [loud, filled] = await seen(page);
    if (loud < 0.6 || filled < 0.35) faint.push(`${name}: ${(100 * loud).toFixed(0)} % of the points, ${(100 * filled).toFixed(0)} % of the view`);
  };
  for (const name of ["Circle", "Line", "Square", "Heart", "Letters"]) {
    await begin(first);
    await page.getByRole("group", { name: "Shapes" }).getByRole("button", { name, exact: false }).click();
    await expect.poll(async () => ((await page.evaluate(() => window.midair!.state())) as unknown as State).plane.axis).toBe("z");
    await judge(name);
  }
  const presets = await page.locator(".arrays option").evaluateAll((all) => all.map((option) => (option as HTMLOptionElement).value));
  expect(presets).toHaveLength(13);
  for (const preset of presets) {
    await begin(first);
    await page.locator(".arrays").evaluate((select, preset) => {
      (select as HTMLSelectElement).value = preset;
      select.dispatchEvent(new Event("change"));
    }, preset);
    await expect.poll(async () => (await page.evaluate(() => window.midair!.state())) as unknown as State).toMatchObject({ array: { preset } });
    await judge(preset);
  }
  for (const { name, state } of gallery) {
    await begin(state);
    await judge(name[0]);
  }
  expect(faint).toEqual([]);
  await context.close();
}, 300_000);
