// How many pictures a second the wave has: node wave.mjs [seconds]. A picture counts once the GPU, or what stands for it, is done.
import { readdirSync, readFileSync } from "node:fs";

import { withSite } from "./with_site.mjs";

const seconds = Number(process.argv[2] ?? 5);

/** CPU time of the process that paints, in s; NaN where it cannot be known. */
function painting() {
  try {
    const pids = readdirSync("/proc").filter((name) => /^\d+$/.test(name));
    const pid = pids.find((each) => { try { return readFileSync(`/proc/${each}/cmdline`, "utf8").includes("--type=gpu-process"); } catch { return false; } });
    const cells = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
    return (Number(cells[11]) + Number(cells[12])) / 100;
  } catch {
    return NaN;
  }
}

/** Runs in the page: pictures that are done within so many ms. */
function count(milliseconds) {
  const gl = document.querySelector("canvas.canvas").getContext("webgl2");
  return new Promise((done) => {
    let [pictures, begun] = [0, 0];
    const next = (now) => {
      begun ||= now;
      if (now - begun > milliseconds) return done((1000 * pictures) / (now - begun));
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      const look = () => {
        if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return setTimeout(look, 1);
        pictures += 1;
        requestAnimationFrame(next);
      };
      look();
    };
    requestAnimationFrame(next);
  });
}

const UPRIGHT = { axis: "y", z: 0.15, size: 0.2, center: [0, 0] };
const SCENES = [
  ["the first view", {}],
  ["sonicsurface, upright", { array: { preset: "sonicsurface", tiles: [1, 1] }, points: [[-0.03, 0, 0.15], [0.03, 0, 0.15]], plane: UPRIGHT, view: "slice", quantity: "wave" }],
  ["the same, three slices", { view: "planes" }],
  ["the same, every control", { level: "engineer" }],
  ["autd3 2x2, every control", { array: { preset: "autd3", tiles: [2, 2] }, view: "slice" }],
];

await withSite(async ({ browser, url, visit }) => {
  const { page } = await visit(browser, url);
  for (const [name, state] of SCENES) {
    await page.evaluate((state) => window.midair.set({ ...state, quantity: "wave" }), state);
    await page.evaluate(() => window.midair.settled());
    await page.waitForTimeout(1000);
    const before = painting();
    const rate = await page.evaluate(count, 1000 * seconds);
    const spent = (1000 * (painting() - before)) / (rate * seconds);
    console.log(`${name}: ${rate.toFixed(1)} pictures a second, ${spent.toFixed(0)} ms of CPU each`);
  }
});
process.exit(0);
