// The page works without a network after it was loaded once.
import { expect, test } from "vitest";

import { shared } from "./setup.ts";
import { ready, visit } from "./site.ts";

const open = shared();

test("once loaded the page works offline, with a link and a drag's answer", async () => {
  const { page, context } = await visit(open.browser, open.url);
  await page.evaluate(async () => void (await navigator.serviceWorker.ready));
  const kept = () => page.evaluate(async () => (await Promise.all((await caches.keys()).map(async (name) => (await (await caches.open(name)).keys()).length))).reduce((a, b) => a + b, 0));
  await expect.poll(kept, { timeout: 30_000 }).toBeGreaterThanOrEqual(4);
  await context.setOffline(true);
  await page.goto(`${open.url}#v=1&a=sonicsurface&p=0,0,140`);
  await page.reload();
  await ready(page);
  expect(await page.evaluate(() => window.midair!.state().points)).toEqual([[0, 0, 0.14]]);
  const before = await page.evaluate(() => window.midair!.drive(0)[0]);
  await page.evaluate(() => window.midair!.set({ points: [[0.02, 0, 0.12]] }));
  await page.evaluate(() => window.midair!.settled());
  expect(await page.evaluate(() => window.midair!.drive(0)[0])).not.toEqual(before);
  await context.close();
});
