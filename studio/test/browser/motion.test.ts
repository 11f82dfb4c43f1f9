// Motion: both methods frame by frame, with the frame's metrics; playing, stopping, seeking and recording.
import { readFile } from "node:fs/promises";

import type { Page } from "playwright-core";
import { beforeEach, expect, test } from "vitest";

import type { Vec3 } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { unfold, visit } from "./site.ts";

const open = shared();
const START = {
  array: { preset: "sonicsurface", tiles: [1, 1] as [number, number] },
  points: [[-0.02, 0, 0.15], [0.02, 0.01, 0.15]] as Vec3[],
  methods: ["greedy", "naive"] as [string, string],
  view: "slice" as const,
  level: "engineer" as const,
  path: { kind: "circle" as const, radius: 0.01, frequency: 4 },
};
let page: Page;
let complaints: string[];

beforeEach(async () => {
  await page?.context().close();
  ({ page, complaints } = await visit(open.browser, `${open.url}#v=1`));
  await page.evaluate((state) => window.midair!.set(state), START);
});

const summary = (slot: string) => page.getByRole("region", { name: `Method ${slot}` }).locator(".summary").innerText();
const row = (name: string) => page.getByRole("row", { name: new RegExp(`^${name}`) }).first().getByRole("cell").allInnerTexts();
const line = () => page.getByRole("slider", { name: "Frame" });

test("what moves right after a change moves, and the panes say whose numbers these are", async () => {
  await unfold(page, "Motion");
  await page.getByRole("button", { name: "Move", exact: true }).click();
  await expect.poll(() => summary("A"), { timeout: 60_000 }).toMatch(/^glide/);
  expect(await summary("B")).not.toContain("at rest");
  expect(await page.getByRole("table", { name: "Numbers" }).innerText()).not.toMatch(/Bound|Solve time/);
  expect(await page.getByRole("alert").innerText()).toBe("");
  await page.getByRole("button", { name: "Rest", exact: true }).click();
  await expect.poll(() => summary("A")).not.toMatch(/^glide/);
  expect(complaints).toEqual([]);
});

test("at each frame B's numbers are those of its method at that frame's points, and so is its field", async () => {
  await line().fill("60");
  await expect.poll(() => summary("A"), { timeout: 60_000 }).toMatch(/^glide/);
  await expect.poll(() => page.locator(".timeline output").innerText()).toBe("60 / 250 ms");
  const shown = await Promise.all(["Uniformity", "Weakest"].map(row));
  const angle = 2 * Math.PI * (60 / 250);
  const points = START.points.map(([x, y, z]): Vec3 => [x + 0.01 * Math.cos(angle), y + 0.01 * Math.sin(angle), z]);
  // The rings are at the points, once they are painted.
  const away = async () => {
    const [left, top] = await page.evaluate((place) => window.midair!.project(place), points[0]);
    const ring = (await page.getByRole("button", { name: /^Point 1:/ }).boundingBox())!;
    return Math.hypot(ring.x + ring.width / 2 - left, ring.y + ring.height / 2 - top);
  };
  await expect.poll(away).toBeLessThan(1);
  await page.evaluate((points) => window.midair!.set({ points, path: null }), points);
  await page.evaluate(() => window.midair!.settled());
  const there = await Promise.all(["Uniformity", "Weakest"].map(row));
  shown.forEach((cells, k) => expect(cells[1]).toBe(there[k][1]));
  // B (greedy) solves each frame anew, so its values are those of points at rest. A (glide) continues from frame to frame.
  expect(shown[1][0]).toMatch(/Pa$/);
});

test("the time line plays, stops where it is, and is moved by keys", async () => {
  const group = page.getByRole("group", { name: "Motion" });
  await group.getByRole("button", { name: "Play" }).click();
  await expect.poll(async () => Number(await line().inputValue()), { timeout: 60_000 }).toBeGreaterThan(4);
  await group.getByRole("button", { name: "Pause" }).click();
  await page.waitForTimeout(400);
  const at = await line().inputValue();
  await page.waitForTimeout(600);
  expect(await line().inputValue()).toBe(at);
  await line().focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(() => page.locator(".timeline output").innerText()).toBe(`${Number(at) + 1} / 250 ms`);
  await page.evaluate(() => window.midair!.set({ path: null }));
  await expect.poll(() => line().isVisible()).toBe(false);
});

test.each([["WebM", "1a45dfa3"], ["GIF", "47494638"]])("one turn is filmed as %s", async (kind, begins) => {
  await page.evaluate(() => window.midair!.set({ path: { kind: "circle", radius: 0.01, frequency: 50 } }));
  const [file] = await Promise.all([page.waitForEvent("download", { timeout: 90_000 }), page.getByRole("button", { name: `Record one turn as a film (${kind})` }).click()]);
  const film = await readFile((await file.path())!);
  expect(file.suggestedFilename()).toBe(`midair.${kind.toLowerCase()}`);
  expect(film.subarray(0, 4).toString("hex")).toBe(begins);
  expect(film.length).toBeGreaterThan(2000);
  expect(complaints).toEqual([]);
});

