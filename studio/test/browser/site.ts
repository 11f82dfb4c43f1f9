// The built site behind a local server with a strict policy, and a browser that opens it.
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { extname, join, normalize } from "node:path";

import { type Browser, type BrowserContextOptions, type Page, chromium } from "playwright-core";

import type { Hook } from "../../src/app/hook.ts";

declare global {
  interface Window {
    midair?: Hook;
  }
}

const here = import.meta.dirname;
export const built = join(here, "../../built");

const TYPES: Record<string, string> = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
};

const POLICY =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; " +
  "connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action 'none'";

/** Serves a folder, with the strict policy or none; returns the address, and a function that ends it. */
export async function serve(folder: string, strict = true): Promise<{ url: string; close(): void }> {
  const server = createServer(async (request, answer) => {
    const name = normalize(new URL(request.url!, "http://x").pathname);
    const file = join(folder, name.endsWith("/") ? `${name}index.html` : name);
    if (!existsSync(file)) return void answer.writeHead(404).end();
    const type = TYPES[extname(file)] ?? "application/octet-stream";
    const policy = strict ? { "Content-Security-Policy": POLICY } : {};
    answer.writeHead(200, { "Content-Type": type, ...policy }).end(await readFile(file));
  });
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  const { port } = server.address() as AddressInfo;
  return { url: `http://127.0.0.1:${port}/`, close: () => server.close() };
}

/** Starts a browser without a GPU, with further command-line switches. */
export function launch(...switches: string[]): Promise<Browser> {
  const place = process.env.CHROMIUM ?? "/usr/bin/chromium";
  if (!existsSync(place)) throw new Error(`${place} is missing: install chromium, or set CHROMIUM to where one is`);
  return chromium.launch({
    executablePath: place,
    args: [
      "--no-sandbox",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      ...switches,
    ],
  });
}

/** The served site and a browser, until they are closed. */
export interface Open {
  browser: Browser;
  url: string;
  close(): Promise<void>;
}

/** Serves the built site and starts a browser, with further command-line switches. */
export async function start(...switches: string[]): Promise<Open> {
  const [site, browser] = [await serve(`${built}/site`), await launch(...switches)];
  return {
    browser,
    url: site.url,
    async close() {
      await browser.close();
      site.close();
    },
  };
}

/** A link with all controls, seven points on a ring of 40 mm radius and one in its middle, 180 mm above four AUTD3 boards. */
export const EIGHT =
  "#v=1&h=engineer&a=autd3.2x2&m=uniform.naive&z=180,180&w=both&d=modulus&p=40,0,180_24.94,31.27,180_-8.9,39,180_-36.04,17.36,180_-36.04,-17.36,180_" +
  "-8.9,-39,180_24.94,-31.27,180_0,0,180";

/** Unfolds a group of controls. */
export const unfold = (page: Page, name: string) => page.locator("summary", { hasText: name }).click();

/** Clicks an entry of the bar's menu. */
export async function fromMenu(page: Page, name: string): Promise<void> {
  await page.getByRole("button", { name: "Menu" }).click();
  await page.getByRole("button", { name, exact: true }).click();
}

/**
 * Opens a page, waits until it is ready, and returns it with its requests and errors. `before` runs before the page's own
 * scripts.
 */
export async function visit(browser: Browser, url: string, options: BrowserContextOptions = {}, before?: () => void) {
  // Reduced motion prevents the animated hand that a page without a link shows at first.
  const reducedMotion = url.includes("#") ? "no-preference" : "reduce";
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, locale: "en-GB", reducedMotion, ...options });
  if (before) await context.addInitScript(before);
  const page = await context.newPage();
  const requests: string[] = [];
  const complaints: string[] = [];
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !message.text().includes("GPU stall")) {
      complaints.push(message.text());
    }
  });
  await page.goto(url);
  await ready(page);
  return { page, context, requests, complaints };
}

/** Waits for the first solutions. */
export async function ready(page: Page): Promise<void> {
  await page.waitForFunction(() => window.midair?.state().ready, undefined, { timeout: 60_000 });
  await page.evaluate(() => window.midair!.settled());
}

/** Returns the button of a point. */
export const point = (page: Page, n: number) => page.getByRole("button", { name: new RegExp(`^Point ${n}:`) });

/** Presses the mouse on a point; returns the middle of its button. */
export async function grab(page: Page, n: number): Promise<[number, number]> {
  await point(page, n).scrollIntoViewIfNeeded();
  const box = (await point(page, n).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  return [x, y];
}
