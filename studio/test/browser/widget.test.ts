// The notebook widget with a simulated Jupyter model: both directions, and nothing remains when its cell runs again.
import { cp, mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { expect, test } from "vitest";

import { built, launch, point, serve } from "./site.ts";

interface Model {
  values: Record<string, unknown>;
  listeners: Record<string, () => void>;
}

const SCENE = {
  array: { preset: "sonicsurface" },
  points: [{ position: [0, 0, 0.15] }, { position: [0.03, 0, 0.15] }],
  solver: { name: "greedy" },
};

const PAGE = `<!doctype html><title>cell</title><div id="cell" style="height:600px"></div>
<script type="module">
  import widget from "./widget.mjs";
  window.run = async (scene) => {
    const wasm = new DataView(await (await fetch("midair.wasm")).arrayBuffer());
    const model = { values: { scene, wasm, state: "", metrics: {} }, listeners: {} };
    model.get = (name) => model.values[name];
    model.set = (name, value) => { model.values[name] = value; };
    model.save_changes = () => undefined;
    model.on = (event, act) => { model.listeners[event] = act; };
    model.off = (event) => { delete model.listeners[event]; };
    window.model = model;
    const el = document.createElement("div");
    document.getElementById("cell").replaceChildren(el);
    return widget.render({ model, el });
  };
  window.again = async (scene) => { await window.end?.(); window.end = await window.run(scene); };
</script>`;

test("a cell, ten times over", async () => {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  await cp(`${built}/widget.mjs`, join(folder, "widget.mjs"));
  await cp(`${built}/midair.wasm`, join(folder, "midair.wasm"));
  await writeFile(join(folder, "index.html"), PAGE);
  const site = await serve(folder, false);
  const browser = await launch();
  const page = await browser.newPage();
  const complaints: string[] = [];
  page.on("console", (message) => complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.goto(site.url);
  type Own = { model: Model; again(scene: string): Promise<void> };
  for (let k = 0; k < 10; k += 1) {
    await page.evaluate((scene) => (window as unknown as Own).again(scene), JSON.stringify(SCENE));
  }
  const metrics = () => page.evaluate(() => (window as unknown as Own).model.values.metrics as Record<string, { level: number }>);
  await expect.poll(async () => (await metrics()).greedy?.level, { timeout: 30_000 }).toBeGreaterThan(0.5);
  expect(page.workers()).toHaveLength(3);
  expect(complaints.filter((line) => /context|error/i.test(line))).toEqual([]);

  // Python sends a scene to the page, and then the page sends its scene to Python.
  await page.evaluate((scene) => {
    const { model } = window as unknown as Own;
    model.values.scene = scene;
    model.listeners["change:scene"]();
  }, JSON.stringify({ ...SCENE, points: [{ position: [0, 0.02, 0.12] }] }));
  const points = () =>
    page.evaluate(() => {
      const scene = JSON.parse((window as unknown as Own).model.values.state as string) as { points: { position: number[] }[] };
      return scene.points.map(({ position }) => position);
    });
  await expect.poll(points, { timeout: 20_000 }).toEqual([[0, 0.02, 0.12]]);
  await point(page, 1).focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(points, { timeout: 20_000 }).toEqual([[0.001, 0.02, 0.12]]);
  await browser.close();
  site.close();
});
