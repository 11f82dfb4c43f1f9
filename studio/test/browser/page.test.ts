// The page as a person uses it: drag, keys, undo, link, export, warnings; and that nothing leaves its origin.
import { readFile } from "node:fs/promises";

import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";

import type { Vec3 } from "../../src/types.ts";
import { built, launch, ready, serve, visit } from "./site.ts";

let browser: Browser;
let site: { url: string; close(): void };
let page: Page;
let requests: string[];
let complaints: string[];

beforeAll(async () => {
  site = await serve(`${built}/site`);
  browser = await launch();
});
afterAll(async () => {
  await browser?.close();
  site?.close();
});
beforeEach(async () => {
  await page?.context().close();
  ({ page, requests, complaints } = await visit(browser, site.url));
});

const points = () => page.evaluate(() => window.midair!.state().points as Vec3[]);
const point = (n: number) => page.getByRole("button", { name: new RegExp(`^Point ${n}:`) });
const settled = () => page.evaluate(() => window.midair!.settled());

test("a drag leaves the point under the pointer, at its height; undo goes back", async () => {
  const before = await points();
  const box = (await point(2).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
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
  const box = (await point(3).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.keyboard.down("Shift");
  await page.mouse.move(x, y);
  await page.mouse.down();
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
  const slice = page.getByRole("img", { name: "Slice of A" });
  await slice.dblclick({ position: { x: 20, y: 30 } });
  expect(await points()).toHaveLength(count + 1);
  const [x, y] = await page.evaluate(() => {
    const { center, z } = window.midair!.state().plane as { center: number[]; z: number };
    return window.midair!.project([center[0] + 0.065, center[1] - 0.02, z]);
  });
  await page.mouse.dblclick(x, y);
  expect(await points()).toHaveLength(count + 2);
});

test("what is shown is the field, and has the map's colour", async () => {
  const places = (await points()).slice(0, 4);
  const [field, shown] = await page.evaluate(
    async (places) => [await window.midair!.field(0, places), window.midair!.shown(0, places)],
    places,
  );
  const largest = Math.max(...field.map(([re, im]) => Math.hypot(re, im)));
  field.forEach(([re, im], k) => {
    expect(Math.hypot(shown[k]![0] - re, shown[k]![1] - im) / largest).toBeLessThan(0.005);
  });
});

test("a link opens what was shared; a bad one is one alert", async () => {
  await page.evaluate(() => window.midair!.set({ temperature: 31, methods: ["greedy", "gspat"] }));
  await settled();
  const [link, state] = await page.evaluate(() => [window.midair!.permalink(), window.midair!.state()]);
  const other = await visit(browser, link);
  const found = await other.page.evaluate(() => window.midair!.state());
  for (const key of ["array", "points", "methods", "temperature", "plane", "map", "scale"]) {
    expect(found[key]).toEqual(state[key]);
  }
  await other.context.close();
  const bad = await visit(browser, `${site.url}#v=1&p=here`);
  const alerts = bad.page.getByRole("alert");
  expect(await alerts.count()).toBe(1);
  expect(await alerts.innerText()).toMatch(/here/);
  await bad.context.close();
});

test("export gives a scene and a drive that say the same", async () => {
  const download = async (name: RegExp) => {
    const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name }).click()]);
    return readFile((await file.path())!, "utf8");
  };
  const scene = await download(/export scene/i);
  const drive = (await download(/export drive/i)).trim().split("\n");
  expect(scene).toContain("[[points]]");
  expect(drive[0]).toBe("index,x,y,z,amplitude,phase");
  const wanted = await page.evaluate(() => window.midair!.drive(0));
  expect(drive).toHaveLength(wanted.length + 1);
  const [, , , , amplitude, phase] = drive[1].split(",").map(Number);
  expect(amplitude * Math.cos(phase)).toBeCloseTo(wanted[0][0], 5);
  expect(amplitude * Math.sin(phase)).toBeCloseTo(wanted[0][1], 5);
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

test("nothing leaves the origin, and nothing is complained of", async () => {
  await page.getByRole("button", { name: "Gallery" }).click();
  await page.getByRole("dialog").getByRole("button").nth(2).click();
  await settled();
  expect(requests.filter((url) => !url.startsWith(site.url) && !url.startsWith("blob:") && !url.startsWith("data:"))).toEqual([]);
  expect(complaints).toEqual([]);
});

test("without WebGL2 the slices are still drawn", async () => {
  const plain = await launch("--disable-3d-apis");
  const { page: flat } = await visit(plain, site.url);
  expect(await flat.evaluate(() => window.midair!.state().ready)).toBe(true);
  await plain.close();
});

test("the single file works from the disk", async () => {
  const other = await browser.newContext();
  const disk = await other.newPage();
  await disk.goto(`file://${built}/studio.html`);
  await ready(disk);
  await other.close();
});
