// The page's three levels, its drawer, the sheet on a phone, the wiper, the tips on numbers, and the link that skips the bar.
import type { Locator, Page } from "playwright-core";
import { expect, test } from "vitest";

import { WORDS } from "../../src/app/words.ts";
import { shared } from "./setup.ts";
import { EIGHT, visit } from "./site.ts";

const open = shared();
const at = (width: number, height: number) => ({ viewport: { width, height } });
const PHONE = { ...at(390, 844), hasTouch: true, isMobile: true };

const level = (page: Page, name: string) => page.getByRole("group", { name: "How much is shown" }).getByRole("button", { name }).click();
const seen = async (page: Page, ...places: string[]) => Promise.all(places.map((place) => page.locator(place).isVisible()));
const box = async (place: Locator) => (await place.boundingBox())!;

test("each level shows its own, and a link brings it back", async () => {
  const { page, context } = await visit(open.browser, open.url);
  const parts = [".stage", ".bench", ".sentence", ".shapes", "table.numbers", ".pane"];
  expect(await seen(page, ...parts)).toEqual([true, false, true, true, false, false]);
  await level(page, "Compare");
  expect(await seen(page, ...parts)).toEqual([false, true, false, false, true, true]);
  await level(page, "Engineer");
  expect(await seen(page, ...parts)).toEqual([true, false, false, false, true, true]);
  await page.locator("summary", { hasText: "Shapes" }).click();
  expect(await seen(page, ".shapes")).toEqual([true]);
  expect(await page.evaluate(() => window.midair!.permalink())).toContain("&h=engineer");
  await context.close();
});

test.each([[1440, 900], [1200, 800], [1024, 768], [820, 1000]])("of %i px the stage has 60 %% or more in each level", async (width, height) => {
  const { page, context } = await visit(open.browser, open.url, at(width, height));
  for (const name of ["Play", "Compare", "Engineer"]) {
    await level(page, name);
    const stage = await box(page.locator(name === "Compare" ? ".bench" : ".stage"));
    expect([name, stage.width >= 0.6 * width]).toEqual([name, true]);
    if (name === "Compare") expect((await box(page.locator(".slice"))).width).toBeGreaterThan(0.5 * Math.min(stage.width, stage.height));
  }
  const drawer = page.getByRole("button", { name: "Settings" });
  expect(await drawer.isVisible()).toBe(width < 1200);
  if (width < 1200) {
    await drawer.click();
    expect((await box(page.locator(".stage"))).width).toBe(width);
    expect(await seen(page, ".panels")).toEqual([false]);
  }
  await context.close();
});

test("on a phone the stage stays on top while the sheet of tabs below it scrolls", async () => {
  const { page, context } = await visit(open.browser, open.url + EIGHT, PHONE);
  const stage = await box(page.locator(".stage"));
  expect([stage.width, stage.height > 300]).toEqual([390, true]);
  const tab = (name: string) => page.getByRole("group", { name: "Settings" }).getByRole("button", { name });
  expect(await seen(page, ".pane", ".points", ".shapes")).toEqual([true, false, false]);
  await tab("Points").tap();
  expect(await seen(page, ".pane", ".points", ".shapes")).toEqual([false, true, true]);
  await page.locator(".panels").evaluate((panels) => panels.scrollTo(0, 400));
  expect(await page.locator(".panels").evaluate(({ scrollTop }) => scrollTop)).toBeGreaterThan(50);
  expect(await box(page.locator(".stage"))).toEqual(stage);
  expect(await tab("Points").isVisible()).toBe(true);
  await context.close();
});

/** Returns red, green and blue of a pixel of the screen. */
async function pixel(page: Page, x: number, y: number): Promise<number[]> {
  const shot = [...(await page.screenshot({ clip: { x: Math.round(x), y: Math.round(y), width: 1, height: 1 } }))];
  return page.evaluate(async (shot) => {
    const pen = new OffscreenCanvas(1, 1).getContext("2d")!;
    pen.drawImage(await createImageBitmap(new Blob([Uint8Array.from(shot)])), 0, 0);
    return [...pen.getImageData(0, 0, 1, 1).data.slice(0, 3)];
  }, shot);
}

