// Targets that a user typed and targets that the page filled in stay distinct in a link, after undo and when a point is
// removed. An exported sheet contains a long link completely.
import { readFile } from "node:fs/promises";

import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import { shared } from "./setup.ts";
import { EIGHT, ready, unfold, visit } from "./site.ts";

const open = shared();
let page: Page;

beforeEach(async () => {
  await page?.context().close();
  ({ page } = await visit(open.browser, open.url + EIGHT));
  await unfold(page, "Control points");
});

const cell = (n: number) => page.getByRole("spinbutton", { name: `Pressure of point ${n} in Pa` });
const looks = () => page.locator(".points input.filled").evaluateAll((all) => all.map((each) => each.getAttribute("aria-label")!.match(/\d+/)![0]));

test("cells that the page filled in stay so through a link, undo and a point that goes", async () => {
  await page.evaluate(() => window.midair!.set({ points: [[0.02, 0, 0.18], [-0.02, 0, 0.18], [0, 0.03, 0.18]] }));
  await page.evaluate(() => window.midair!.settled());
  await cell(2).fill("2000");
  await cell(2).press("Enter");
  await expect.poll(looks).toEqual(["1", "3"]);
  const link = await page.evaluate(() => window.midair!.permalink());
  expect(link).toMatch(/p=20,0,180,~\d+_-20,0,180,2000_0,30,180,~\d+&/);
  await cell(3).fill("1500");
  await cell(3).press("Enter");
  await expect.poll(looks).toEqual(["1"]);
  await page.locator("h1").click();
  await page.keyboard.press("Control+z");
  await expect.poll(looks).toEqual(["1", "3"]);
  await page.goto(link);
  await page.reload();
  await ready(page);
  await unfold(page, "Control points");
  await expect.poll(looks).toEqual(["1", "3"]);
  expect(await cell(2).inputValue()).toBe("2000");
  await page.getByRole("button", { name: "Remove point 1" }).click();
  await expect.poll(looks).toEqual(["2"]);
});

test("the link of 64 points is whole at the foot of the sheet", async () => {
  const points = Array.from({ length: 64 }, (_, k): [number, number, number] => [((k % 8) - 3.5) / 80 + 0.00123, (Math.floor(k / 8) - 3.5) / 80, 0.18]);
  await page.evaluate((points) => window.midair!.set({ points }), points);
  await page.evaluate(() => window.midair!.settled());
  const [file] = await Promise.all([page.waitForEvent("download"), page.evaluate(() => [...document.querySelectorAll("button")].find((each) => each.ariaLabel === "Export as SVG")!.click())]);
  const svg = (await readFile((await file.path())!)).toString();
  const [, width, height] = svg.match(/viewBox="0 0 (\d+) (\d+)"/)!.map(Number);
  const texts = await page.evaluate((svg) => {
    const root = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
    document.body.append(root);
    const all = [...root.querySelectorAll("text")].map((each) => ({ text: each.textContent!, right: (each as SVGTextElement).getBBox().x + (each as SVGTextElement).getBBox().width, y: Number(each.getAttribute("y")), size: each.getAttribute("font-size") }));
    root.remove();
    return all;
  }, svg);
  const foot = texts.filter(({ size }) => size === "10");
  expect(foot.length).toBeGreaterThan(3);
  expect(foot.map(({ text }) => text).join("")).toContain(await page.evaluate(() => window.midair!.permalink()));
  for (const { right, y } of foot) {
    expect(right).toBeLessThan(width);
    expect(y).toBeLessThan(height);
  }
});
