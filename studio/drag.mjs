// Measures how long a drag takes to show a new picture: node drag.mjs [moves]. Each pointer move waits for the picture of the
// move before. The time ends at the first frame after the upload of the slices, when the GPU (or the software renderer) has
// finished it.
import { each, spent, withSite } from "./with_site.mjs";

const moves = Number(process.argv[2] ?? 30);

/** Runs in the page before the page's own scripts: records when slices are uploaded and when the next frame is drawn. */
function watch() {
  const upload = WebGL2RenderingContext.prototype.texImage2D;
  let awaited = false;
  WebGL2RenderingContext.prototype.texImage2D = function (...given) {
    upload.apply(this, given);
    if (given[2] !== this.RG32F || awaited) return;
    awaited = true;
    const begun = performance.now();
    queueMicrotask(() => {
      const sent = performance.now();
      const fence = this.fenceSync(this.SYNC_GPU_COMMANDS_COMPLETE, 0);
      this.flush();
      const look = () => {
        if (this.getSyncParameter(fence, this.SYNC_STATUS) !== this.SIGNALED) return setTimeout(look, 1);
        const drawn = performance.now();
        requestAnimationFrame(() => {
          awaited = false;
          window.pictures.push({ begun, sent, drawn, seen: performance.now() });
        });
      };
      look();
    });
  };
  window.pictures = [];
  window.moves = [];
  addEventListener("pointermove", (event) => window.moves.push(event.timeStamp), true);
}

const median = (all) => all.toSorted((a, b) => a - b)[all.length >> 1].toFixed(0);

async function measure({ browser, url, visit, grab }, name, state) {
  const { page, context } = await visit(browser, url, {}, watch);
  if (state) await page.evaluate((state) => window.midair.set(state), state);
  await page.evaluate(() => window.midair.settled());
  await page.waitForTimeout(1000);
  const [x, y] = await grab(page, 1);
  await page.waitForTimeout(1500);
  const rows = [];
  const before = spent();
  for (let k = 1; k <= moves; k += 1) {
    await page.evaluate(() => void ((window.pictures.length = 0), (window.moves.length = 0)));
    await page.mouse.move(x + 30 * Math.sin(k), y + 15 * Math.cos(k));
    await page.waitForFunction(() => window.pictures.length > 0, undefined, { timeout: 20_000 });
    const { moved, picture } = await page.evaluate(() => ({ moved: window.moves[0], picture: window.pictures[0] }));
    rows.push(Object.fromEntries(Object.entries(picture).map(([key, at]) => [key, at - moved])));
    await page.waitForTimeout(200);
  }
  const cost = each(before, moves);
  await page.mouse.up();
  const of = (key) => median(rows.map((row) => row[key]));
  const least = Math.min(...rows.map((row) => row.seen));
  const late = rows.map((row) => row.seen).toSorted((a, b) => a - b).at(Math.ceil(0.9 * moves) - 1);
  console.log(
    `${name}: seen after ${of("seen")} ms (at best ${least.toFixed(0)}, 9 of 10 within ${late.toFixed(0)}); ` +
      `upload begins ${of("begun")}, painted by ${of("sent")}, drawn by ${of("drawn")}; ms of CPU each: ${cost}`,
  );
  await context.close();
}

/** Seven points on a ring of 40 mm radius and one in its middle, above four AUTD3 boards. */
const ring = Array.from({ length: 7 }, (_, k) => [0.04 * Math.cos((2 * Math.PI * k) / 7), 0.04 * Math.sin((2 * Math.PI * k) / 7), 0.18]);
const EIGHT = { level: "engineer", array: { preset: "autd3", tiles: [2, 2] }, points: [...ring, [0, 0, 0.18]], quantity: "modulus", view: "both" };

await withSite(async (open) => {
  await measure(open, "autd3 2x2, 8 points, both", EIGHT);
  await measure(open, "the same, slice", { ...EIGHT, view: "slice" });
  await measure(open, "sonicsurface, 1 point", { array: { preset: "sonicsurface", tiles: [1, 1] }, points: [[0, 0, 0.15]] });
});
