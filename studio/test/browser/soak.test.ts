// After a minute of dragging, no memory, element, texture or worker is left over.
import { expect, test } from "vitest";

import { shared } from "./setup.ts";
import { grab, visit } from "./site.ts";

const open = shared("--js-flags=--expose-gc", "--enable-precise-memory-info");
const SECONDS = Number(process.env.SOAK ?? 60);

test("a minute of dragging", async () => {
  const { page, complaints } = await visit(open.browser, open.url);
  const drag = async (seconds: number) => {
    const [x, y] = await grab(page, 1);
    const end = Date.now() + 1000 * seconds;
    for (let k = 0; Date.now() < end; k += 1) await page.mouse.move(x + 30 * Math.sin(k / 9), y + 15 * Math.cos(k / 7));
    await page.mouse.move(x, y);
    await page.mouse.up();
    await page.evaluate(() => window.midair!.settled());
  };
  const measure = () =>
    page.evaluate(() => {
      (globalThis as unknown as { gc(): void }).gc();
      const { memory } = performance as unknown as { memory: { usedJSHeapSize: number } };
      return { heap: memory.usedJSHeapSize, elements: document.querySelectorAll("*").length };
    });
  await drag(5);
  const before = await measure();
  await drag(SECONDS);
  const after = await measure();
  console.log(`heap ${((after.heap - before.heap) / 1e6).toFixed(2)} MB more, ${page.workers().length} workers`);
  expect(after.heap - before.heap).toBeLessThan(2e6);
  expect(after.elements).toBe(before.elements);
  expect(page.workers()).toHaveLength(3);
  expect(complaints).toEqual([]);
}, 240_000);
