// Accessibility: axe finds nothing serious in both themes and languages, at three sizes, in each level and in the gallery.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

import type { Page } from "playwright-core";
import { expect, test } from "vitest";

import { LEVELS } from "../../src/state/types.ts";
import { shared } from "./setup.ts";
import { visit } from "./site.ts";

interface Axe {
  run(): Promise<{ violations: { id: string; impact: string; nodes: { html: string }[] }[] }>;
}

const open = shared();
const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** Returns the faults that axe calls serious or critical. */
async function faults(page: Page): Promise<string[]> {
  const { violations } = await page.evaluate(() => (window as unknown as { axe: Axe }).axe.run());
  return violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" ")}`);
}

const SIZES = [
  { width: 1440, height: 900 },
  { width: 1024, height: 768 },
  { width: 390, height: 844 },
];
const cases = (["en-GB", "ja-JP"] as const).flatMap((locale) =>
  (["dark", "light"] as const).flatMap((colorScheme) => SIZES.map((viewport) => ({ locale, colorScheme, viewport }))),
);

test.each(cases)("$locale $colorScheme $viewport.width", async ({ locale, colorScheme, viewport }) => {
  const { page, context } = await visit(open.browser, open.url, { locale, colorScheme, viewport });
  await page.evaluate(axe);
  for (const level of LEVELS) {
    await page.evaluate((level) => window.midair!.set({ level, ear: [0, 0.1, 0.2] }), level);
    await page.evaluate(() => document.querySelectorAll("details").forEach((each) => (each.open = true)));
    expect([level, ...(await faults(page))]).toEqual([level]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
  }
  await page.getByRole("button", { name: /gallery|ギャラリー/i }).click();
  expect(await faults(page)).toEqual([]);
  await context.close();
});
