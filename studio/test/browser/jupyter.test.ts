// A real JupyterLab, which `make test-studio` installs in studio/.venv: the page in a cell; points sent from Python to the page
// and back; and what remains after the cell has run ten times.
import { type ChildProcess, spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, test, vi } from "vitest";

import { grab, launch, point } from "./site.ts";

const LAB = join(import.meta.dirname, "../../.venv/bin/jupyter-lab");

const CELLS = [
  'import midair\nview = midair.view(midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.15], [0.03, 0, 0.15]]))\nview',
  "view.points = [[0.01, 0.02, 0.14]]\nprint('given', view.points.tolist())",
  "print('points', view.points.tolist(), 'levels', {name: round(of['level'], 3) for name, of in view.metrics.items()})",
];

const notebook = {
  cells: CELLS.map((source, k) => ({ cell_type: "code", id: `c${k}`, metadata: {}, execution_count: null, outputs: [], source })),
  metadata: { kernelspec: { name: "python3", display_name: "Python 3", language: "python" } },
  nbformat: 4,
  nbformat_minor: 5,
};

let folder: string;
let lab: ChildProcess;
let browser: Browser;
let page: Page;

/** Returns a free port of this machine. */
async function free(): Promise<number> {
  const server = createServer();
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  const { port } = server.address() as { port: number };
  await new Promise((done) => server.close(done));
  return port;
}

/** Runs in the page before all other scripts: stores every WebGL context that is made. */
function watch() {
  const made = Object.assign(window, { contexts: [] as WebGL2RenderingContext[] }).contexts;
  const get = HTMLCanvasElement.prototype.getContext as (this: HTMLCanvasElement, ...given: unknown[]) => unknown;
  HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, ...given: unknown[]) {
    const context = get.apply(this, given);
    if (context instanceof WebGL2RenderingContext && !made.includes(context)) made.push(context);
    return context;
  } as never;
}

const contexts = (): Promise<{ made: number; alive: number }> =>
  page.evaluate(() => {
    const { contexts } = window as unknown as { contexts: WebGL2RenderingContext[] };
    return { made: contexts.length, alive: contexts.filter((each) => !each.isContextLost()).length };
  });

const cell = (k: number) => page.locator(".jp-CodeCell").nth(k);
async function run(k: number) {
  await cell(k).locator(".cm-content").click();
  await page.keyboard.press("Shift+Enter");
}

/** Returns the points that the last cell prints for the view, in m. */
async function received(): Promise<number[][]> {
  await run(2);
  // JupyterLab shows "*" beside a running cell.
  await expect.poll(() => cell(2).locator(".jp-InputPrompt").innerText()).toMatch(/\d/);
  const [, points] = /points (\[\[.*\]\]) levels/.exec(await cell(2).locator(".jp-OutputArea").innerText())!;
  return JSON.parse(points);
}

beforeAll(async () => {
  if (!existsSync(LAB)) throw new Error(`${LAB} is missing: make test-studio puts it there`);
  folder = await mkdtemp(join(tmpdir(), "studio-"));
  await writeFile(join(folder, "view.ipynb"), JSON.stringify(notebook));
  const port = await free();
  const alone = ["--LabApp.news_url=None", "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"];
  const at = ["--no-browser", "--allow-root", "--ip=127.0.0.1", `--port=${port}`, "--IdentityProvider.token=", `--notebook-dir=${folder}`];
  const own = { JUPYTER_CONFIG_DIR: folder, JUPYTER_DATA_DIR: folder, JUPYTER_RUNTIME_DIR: folder, IPYTHONDIR: folder };
  lab = spawn(LAB, [...at, ...alone], { stdio: "ignore", env: { ...process.env, ...own } });
  const url = `http://127.0.0.1:${port}/lab/tree/view.ipynb`;
  await vi.waitUntil(() => fetch(url).then(({ ok }) => ok, () => false), { timeout: 60_000, interval: 200 });
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
  await page.addInitScript(watch);
  await page.goto(url);
  await cell(2).waitFor({ timeout: 90_000 });
  await run(0);
  // Without `make studio` the package has no page, and the test would wait for points in vain: report the cell's error.
  const failed = cell(0).locator(".jp-OutputArea-output", { hasText: "Error" });
  await point(page, 2).or(failed).first().waitFor({ timeout: 90_000 });
  if (await failed.count()) throw new Error(await failed.first().innerText());
});

afterAll(async () => {
  await browser?.close();
  if (!lab) return;
  const ended = new Promise((done) => lab.once("exit", done));
  lab.kill();
  await ended;
  await rm(folder, { recursive: true });
});

test("points that Python sets are shown, with their numbers", async () => {
  await run(1);
  await expect.poll(() => point(page, 1).getAttribute("aria-label"), { timeout: 30_000 }).toContain("x 10, y 20, z 140 mm");
  expect(await point(page, 2).count()).toBe(0);
  const numbers = page.getByRole("table", { name: "Numbers" });
  await expect.poll(() => numbers.innerText(), { timeout: 30_000 }).toMatch(/Accuracy\s+\d\.\d+\s+\d\.\d+.*Weakest \|p\|\s+[\d.]+ k?Pa/s);
});

test("points that are dragged, and moved by keys, arrive in Python", async () => {
  const [x, y] = await grab(page, 1);
  await page.mouse.move(x + 10, y + 4);
  await page.mouse.move(x + 20, y + 8);
  await page.mouse.up();
  const label = () => point(page, 1).getAttribute("aria-label");
  await expect.poll(label).not.toContain("x 10, y 20");
  const shown = async () => [...(await label())!.matchAll(/[xyz] (-?[\d.]+)/g)].map(([, mm]) => Number(mm) / 1000);
  const alike = async () => {
    const [[there], here] = [await received(), await shown()];
    return Math.max(...there.map((value, axis) => Math.abs(value - here[axis]))) < 1e-5;
  };
  await expect.poll(alike, { timeout: 30_000 }).toBe(true);
  await point(page, 1).focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(alike, { timeout: 30_000 }).toBe(true);
  expect(await cell(2).innerText()).toMatch(/levels \{'\w+': [\d.]+, '\w+': [\d.]+\}/);
});

test("ten runs of the cell leave one WebGL context, one view and its workers", async () => {
  for (let k = 0; k < 10; k += 1) {
    const before = (await contexts()).made;
    await run(0);
    await expect.poll(async () => (await contexts()).made, { timeout: 30_000 }).toBe(before + 1);
    await point(page, 2).waitFor({ timeout: 30_000 });
  }
  await expect.poll(contexts).toEqual({ made: 11, alive: 1 });
  expect(await page.getByRole("group", { name: "Array and field in space" }).count()).toBe(1);
  await expect.poll(() => page.workers().filter((worker) => worker.url().startsWith("blob:")).length).toBe(3);
});