test("the wiper parts the slice between A and B, by pointer and by keys", async () => {
  const { page, context } = await visit(open.browser, open.url + EIGHT.replace("engineer", "compare"));
  const slice = await box(page.locator(".slice"));
  const wiper = page.getByRole("slider", { name: "Wiper between A and B" });
  // Beside the first point, where A is louder than B.
  const spot = [slice.x + slice.width * (0.5 + 40 / 180) + 1, slice.y + slice.height / 2 + 1] as const;
  const b = await pixel(page, ...spot);
  await page.mouse.move(slice.x + slice.width / 2, slice.y + 40);
  await page.mouse.down();
  await page.mouse.move(slice.x + 0.9 * slice.width, slice.y + 40, { steps: 3 });
  await page.mouse.up();
  expect(Number(await wiper.inputValue())).toBeCloseTo(0.9, 1);
  await expect.poll(async () => Math.max(...(await pixel(page, ...spot)).map((value, k) => Math.abs(value - b[k])))).toBeGreaterThan(30);
  await wiper.focus();
  await page.keyboard.press("Home");
  expect(await wiper.inputValue()).toBe("0");
  await expect.poll(() => pixel(page, ...spot)).toEqual(b);
  await context.close();
});

test.each([["en-GB", 0], ["ja-JP", 1]] as const)("each number has a line that explains it, on hover and on the keyboard's focus: %s", async (locale, language) => {
  const { page, context } = await visit(open.browser, open.url, { locale });
  const tip = page.getByRole("tooltip");
  const explained = async (place: Locator, line: string) => {
    await page.mouse.move(700, 300);
    await place.hover();
    expect(await tip.innerText()).toBe(line);
    await page.mouse.move(700, 300);
    expect(await tip.isVisible()).toBe(false);
    await place.focus();
    await page.keyboard.press("Shift+Tab");
    await page.keyboard.press("Tab");
    expect(await tip.innerText()).toBe(line);
    expect(await place.getAttribute("aria-describedby")).toBe(await tip.getAttribute("id"));
    await page.keyboard.press("Escape");
    expect(await tip.isVisible()).toBe(false);
  };
  const sentence = ["countTip", "weakestTip", "decibelTip", "uniformityTip", "timeTip"] as const;
  expect(await page.locator(".sentence [data-tip]").count()).toBe(sentence.length);
  for (const word of sentence) {
    await explained(page.locator(`.sentence [data-tip="${WORDS[word][language]}"]`), WORDS[word][language]);
  }
  await page.evaluate(() => window.midair!.set({ level: "engineer", ear: [0, 0.1, 0.2] }));
  const rows = page.locator("table.numbers th[scope=row]");
  const lines = await rows.evaluateAll((all) => all.map((each) => (each as HTMLElement).dataset.tip));
  expect(new Set(lines).size).toBe(await rows.count());
  for (let k = 0; k < lines.length; k += 1) await explained(rows.nth(k), lines[k]!);
  await page.evaluate(() => document.querySelectorAll("details").forEach((each) => (each.open = true)));
  const bare = await page.locator("output, .points th[scope=col], .points input, .triple input, .timeline input, input[type=number], input[type=range]:not(.wiper), .summary, .scale, .phasekey").evaluateAll((all) =>
    all.filter((each) => !each.closest("[data-tip]")).map((each) => each.outerHTML),
  );
  expect(bare).toEqual([]);
  await context.close();
});

test("the first stop of the Tab key skips to what is shown", async () => {
  const { page, context } = await visit(open.browser, open.url);
  const focused = () => page.evaluate(() => document.activeElement!.className);
  await page.keyboard.press("Tab");
  expect(await focused()).toBe("skip");
  await page.keyboard.press("Enter");
  expect(await focused()).toBe("point");
  await level(page, "Compare");
  await page.getByRole("link").focus();
  await page.keyboard.press("Enter");
  expect(await focused()).toBe("wiper");
  await context.close();
});
