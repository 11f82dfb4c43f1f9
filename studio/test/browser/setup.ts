// What the tests of a file share: the built site, served, and a browser.
import type { Browser } from "playwright-core";
import { afterAll, beforeAll } from "vitest";

import { built, launch, serve } from "./site.ts";

/** A browser and the site's address, there once a file's tests begin and gone when they end. */
export function shared(...switches: string[]): { browser: Browser; url: string } {
  const open = {} as { browser: Browser; url: string };
  let close = () => {};
  beforeAll(async () => {
    const site = await serve(`${built}/site`);
    close = site.close;
    open.url = site.url;
    open.browser = await launch(...switches);
  });
  afterAll(async () => {
    await open.browser?.close();
    close();
  });
  return open;
}
