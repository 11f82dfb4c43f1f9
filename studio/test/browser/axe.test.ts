// Accessibility: axe finds nothing serious, in both themes and languages, wide and narrow, and in the gallery.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { shared } from "./setup.ts";
import { visit } from "./site.ts";

interface Axe {
  run(): Promise<{ violations: { id: string; impact: string; nodes: { html: string }[] }[] }>;
}

const open = shared();
const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What axe calls serious or critical. */
async function faults(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => (window as unknown as { axe: Axe }).axe.run());
  return violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" ")}`);
}

const cases = (["en-GB", "ja-JP"] as const).flatMap((locale) =>
  (["dark", "light"] as const).flatMap((colorScheme) =>
    [1440, 390].map((width) => ({ locale, colorScheme, width })),
  ),
);

test.each(cases)("$locale $colorScheme $width", async ({ locale, colorScheme, width }) => {
  const viewport = { width, height: width === 390 ? 844 : 900 };
  const { page, context } = await visit(open.browser, open.url, { locale, colorScheme, viewport });
  expect(await faults(page)).toEqual([]);
  if (width === 390) {
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    expect(over).toBeLessThanOrEqual(0);
    await page.getByRole("button", { name: /menu|メニュー/i }).click();
  }
  await page.getByRole("button", { name: /gallery/i }).click();
  expect(await faults(page)).toEqual([]);
  await context.close();
});