test("beads in moving traps are simulated, and the panel says which stay", async () => {
  const traps = { array: { preset: "openmpd_pair", tiles: [1, 1] as [number, number] }, quantization: "none" as const, signature: "trap" as const, points: [[-0.02, 0, 0], [0.02, 0, 0]] as Vec3[] };
  await page.evaluate((state) => window.midair!.set(state), { ...traps, path: { kind: "circle" as const, radius: 0.005, frequency: 10 } });
  await unfold(page, "Motion");
  await line().fill("4");
  await expect.poll(() => page.getByText(/^All beads stay, at most 0\.\d\d mm from their points$/).count(), { timeout: 60_000 }).toBe(1);
  await page.evaluate(() => window.midair!.set({ path: { kind: "circle", radius: 0.05, frequency: 30 } }));
  await line().fill("4");
  await expect.poll(() => page.getByText(/^Bead [12] is lost after \d+ ms$/).count(), { timeout: 60_000 }).toBeGreaterThan(0);
  expect(complaints).toEqual([]);
});

test("a drive that comes by file has its own field and numbers beside B's", async () => {
  await page.evaluate(() => window.midair!.set({ path: null }));
  await page.evaluate(() => window.midair!.settled());
  const [a, b] = await row("Weakest");
  const drive = await page.evaluate(() => window.midair!.drive(0));
  const half = ["index,x,y,z,amplitude,phase", ...drive.map(([re, im], k) => `${k},0,0,0,${Math.hypot(re, im) / 2},${Math.atan2(im, re)}`)].join("\n");
  await page.evaluate((text) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], "half.csv"));
    document.querySelector("main")!.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, half);
  await expect.poll(() => summary("A")).toContain("half.csv");
  const pascals = (text: string) => Number.parseFloat(text) * (text.includes("kPa") ? 1000 : 1);
  const [halved, same] = await row("Weakest");
  expect(pascals(halved) / pascals(a)).toBeCloseTo(0.5, 1);
  expect(same).toBe(b);
  await page.evaluate(() => window.midair!.set({ methods: ["greedy", "uniform"] }));
  await expect.poll(() => summary("A")).not.toContain("half.csv");
});

test("a path moves a skin: its felt strength, its motion, and back to |p|", async () => {
  const path = { kind: "circle" as const, radius: 0.02, frequency: 56 };
  await page.evaluate((state) => window.midair!.set(state), { array: { preset: "autd3", tiles: [1, 1] as [number, number] }, points: [[0, 0, 0.15]] as Vec3[], path });
  await page.evaluate(() => window.midair!.settled());
  const quantity = (name: string) => page.getByRole("group", { name: "What the slices show" }).getByRole("button", { name, exact: true });
  const touch = () => page.evaluate(() => window.midair!.state().touch as { level: number; width: number; peak: number } | null);
  await quantity("Vibration").click();
  await expect.poll(touch, { timeout: 60_000 }).not.toBeNull();
  const { level, width } = (await touch())!;
  // By midair.skin, of a focus in each frame.
  expect(Math.abs(level - 31.25)).toBeLessThan(0.1);
  expect(await summary("A")).toBe(`glide: Strongest ${Math.round(level)} dB above threshold; half as strong within ${Math.round(1000 * width)} mm`);
  expect(await page.evaluate(() => window.midair!.state().plane)).toEqual({ axis: "z", z: 0.15, size: 0.08, center: [0, 0] });
  const ticks = () => page.locator(".ticks").first().innerText();
  expect(await ticks()).toMatch(/20 dB/);
  await quantity("Pressure").click();
  await expect.poll(() => summary("A")).toMatch(/^glide: Felt as a steady push of \d+ mN/);
  expect(await ticks()).toMatch(/\d Pa/);
  await quantity("Skin").click();
  await expect.poll(ticks, { timeout: 60_000 }).toMatch(/\d µm/);
  await quantity("|p|").click();
  await expect.poll(() => summary("A")).not.toMatch(/^glide/);
  expect(await touch()).toBeNull();
  // A frame that was sought stays.
  await quantity("Skin").click();
  await line().fill("100");
  await expect.poll(() => page.locator(".timeline output").innerText()).toBe("5 / 18 ms");
  await expect.poll(touch).toMatchObject({ level, width });
  await quantity("|p|").click();
  await expect.poll(() => summary("A")).toMatch(/^glide [\d.]+ kPa/);
  await expect.poll(touch).toBeNull();
  expect(await page.getByRole("alert").innerText()).toBe("");
  expect(complaints).toEqual([]);
});

test("a skin without a path, on too wide a slice or under slow points is refused in one line", async () => {
  await page.evaluate(() => window.midair!.set({ quantity: "felt", plane: { size: 0.4 } }));
  await expect.poll(() => page.getByRole("alert").innerText(), { timeout: 60_000 }).toMatch(/^Did not work: The slice is too wide for a skin: make it at most \d+ mm wide/);
  await page.evaluate(() => window.midair!.set({ quantity: "felt", plane: { size: 0.1 }, path: { kind: "circle", radius: 0.01, frequency: 0.5 } }));
  await expect.poll(() => page.getByRole("alert").innerText(), { timeout: 60_000 }).toMatch(/^Did not work: The points are too slow for a skin/);
  await page.evaluate(() => window.midair!.set({ quantity: "skin", path: null }));
  await expect.poll(() => page.getByRole("alert").innerText()).toMatch(/^Did not work: A skin needs points that move again and again/);
  expect(await page.evaluate(() => window.midair!.state().quantity)).toBe("modulus");
  await expect.poll(() => page.getByRole("button", { name: "Vibration", exact: true }).isVisible()).toBe(false);
});
