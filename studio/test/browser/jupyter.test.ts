// A real JupyterLab: the view in a cell, points from Python to the page and from the page to Python. JUPYTER names the
// program jupyter-lab of an environment with midair[notebook]; without it nothing is tested.
import { spawn } from "node:child_process";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { expect, test } from "vitest";

import { launch } from "./site.ts";

const { JUPYTER } = process.env;

const CELLS = [
  'import midair\nview = midair.view(midair.Scene(midair.Array.preset("sonicsurface"), [[0, 0, 0.15], [0.03, 0, 0.15]]))\nview',
  "view.points = [[0.01, 0.02, 0.14]]\nprint('given', view.points.tolist())",
  "print('moved', view.points.tolist(), sorted(view.metrics))",
];

const notebook = {
  cells: CELLS.map((source, k) => ({ cell_type: "code", id: `c${k}`, metadata: {}, execution_count: null, outputs: [], source })),
  metadata: { kernelspec: { name: "python3", display_name: "Python 3", language: "python" } },
  nbformat: 4,
  nbformat_minor: 5,
};

test.skipIf(!JUPYTER)("the view in JupyterLab", { timeout: 240_000 }, async () => {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  await writeFile(join(folder, "view.ipynb"), JSON.stringify(notebook));
  const port = 20_000 + Math.floor(Math.random() * 20_000);
  const given = ["--no-browser", "--allow-root", "--ip=127.0.0.1", `--port=${port}`, "--IdentityProvider.token=", `--notebook-dir=${folder}`];
  const lab = spawn(JUPYTER!, given, { stdio: "ignore" });
  const url = `http://127.0.0.1:${port}/lab/tree/view.ipynb`;
  await expect.poll(() => fetch(url).then(({ ok }) => ok, () => false), { timeout: 60_000 }).toBe(true);
  const browser = await launch();
  const page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
  await page.goto(url);
  const cells = page.locator(".jp-CodeCell");
  const run = async (k: number) => {
    await cells.nth(k).locator(".cm-content").click();
    await page.keyboard.press("Shift+Enter");
  };
  await cells.nth(2).waitFor({ timeout: 90_000 });
  await run(0);
  const point = (n: number) => page.getByRole("button", { name: new RegExp(`^Point ${n}:`) });
  await point(2).waitFor({ timeout: 90_000 });
  await run(1);
  await expect.poll(() => point(1).getAttribute("aria-label"), { timeout: 30_000 }).toContain("x 10, y 20, z 140 mm");
  expect(await point(2).count()).toBe(0);
  await point(1).focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(2000);
  await run(2);
  await expect.poll(() => cells.nth(2).innerText(), { timeout: 30_000 }).toContain("moved [[0.011, 0.02, 0.14]]");
  await page.screenshot({ path: join(folder, "view.png"), timeout: 150_000 });
  console.log(join(folder, "view.png"));
  await browser.close();
  lab.kill();
});
