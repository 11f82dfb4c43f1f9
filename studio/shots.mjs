// Takes screenshots of the page for inspection: node shots.mjs FOLDER [all]. Takes each level in wide, medium and narrow
// windows, dark and light, and the posters in src/app/, which the page shows until it has drawn its first view. With `all`
// also a huge window, Japanese, 64 points, a path, and each gallery scene at each level.
import { mkdir } from "node:fs/promises";

import { withSite } from "./with_site.mjs";

const [folder, all] = process.argv.slice(2);
await mkdir(folder, { recursive: true });
const sizes = { wide: { width: 1440, height: 900 }, middle: { width: 1024, height: 768 }, narrow: { width: 390, height: 844 } };
const themes = ["dark", "light"];
const locales = all ? ["en-GB", "ja-JP"] : ["en-GB"];
/** As many points as the page allows, on a spiral. */
const many = Array.from({ length: 64 }, (_, k) => [0.008 * Math.sqrt(k) * Math.cos(2.4 * k), 0.008 * Math.sqrt(k) * Math.sin(2.4 * k), 0.18]);
const manners = Object.entries(sizes).flatMap(([size, viewport]) =>
  themes.flatMap((colorScheme) =>
    locales.map((locale) => [`${size}-${colorScheme}-${locale.slice(0, 2)}`, { viewport, colorScheme, locale }]),
  ),
);

/** Opens the gallery. If k is given, opens the gallery's scene number k. */
async function choose(page, k) {
  await page.getByRole("button", { name: /gallery|ギャラリー/i }).click();
  if (k === undefined) return;
  await page.getByRole("dialog").getByRole("listitem").nth(k).getByRole("button").click();
}

/** Plays a path, and stops it when its curves are shown. */
async function play(page) {
  await page.evaluate(() => window.midair.set({ level: "engineer", view: "slice", path: { kind: "circle", radius: 0.01, frequency: 20 } }));
  await page.evaluate(() => document.querySelectorAll("details").forEach((each) => (each.open = true)));
  const button = page.getByRole("button", { name: /^(Move|動かす)$/ });
  await button.click();
  await page.locator(".chart").waitFor({ timeout: 60_000 });
  await page.locator(".chart").scrollIntoViewIfNeeded();
  await page.getByRole("button", { name: /^(Rest|止める)$/ }).click();
}

await withSite(async ({ browser, url, visit }) => {
  async function shoot(name, options, act, kind = { type: "png" }) {
    const { page, context, complaints } = await visit(browser, url, options);
    await act?.(page);
    await page.evaluate(() => window.midair.settled());
    await page.waitForTimeout(600);
    await page.screenshot({ ...kind, path: `${folder}/${name}.${kind.type}`, timeout: 150_000 });
    if (complaints.length) console.log(name, complaints);
    await context.close();
  }

  for (const colorScheme of themes) await shoot(`poster-${colorScheme}`, { viewport: sizes.wide, colorScheme, deviceScaleFactor: 1 / 3 }, undefined, { type: "jpeg", quality: 50 });
  for (const [name, options] of manners) {
    for (const level of ["play", "compare", "engineer"]) await shoot(`${name}-${level}`, options, (page) => page.evaluate((level) => window.midair.set({ level }), level));
    await shoot(`${name}-gallery`, options, choose);
    if (!all) continue;
    await shoot(`${name}-64-points`, options, (page) => page.evaluate((points) => window.midair.set({ points }), many));
    await shoot(`${name}-path`, options, play);
    for (let k = 0; k < 10; k += 1) await shoot(`${name}-gallery-${k + 1}`, options, (page) => choose(page, k));
  }
  if (all) await shoot("huge", { viewport: { width: 3840, height: 2160 } });
});
