// Files, links, exports and error messages of the page; that the page sends nothing to other origins; and its size.
import { readFile, readdir, stat } from "node:fs/promises";
import { gzipSync } from "node:zlib";

import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import type { Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { built, EIGHT, fromMenu, launch, point, ready, visit } from "./site.ts";

const open = shared();
let page: Page;
let requests: string[];
let complaints: string[];

beforeEach(async () => {
  await page?.context().close();
  ({ page, requests, complaints } = await visit(open.browser, open.url + EIGHT));
});

const points = () => page.evaluate(() => window.midair!.state().points as Vec3[]);
const settled = () => page.evaluate(() => window.midair!.settled());

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

const SCENE = `
signature = "trap"
[array]
preset = "openmpd_pair"
[[points]]
position = [0, 0, 0]
[bead]
radius = 1.2e-3
density = 900
[solver]
name = "greedy"
seed = 3
`;

test("a scene that is dropped in keeps its bead and options, in link and file; what the page has not is named", async () => {
  const alert = () => page.getByRole("alert").innerText();
  await drop("scene.toml", SCENE);
  await expect.poll(points).toEqual([[0, 0, 0]]);
  const state = await page.evaluate(() => window.midair!.state());
  expect(state).toMatchObject({ bead: { radius: 1.2e-3, density: 900 }, options: { greedy: { seed: 3 } }, signature: "trap" });
  // The parts of an array that all such arrays have do not make it one's own.
  expect(await page.evaluate(() => window.midair!.permalink())).toMatch(/a=openmpd_pair\.1x1&.*&b=1\.2,900,[\d.]+,0,0,-9\.81&x=/);
  const [file] = await Promise.all([page.waitForEvent("download"), fromMenu(page, "Export scene")]);
  const scene = await readFile((await file.path())!, "utf8");
  for (const line of ["[bead]", "radius = 0.0012", "density = 900.0", "seed = 3"]) expect(scene).toContain(line);
  for (const [text, line] of [
    [`${SCENE}\n[table]\nx = 1`, /scene\.toml: .*table/],
    [SCENE.replace("seed", "sead"), /scene\.toml: .*sead/],
    [SCENE.replace("[bead]", "weight = 2\n[bead]"), /scene\.toml: points\[0\]\.weight is 2: the page has 1, use the package/],
  ] as const) {
    await drop("scene.toml", text);
    await expect.poll(alert).toMatch(line);
  }
  expect(await points()).toEqual([[0, 0, 0]]);
});

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
  await drop("use.svg", svg('<rect id="a" width="8" height="8"/><use href="#a" x="9"/>'));
  await expect.poll(() => alert.innerText()).toMatch(/use\.svg: the drawing has <use>, which the page does not draw/);
  expect(await points()).toEqual(found);
  // Of all these a browser shows one rectangle, twice as wide as high.
  const hidden = [
    '<rect width="10" height="3" display="none"/>',
    '<g style="visibility: hidden"><rect width="10" height="3"/><rect x="6" y="1" width="4" height="2" visibility="visible"/></g>',
    '<g opacity="0"><circle r="9"/></g>',
    '<path d="M0 0H30" fill="none"/>',
    '<defs><rect width="90" height="1"/></defs>',
  ];
  await drop("hidden.svg", svg(hidden.join("")));
  await expect.poll(points).not.toEqual(found);
  for (const [x, y] of await points()) expect(Math.max(Math.abs(x), 2 * Math.abs(y))).toBeCloseTo(0.04, 5);
});

test("a file of another kind gets the list of readable kinds, a damaged picture is rejected", async () => {
  await drop("notes.txt", "hello");
  await expect.poll(() => page.getByRole("alert").innerText()).toMatch(/notes\.txt: give \.toml, \.json, \.csv, \.svg, \.png or \.jpg/);
  await drop("photo.png", "\x89PNG");
  await expect.poll(() => page.getByRole("alert").innerText()).toMatch(/photo\.png: it cannot be read as a picture/);
});

test("a picture that is dropped in becomes points on the slice, by their brightness", async () => {
  // A picture twice as wide as high: white at the left, grey at the right, and a dark gap between.
  await page.evaluate(async () => {
    const canvas = new OffscreenCanvas(120, 60);
    const pen = canvas.getContext("2d")!;
    for (const [x, colour] of [[0, "#fff"], [90, "#808080"]] as const) {
      pen.fillStyle = colour;
      pen.fillRect(x, 0, 30, 60);
    }
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([await canvas.convertToBlob()], "bars.png"));
    document.querySelector("main")!.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  });
  await expect.poll(() => page.evaluate(() => window.midair!.state().pressures)).not.toBeNull();
  const { pressures } = await page.evaluate(() => window.midair!.state() as unknown as { pressures: number[] });
  const found = await points();
  expect(found.length).toBeGreaterThan(20);
  expect(found.length).toBeLessThanOrEqual(64);
  found.forEach(([x, y, z], k) => {
    expect(Math.abs(x)).toBeLessThan(0.04);
    expect(Math.abs(x)).toBeGreaterThan(0.015);
    expect(Math.abs(y)).toBeLessThan(0.02);
    expect(z).toBe(found[0][2]);
    if (Math.abs(x) > 0.025) expect(pressures[k]).toBeCloseTo(x < 0 ? 1000 : 502, -1);
  });
});

