// Layout of the gallery's scenes, on a wide screen and on a phone: numbers cover neither rings nor each other, the 3-D view
// contains all its parts, no text is cut, nothing overflows, and the canvas has the right number of pixels.
import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { gallery } from "../../src/state/gallery.ts";
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
