// The common part of a file's tests: a server for the built site, and a browser.
import { afterAll, beforeAll } from "vitest";

import { type Open, start } from "./site.ts";

/** Starts a browser and the site's server before a file's tests, and closes both after them. */
export function shared(...switches: string[]): Open {
  const open = {} as Open;
  beforeAll(async () => void Object.assign(open, await start(...switches)));
  afterAll(() => open.close?.());
  return open;
}