test("on a Japanese page a refusal begins in Japanese", async () => {
  const { page: japanese, context } = await visit(open.browser, `${open.url}#v=1&p=here`, { locale: "ja-JP" });
  expect(await japanese.getByRole("alert").innerText()).toMatch(/読み込めません.*here/);
  await context.close();
});

test("a scene that cannot be solved is reported in the page's language, without the file's line and column", async () => {
  const inside = { points: [[0, 0, 0.1]], obstacles: [{ center: [0, 0, 0.1], radius: 0.02, kind: "rigid" }] };
  const alarmOf = async (shown: Page) => {
    await shown.evaluate((state) => window.midair!.set(state as never), inside);
    await shown.evaluate(() => window.midair!.settled());
    return shown.getByRole("alert").innerText();
  };
  expect(await alarmOf(page)).toMatch(/^Cannot be solved: point 1\.position is .*inside the sphere/);
  const { page: japanese, context } = await visit(open.browser, open.url, { locale: "ja-JP" });
  expect(await alarmOf(japanese)).toMatch(/^解けません: 点 1 は障害物の中/);
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
  const download = async (name: string) => {
    const [file] = await Promise.all([page.waitForEvent("download"), fromMenu(page, name)]);
    return readFile((await file.path())!, "utf8");
  };
  const scene = await download("Export scene");
  const drive = (await download("Export drive")).trim().split("\n");
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
    const [file] = await Promise.all([page.waitForEvent("download"), fromMenu(page, name)]);
    return readFile((await file.path())!);
  };
  const svg = (await download("Export as SVG")).toString();
  const version = await page.evaluate(() => window.midair!.version);
  for (const part of ["A: uniform", "B: naive", "x / mm", "y / mm", "kPa", "Uniformity", `midair ${version}`, "#v=1"]) expect(svg).toContain(part);
  expect(svg.match(/<image /g)).toHaveLength(5);
  expect(svg.match(/<circle /g)).toHaveLength(2 * (await points()).length);
  const png = await download("Export picture");
  const size = svg.match(/viewBox="0 0 (\d+) (\d+)"/)!.slice(1).map(Number);
  expect([png.readUInt32BE(16), png.readUInt32BE(20)]).toEqual(size.map((px) => 2 * px));
  expect(size[0]).toBe(1280);
  const plain = await download("Export plain picture");
  expect([plain.readUInt32BE(16), plain.readUInt32BE(20)]).toEqual([540, 540]);
});

test("nothing leaves the origin, and nothing is complained of", async () => {
  await page.getByRole("button", { name: "Gallery" }).click();
  await page.getByRole("dialog").getByRole("button").nth(2).click();
  await settled();
  expect(requests.filter((url) => !url.startsWith(open.url) && !url.startsWith("blob:") && !url.startsWith("data:"))).toEqual([]);
  expect(complaints).toEqual([]);
});

test("page code and style are at most 90 kB, and each poster 16 kB", async () => {
  const names = await readdir(`${built}/site/assets`);
  const files = names.filter((name) => !name.endsWith(".jpeg")).map((name) => readFile(`${built}/site/assets/${name}`));
  const sizes = (await Promise.all(files)).map((file) => gzipSync(file, { level: 9 }).length);
  expect(sizes.reduce((a, b) => a + b)).toBeLessThanOrEqual(90_000);
  const posters = names.filter((name) => name.endsWith(".jpeg")).map((name) => stat(`${built}/site/assets/${name}`));
  expect((await Promise.all(posters)).map((file) => file.size < 16_000)).toEqual([true, true]);
});

test("without WebGL2 a line says so, and everything but the pictures works", async () => {
  const plain = await launch("--disable-3d-apis");
  const { page: blind } = await visit(plain, open.url);
  expect(await blind.evaluate(() => window.midair!.state().ready)).toBe(true);
  expect(await blind.getByRole("alert").innerText()).toContain("no WebGL 2");
  await point(blind, 1).press("ArrowUp");
  await blind.evaluate(() => window.midair!.settled());
  expect(await blind.getByRole("alert").innerText()).toContain("no WebGL 2");
  await expect.poll(() => point(blind, 1).getAttribute("aria-label"), { timeout: 60_000 }).toContain("y 1,");
  await plain.close();
});

test("the single file works from the disk", async () => {
  const other = await open.browser.newContext();
  const disk = await other.newPage();
  await disk.goto(`file://${built}/studio.html`);
  await ready(disk);
  await other.close();
});
