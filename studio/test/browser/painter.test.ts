// The painter alone: slices have the colours that maps.ts computes, also after a lost context.
import { join } from "node:path";

import type { Page } from "playwright-core";
import { beforeAll, expect, test } from "vitest";
import { build } from "vite";

import type { checks } from "./painter.page.ts";
import { shared } from "./setup.ts";

const open = shared();
let page: Page;

beforeAll(async () => {
  const entry = join(import.meta.dirname, "painter.page.ts");
  const lib = { entry, formats: ["iife" as const], name: "page" };
  const [bundle] = (await build({ configFile: false, logLevel: "warn", build: { write: false, lib } })) as {
    output: { code: string }[];
  }[];
  page = await open.browser.newPage();
  await page.setContent("<!doctype html><body></body>");
  await page.addScriptTag({ content: bundle.output[0].code });
});

const run = (name: keyof typeof checks): Promise<number | boolean> =>
  page.evaluate(async (name: string) => (window as unknown as { checks: Record<string, () => number> }).checks[name](), name);

// The tolerance: colours are bytes, and some graphics cards also round the position between two entries of a map to a byte.
test.each(["webgl", "figure"] as const)("%s: slices are colour(look, sample)", async (name) => {
  expect(await run(name)).toBeLessThanOrEqual(8);
});

test("after a lost context the slice is as before", async () => {
  expect(await run("restored")).toBe(true);
});
