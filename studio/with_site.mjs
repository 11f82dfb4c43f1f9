// Opens the built site in a browser, for programs besides the tests.
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
