// The page as a person uses it: drag, keys, undo, link, export, warnings; and that nothing leaves its origin.
import { readFile, readdir } from "node:fs/promises";
import { gzipSync } from "node:zlib";

import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import { colour, entry } from "../../src/painter/maps.ts";
import type { Look, Vec3 } from "../../src/types.ts";
import { shared } from "./setup.ts";
import { built, grab, launch, point as pointOf, ready, visit } from "./site.ts";

const open = shared();
let page: Page;
let requests: string[];
let complaints: string[];

beforeEach(async () => {
  await page?.context().close();
  ({ page, requests, complaints } = await visit(open.browser, open.url));
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

/** The colour of the screen at a place, in CSS px. */
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

/** The pixels of the first three points on the slice of B, its field there, and the state. */
async function onSlice() {
  const state = (await page.evaluate(() => window.midair!.state())) as unknown as Look & {
    plane: { size: number; center: [number, number] };
  };
  const { plane } = state;
  const box = (await page.getByRole("img", { name: "Slice of B" }).boundingBox())!;
  const metres = plane.size / box.width;
  // A pixel's colour is that of its middle, up to half a pixel beside the point.
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
  const { pixels, field, state: { map, top } } = await onSlice();
  for (const [k, [x, y]] of pixels.entries()) {
    const want = colour({ quantity: "modulus", map, scale, top, turn: 0, theme: "dark" }, Math.hypot(...field[k]));
    (await pixel(x, y)).forEach((value, channel) => expect(Math.abs(value - want[channel])).toBeLessThanOrEqual(8));
  }
});

/** The button of a quantity that the slices can show. */
const shows = (name: string) => page.getByRole("group", { name: "What the slices show" }).getByRole("button", { name, exact: true });

test("at the points the wave follows the cosine of their phases, half a period a quarter of a second", async () => {
  // Software paints what runs at half the resolution: a narrow slice, so that a pixel is small nonetheless.
  await page.evaluate(() => window.midair!.set({ plane: { z: 0.18, size: 0.05, center: [0.032, 0.016] } }));
  await settled();
  // The page's clock is the test's.
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
    // The third point is beside the slice.
    for (const [k, [x, y]] of pixels.slice(0, 2).entries()) {
      const [re, im] = field[k];
      const now = (Math.hypot(re, im) / top) * Math.cos(Math.atan2(im, re) - (2 * Math.PI * instant) / 500);
      const want = entry("light", Math.min(Math.max(0.5 + now / 2, 0), 1));
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

/** Drops a file onto the page. */
const drop = (name: string, text: string) =>
  page.evaluate(
    ([name, text]) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([text], name));
      document.querySelector("main")!.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, text],
  );

test("an SVG that is dropped in becomes points along its lines; one with a script is refused", async () => {
  const before = await points();
  const svg = (body: string) => `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">${body}</svg>`;
  await drop("square.svg", svg('<rect x="1" y="1" width="8" height="8"/>'));
  await expect.poll(points).not.toEqual(before);
  const found = await points();
  expect(found.length).toBeGreaterThanOrEqual(8);
  for (const [x, y, z] of found) {
    expect(Math.max(Math.abs(x), Math.abs(y))).toBeCloseTo(0.04, 5);
    expect(z).toBe(before[0][2]);
  }
  await drop("bad.svg", svg("<script>1</script><rect width='8' height='8'/>"));
  const alert = page.getByRole("alert");
  await expect.poll(() => alert.innerText()).toMatch(/bad\.svg: the drawing has a script/);
  expect(await points()).toEqual(found);
});

test("a file of another kind is told which are read", async () => {
  await drop("photo.png", "\x89PNG");
  await expect.poll(() => page.getByRole("alert").innerText()).toMatch(/photo\.png: give \.toml, \.json, \.csv or \.svg/);
});

test("a number is shown as it was taken", async () => {
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
  await expect.poll(async () => Number.isNaN((await times())[0])).toBe(true);
});

test("eight letters are typed, drawn by Enter, and fit the slice", async () => {
  await page.getByLabel("Shapes").selectOption("text");
  const field = page.getByRole("textbox", { name: "Letters" });
  expect((await field.boundingBox())!.width).toBeGreaterThan(60);
  await field.fill("ABCDEFGH");
  await field.press("Enter");
  await expect.poll(async () => (await points()).length).toBeGreaterThan(30);
  for (const [x, y] of await points()) expect(Math.max(Math.abs(x), Math.abs(y))).toBeLessThan(0.09);
});

test("what moves right after a change moves, and the panes say whose numbers these are", async () => {
  await page.evaluate(() => window.midair!.set({ view: "both", methods: ["greedy", "naive"], path: { kind: "circle", radius: 0.01, frequency: 4 } }));
  await page.waitForTimeout(100);
  await page.getByRole("button", { name: "Move", exact: true }).click();
  const summary = (slot: string) => page.getByRole("region", { name: `Method ${slot}` }).locator(".summary").innerText();
  await expect.poll(() => summary("A"), { timeout: 60_000 }).toBe("glide");
  expect(await summary("B")).toBe("at rest");
  expect(await page.getByRole("table", { name: "Numbers" }).innerText()).not.toContain("Uniformity");
  expect(await page.getByRole("alert").innerText()).toBe("");
  await page.getByRole("button", { name: "Rest", exact: true }).click();
  await expect.poll(() => summary("A")).toMatch(/^U /);
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

test("a path is played with its changes and weakest points as curves; what stands still is told", async () => {
  await page.evaluate(() =>
    window.midair!.set({ view: "slice", path: { kind: "circle", radius: 0.004, frequency: 40 } }),
  );
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

test("on a Japanese page a refusal begins in Japanese", async () => {
  const { page: japanese, context } = await visit(open.browser, `${open.url}#v=1&p=here`, { locale: "ja-JP" });
  expect(await japanese.getByRole("alert").innerText()).toMatch(/読み込めません.*here/);
  await context.close();
});

test("a scene that cannot be solved is told in the page's language, without the file's line and column", async () => {
  const inside = { points: [[0, 0, 0.1]], obstacles: [{ center: [0, 0, 0.1], radius: 0.02, kind: "rigid" }] };
  const told = async (shown: Page) => {
    await shown.evaluate((state) => window.midair!.set(state as never), inside);
    await shown.evaluate(() => window.midair!.settled());
    return shown.getByRole("alert").innerText();
  };
  expect(await told(page)).toMatch(/^Cannot be solved: point 1\.position is .*inside the sphere/);
  const { page: japanese, context } = await visit(open.browser, open.url, { locale: "ja-JP" });
  expect(await told(japanese)).toMatch(/^解けません: 点 1 は障害物の中/);
  await context.close();
});

test("a link opens what was shared; a bad one is one alert", async () => {
  await page.evaluate(() => window.midair!.set({ temperature: 31, methods: ["greedy", "gspat"] }));
  await settled();
  const [link, state] = await page.evaluate(() => [window.midair!.permalink(), window.midair!.state()]);
  const other = await visit(open.browser, link);
  const found = await other.page.evaluate(() => window.midair!.state());
  for (const key of ["array", "points", "methods", "temperature", "plane", "map", "scale"]) {
    expect(found[key]).toEqual(state[key]);
  }
  await other.context.close();
  const bad = await visit(open.browser, `${open.url}#v=1&p=here`);
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

test("the exported picture is a sheet with axes, bar, numbers, version and link, as SVG and as PNG of double size", async () => {
  const download = async (name: string) => {
    const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name }).click()]);
    return readFile((await file.path())!);
  };
  const svg = (await download("Export as SVG")).toString();
  const version = await page.evaluate(() => window.midair!.version);
  for (const part of ["A: uniform", "B: naive", "x / mm", "y / mm", "kPa", "Uniformity", `midair ${version}`, "#v=1"]) expect(svg).toContain(part);
  expect(svg.match(/<image /g)).toHaveLength(5);
  expect(svg.match(/<circle /g)).toHaveLength(2 * (await points()).length);
  const png = await download("Export picture");
  expect([png.readUInt32BE(16), png.readUInt32BE(20)]).toEqual([2560, 1520]);
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
  expect(requests.filter((url) => !url.startsWith(open.url) && !url.startsWith("blob:") && !url.startsWith("data:"))).toEqual([]);
  expect(complaints).toEqual([]);
});

test("page code and style are at most 90 kB", async () => {
  const files = (await readdir(`${built}/site/assets`)).map((name) => readFile(`${built}/site/assets/${name}`));
  const sizes = (await Promise.all(files)).map((file) => gzipSync(file, { level: 9 }).length);
  expect(sizes.reduce((a, b) => a + b)).toBeLessThanOrEqual(90_000);
});

test("without WebGL2 the slices are still drawn", async () => {
  const plain = await launch("--disable-3d-apis");
  const { page: flat } = await visit(plain, open.url);
  expect(await flat.evaluate(() => window.midair!.state().ready)).toBe(true);
  expect(await flat.getByRole("alert").innerText()).toContain("no WebGL 2");
  await plain.close();
});

test("the single file works from the disk", async () => {
  const other = await open.browser.newContext();
  const disk = await other.newPage();
  await disk.goto(`file://${built}/studio.html`);
  await ready(disk);
  await other.close();
});
