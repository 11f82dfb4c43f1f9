/**
 * Runs the painter in a browser: node test/painter.browser.mjs [folder for pictures].
 * CHROMIUM names the browser, /usr/bin/chromium unless set.
 */

import assert from "node:assert/strict";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { build } from "vite";

const entry = fileURLToPath(new URL("painter.page.ts", import.meta.url));
const [bundle] = await build({
  configFile: false,
  logLevel: "warn",
  build: { write: false, minify: false, lib: { entry, formats: ["iife"], name: "page" } },
});
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
try {
  const page = await browser.newPage({ viewport: { width: 780, height: 820 } });
  page.on("console", (message) => console.log("page:", message.text()));
  page.on("pageerror", (error) => console.log("page:", error.message));
  await page.setContent("<!doctype html><body></body>");
  await page.addScriptTag({ content: bundle.output[0].code });
  // A map's colour is a byte, and so is its place between two entries on some cards.
  for (const name of ["webgl", "flat"]) {
    const worst = await page.evaluate((name) => window.checks[name](), name);
    console.log(`${name}: painted slices differ from colour(look, |sample|) by at most ${worst.toFixed(2)} of 255`);
    assert.ok(worst <= 8);
  }
  assert.ok(await page.evaluate(() => window.checks.restored()), "after a lost context the slice differs");
  console.log("restored: as before");
  const folder = process.argv[2];
  const shots = {
    dark: {},
    light: { theme: "light" },
    above: { camera: { target: [0, 0, 0.05], yaw: -2.2, pitch: 0.9, distance: 0.75 }, look: { map: "magma", scale: "decibel", top: 7000 } },
    walls: {
      theme: "light",
      obstacles: [
        { point: [0, 0.19, 0], normal: [0, -1, 0], kind: "rigid" },
        { center: [0.02, -0.02, 0.13], radius: 0.015, kind: "rigid" },
        { center: [-0.06, -0.06, 0.05], radius: 0.02, kind: "soft" },
      ],
    },
  };
  for (const [name, changes] of Object.entries(shots)) {
    const time = () => page.evaluate((changes) => window.checks.scene(780, 820, changes), changes);
    await time();
    console.log(`${name}: ${(await time()).toFixed(0)} ms`);
    if (folder) await page.screenshot({ path: join(folder, `${name}.png`), timeout: 150000 });
  }
} finally {
  await browser.close();
}
