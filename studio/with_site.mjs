// The built site in a browser, for programs beside the tests.
import { readdirSync, readFileSync } from "node:fs";

import { createServer } from "vite";

/** Calls `act` with what test/browser/site.ts knows, the site and the browser open; closes them. */
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

/** CPU time of the browser's processes so far, in ms by their kind; nothing where there is no /proc. */
export function spent() {
  const all = new Map();
  try {
    for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
      try {
        const cells = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ").at(-1).split(" ");
        const kind = readFileSync(`/proc/${pid}/cmdline`, "utf8").match(/--type=([\w-]+)/)?.[1] ?? "browser";
        all.set(Number(pid), { parent: Number(cells[1]), ms: 10 * (Number(cells[11]) + Number(cells[12])), kind });
      } catch {
        // It has ended.
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

/** What was spent since `before` on each of so many pictures, by kind of process, in words. */
export function each(before, pictures) {
  const all = Object.entries(spent()).map(([kind, ms]) => [kind, (ms - (before[kind] ?? 0)) / pictures]);
  return all.filter(([, ms]) => ms >= 0.5).map(([kind, ms]) => `${kind} ${ms.toFixed(0)}`).join(", ");
}
