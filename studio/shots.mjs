// Pictures of the page to be looked at: node shots.mjs FOLDER [all]. Sizes, themes, languages, 64 points, a path
// and each gallery scene.
import { mkdir } from "node:fs/promises";

import { createServer } from "vite";

const server = await createServer({ root: import.meta.dirname, configFile: false, server: { port: 0 }, logLevel: "error" });
const { launch, serve, visit, built } = await server.ssrLoadModule("/test/browser/site.ts");
const [folder, all] = process.argv.slice(2);
await mkdir(folder, { recursive: true });
const site = await serve(`${built}/site`);
const browser = await launch();
const sizes = {
  wide: { width: 1440, height: 900 },
  narrow: { width: 390, height: 844 },
  ...(all && { huge: { width: 3840, height: 2160 } }),
};

async function shoot(name, options, act) {
  const { page, context, complaints } = await visit(browser, site.url, options);
  await act?.(page);
  await page.evaluate(() => window.midair.settled());
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${folder}/${name}.png`, fullPage: options.viewport.width < 900, timeout: 150_000 });
  if (complaints.length) console.log(name, complaints);
  await context.close();
}

for (const [size, viewport] of Object.entries(sizes)) {
  for (const colorScheme of ["dark", "light"]) {
    for (const locale of all ? ["en-GB", "ja-JP"] : ["en-GB"]) {
      await shoot(`${size}-${colorScheme}-${locale.slice(0, 2)}`, { viewport, colorScheme, locale });
    }
  }
}
/** As many points as the page takes, on a spiral. */
const many = Array.from({ length: 64 }, (_, k) => [0.008 * Math.sqrt(k) * Math.cos(2.4 * k), 0.008 * Math.sqrt(k) * Math.sin(2.4 * k), 0.18]);
for (const [size, viewport] of Object.entries(all ? sizes : {})) {
  await shoot(`${size}-64-points`, { viewport }, (page) => page.evaluate((points) => window.midair.set({ points }), many));
  await shoot(`${size}-path`, { viewport, locale: "ja-JP", colorScheme: size === "wide" ? "light" : "dark" }, async (page) => {
    await page.evaluate(() => window.midair.set({ view: "slice", path: { kind: "circle", radius: 0.01, frequency: 20 } }));
    await page.getByRole("button", { name: "動かす" }).click();
    await page.locator(".chart").waitFor({ timeout: 60_000 });
    await page.locator(".chart").scrollIntoViewIfNeeded();
    await page.getByRole("button", { name: "止める" }).click();
  });
}
await shoot("gallery", { viewport: sizes.wide }, (page) => page.getByRole("button", { name: "Gallery" }).click());
for (let k = 0; all && k < 8; k += 1) {
  await shoot(`gallery-${k + 1}`, { viewport: sizes.wide, colorScheme: k % 2 ? "light" : "dark" }, async (page) => {
    await page.getByRole("button", { name: "Gallery" }).click();
    await page.getByRole("dialog").getByRole("listitem").nth(k).getByRole("button").click();
  });
}
await browser.close();
site.close();
await server.close();
