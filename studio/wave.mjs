// Measures how many pictures per second an animated wave has: node wave.mjs [seconds]. A picture counts when it is painted,
// read back and different from the last one. So a wave that stands still counts no pictures, however often the screen is drawn.
import { each, spent, withSite } from "./with_site.mjs";

const seconds = Number(process.argv[2] ?? 5);

/** Runs in the page: returns, per second, the number of pictures that differ from the last one, and of drawn frames. */
function count(milliseconds) {
  const canvas = document.querySelector("canvas.canvas");
  const gl = canvas.getContext("webgl2");
  const pixels = new Uint8Array(4 * 96 * 96);
  const middle = (side) => Math.max(0, (side - 96) >> 1);
  return new Promise((done) => {
    let [pictures, drawn, begun, last] = [0, 0, 0, ""];
    // The page's own callback, which paints, ran before this one.
    const next = (now) => {
      begun ||= now;
      if (now - begun > milliseconds) return done([pictures, drawn].map((each) => (1000 * each) / (now - begun)));
      gl.readPixels(middle(canvas.width), middle(canvas.height), 96, 96, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      const seen = pixels.join();
      // A canvas that was not painted in this frame reads as zeros.
      pictures += seen !== last && pixels.some(Boolean);
      if (pixels.some(Boolean)) last = seen;
      drawn += 1;
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  });
}

const UPRIGHT = { axis: "y", z: 0.15, size: 0.2, center: [0, 0] };
const SCENES = [
  ["the first view", {}],
  ["sonicsurface, upright", { array: { preset: "sonicsurface", tiles: [1, 1] }, points: [[-0.03, 0, 0.15], [0.03, 0, 0.15]], plane: UPRIGHT, view: "slice", quantity: "wave" }],
  ["the same, three slices", { view: "planes" }],
  ["the same, compared", { level: "compare", view: "slice" }],
  ["the same, every control", { level: "engineer" }],
  ["autd3 2x2, every control", { array: { preset: "autd3", tiles: [2, 2] }, view: "slice" }],
];

await withSite(async ({ browser, url, visit }) => {
  // With reduced motion the wave would stand still.
  const { page } = await visit(browser, url, { reducedMotion: "no-preference" });
  // Waits until the animated hand has gone.
  await page.waitForTimeout(7000);
  for (const [name, state] of SCENES) {
    await page.evaluate((state) => window.midair.set({ ...state, quantity: "wave" }), state);
    await page.evaluate(() => window.midair.settled());
    await page.waitForTimeout(1000);
    const before = spent();
    const [rate, drawn] = await page.evaluate(count, 1000 * seconds);
    console.log(`${name}: ${rate.toFixed(1)} pictures a second (the screen is drawn ${drawn.toFixed(1)} times); ms of CPU each: ${each(before, rate * seconds)}`);
  }
});
process.exit(0);
