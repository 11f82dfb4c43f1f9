// Opens the built site in a browser, for programs besides the tests.
import { readdirSync, readFileSync } from "node:fs";

import { createServer } from "vite";

/** Calls `act` with the functions of test/browser/site.ts, the site and the browser; then closes both. */
export async function withSite(act) {
  const server = await createServer({ root: import.meta.dirname, configFile: false, server: { port: 0 }, logLevel: "error" });
  const site = await server.ssrLoadModule("/test/browser/site.ts");
  const open = await site.start();
  try {
    await act({ ...site, ...open });
  } finally {
    await open.close();
    await server.close();
  }
}

/** Returns the CPU time of the browser's processes so far, in ms by their kind; {} without /proc. */
export function spent() {
  const all = new Map();
  try {
    for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
      try {
        const cells = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ").at(-1).split(" ");
        const kind = readFileSync(`/proc/${pid}/cmdline`, "utf8").match(/--type=([\w-]+)/)?.[1] ?? "browser";
        all.set(Number(pid), { parent: Number(cells[1]), ms: 10 * (Number(cells[11]) + Number(cells[12])), kind });
      } catch {
        // The process has ended.
      }
    }
  } catch {
    return {};
  }
  const ours = (pid) => all.has(pid) && (all.get(pid).parent === process.pid || ours(all.get(pid).parent));
  const found = {};
  for (const [pid, { kind, ms }] of all) if (ours(pid)) found[kind] = (found[kind] ?? 0) + ms;
  return found;
}

/** Returns, as text, the CPU time per picture since `before`, by kind of process. */
export function each(before, pictures) {
  const all = Object.entries(spent()).map(([kind, ms]) => [kind, (ms - (before[kind] ?? 0)) / pictures]);
  return all.filter(([, ms]) => ms >= 0.5).map(([kind, ms]) => `${kind} ${ms.toFixed(0)}`).join(", ");
}
