// Measures the time from the first requested byte to the first solutions, and to their pictures: node ready.mjs [visits]. Each
// visit uses a new browser, so that nothing is cached.
import { withSite } from "./with_site.mjs";

const visits = Number(process.argv[2] ?? 9);

/** Runs in the page before the page's own scripts: records when solutions are there, and when they are drawn. */
function watch() {
  const look = () => {
    if (!window.midair?.state().ready) return setTimeout(look, 5);
    const ready = performance.now();
    void window.midair.settled().then(() => requestAnimationFrame(() => requestAnimationFrame(() => (window.times = { ready, seen: performance.now() }))));
  };
  look();
}

await withSite(async ({ url, launch, visit }) => {
  const rows = [];
  for (let k = 0; k < visits; k += 1) {
    const browser = await launch();
    const { page } = await visit(browser, url, {}, watch);
    await page.waitForFunction(() => window.times, undefined, { timeout: 60_000 });
    rows.push(await page.evaluate(() => window.times));
    await browser.close();
  }
  const median = (key) => {
    const sorted = rows.map((row) => row[key]).toSorted((a, b) => a - b);
    return `${sorted[visits >> 1].toFixed(0)} ms (at most ${sorted.at(-1).toFixed(0)})`;
  };
  console.log(`ready after ${median("ready")}, all that is shown at first seen after ${median("seen")}; medians of ${visits} visits`);
});
