// The common part of a file's tests: the built site, served, and a browser.
import { afterAll, beforeAll } from "vitest";

import { type Open, start } from "./site.ts";

/** A browser and the site's address, there once a file's tests begin and gone when they end. */
export function shared(...switches: string[]): Open {
  const open = {} as Open;
  beforeAll(async () => void Object.assign(open, await start(...switches)));
  afterAll(() => open.close?.());
  return open;
}
