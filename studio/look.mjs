// Checks the built book in a browser: node studio/look.mjs SITE [FOLDER for pictures]. Fails on serious faults of axe, requests
// to other hosts, missing files, and pages that are wider than a phone.
import { mkdir, readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";

import { withSite } from "./with_site.mjs";

const axe = await readFile(fileURLToPath(import.meta.resolve("axe-core/axe.min.js")), "utf8");
const [folder, pictures] = process.argv.slice(2);
const PAGES = process.env.PAGES?.split(",") ?? [
  "index", "gallery", "gallery/smiley", "conventions", "requests", "columns", "performance", "paper", "traps", "boards", "embedded", "sweeps", "why",
  "how-to-choose", "tutorials/first-focus", "reference/python/solving", "reference/command-line", "ja/index",
];
const VIEWS = [
  { colorScheme: "light", viewport: { width: 390, height: 844 } },
  { colorScheme: "dark", viewport: { width: 1280, height: 800 } },
];

if (pictures) await mkdir(pictures, { recursive: true });
let faults = 0;
const fault = (line) => console.log(line, (faults += 1) ? "" : "");

await withSite(async ({ serve, browser }) => {
  const site = await serve(folder, false);
  for (const view of VIEWS) {
    const context = await browser.newContext(view);
    for (const name of PAGES) {
      const page = await context.newPage();
      const where = `${name} ${view.viewport.width} ${view.colorScheme}`;
      page.on("request", (request) => /^(data|blob):/.test(request.url()) || request.url().startsWith(site.url) || fault(`${where}: asks ${request.url()}`));
      page.on("response", (response) => response.status() >= 400 && fault(`${where}: ${response.status()} ${response.url()}`));
      page.on("pageerror", (error) => fault(`${where}: ${error.message}`));
      await page.goto(`${site.url}${name}.html`);
      if (await page.locator(".live").count()) {
        await page.locator(".live").scrollIntoViewIfNeeded();
        if (await page.locator(".try").count()) await page.locator(".try").click();
        await page.locator(".live-on").waitFor({ timeout: 60_000 }).catch(() => fault(`${where}: no live cell`));
      }
      await page.waitForTimeout(500);
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run());
      for (const { id, impact, nodes } of violations) {
        if (impact === "serious" || impact === "critical") fault(`${where}: ${id}: ${nodes.slice(0, 3).map(({ html }) => html.slice(0, 160)).join(" | ")}`);
      }
      const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      if (over > 0) fault(`${where}: ${over} px wider than the window`);
      if (pictures) await page.screenshot({ path: `${pictures}/${name.replaceAll("/", "-")}-${view.viewport.width}.png`, fullPage: name !== "paper" && !name.startsWith("reference") });
      await page.close();
    }
    const page = await context.newPage();
    page.on("pageerror", (error) => fault(`studio ${view.viewport.width}: ${error.message}`));
    const studio = await page.goto(`${site.url}studio/index.html?scene=smiley`);
    if (studio.ok()) {
      await page.waitForFunction(() => window.midair, { timeout: 60_000 }).catch(() => fault("studio: no page"));
      const points = await page.evaluate(async () => (await window.midair.settled(), window.midair.state().points.length));
      if (points !== 37) fault(`studio: the scene of the address has ${points} points`);
    }
    await context.close();
  }
  site.close();
});
console.log(faults ? `${faults} faults` : `${PAGES.length} pages, no fault`);
process.exit(faults ? 1 : 0);
