// Builds the studio three times from one source into built/: the website (site/), one HTML file that works from a disk
// (studio.html) and the notebook widget (widget.mjs). Copies the files that the wheel contains into the package.
import { createHash } from "node:crypto";
import { cp, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";

import { build } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

const here = import.meta.dirname;
const out = `${here}/built`;

/** Adds the licence of gifenc, the only library in the page, to the file that contains it. */
const notice = `/*! gifenc: ${(await readFile(`${here}/node_modules/gifenc/LICENSE.md`, "utf8")).trim()} */\n`;
const licence = {
  name: "licence",
  generateBundle(_, bundle) {
    for (const chunk of Object.values(bundle)) if (chunk.moduleIds?.some((id) => id.includes("gifenc"))) chunk.code = notice + chunk.code;
  },
};

const common = { root: here, configFile: false, logLevel: "warn", worker: { format: "iife" }, plugins: [licence] };
const page = (outDir, more, plugins = []) =>
  build({ ...common, base: "./", plugins: [licence, ...plugins], build: { outDir, emptyOutDir: true, modulePreload: false, target: "es2022", ...more } });

/** Returns the page's Content-Security-Policy: only its own scripts, its own worker and its own files. */
const policy = (script, style, connect) =>
  `<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src ${script} 'wasm-unsafe-eval'; ` +
  `style-src ${style}; img-src 'self' data: blob:; connect-src ${connect}; worker-src 'self' blob:; base-uri 'none'; form-action 'none'" />`;
const withPolicy = (html, ...sources) => html.replace("<head>", `<head>\n    ${policy(...sources)}`);

// The wasm file keeps its name, because the notebook widget loads the same file.
const assetFileNames = ({ names }) => (names[0]?.endsWith(".wasm") ? "[name][extname]" : "assets/[name]-[hash][extname]");
await page(`${out}/site`, { assetsInlineLimit: 0, rolldownOptions: { output: { assetFileNames } } });
const index = `${out}/site/index.html`;
const preload = '  <link rel="preload" href="./midair.wasm" as="fetch" crossorigin />\n  </head>';
await writeFile(index, withPolicy(await readFile(index, "utf8"), "'self'", "'self'", "'self'").replace("</head>", preload));

// The files that the service worker stores for use without a network.
const kept = ["./", "midair.wasm", ...(await readdir(`${out}/site/assets`)).map((name) => `assets/${name}`)];
const version = createHash("sha256").update(await readFile(index)).update(await readFile(`${out}/site/midair.wasm`)).digest("hex").slice(0, 12);
const worker = (await readFile(`${here}/sw.js`, "utf8")).replace("VERSION", version).replace("FILES = []", `FILES = ${JSON.stringify(kept)}`);
await writeFile(`${out}/site/sw.js`, worker);

await page(`${out}/single`, { assetsInlineLimit: 1e9 }, [viteSingleFile()]);
const html = await readFile(`${out}/single/index.html`, "utf8");
const script = html.match(/<script type="module"[^>]*>([\s\S]*?)<\/script>/)[1];
const hash = createHash("sha256").update(script).digest("base64");
await writeFile(`${out}/studio.html`, withPolicy(html, `'sha256-${hash}'`, "'unsafe-inline'", "data:"));
await rm(`${out}/single`, { recursive: true });

await build({
  ...common,
  build: {
    outDir: `${out}/widget`,
    emptyOutDir: true,
    target: "es2022",
    lib: { entry: `${here}/src/app/widget.ts`, formats: ["es"], fileName: () => "widget.mjs" },
  },
});
await cp(`${out}/widget/widget.mjs`, `${out}/widget.mjs`);
await rm(`${out}/widget`, { recursive: true });

const shipped = `${here}/../python/midair/_studio/built`;
await rm(shipped, { recursive: true, force: true });
await mkdir(shipped, { recursive: true });
await cp(`${out}/site`, shipped, { recursive: true });
await cp(`${out}/widget.mjs`, `${shipped}/widget.mjs`);

const kilobytes = async (...files) =>
  ((await Promise.all(files.map(async (file) => gzipSync(await readFile(file), { level: 9 }).length))).reduce((a, b) => a + b) / 1000).toFixed(1);
const assets = (await readdir(`${out}/site/assets`)).filter((name) => !name.endsWith(".jpeg")).map((name) => `${out}/site/assets/${name}`);
console.log(`page code and style: ${await kilobytes(...assets)} kB gzip`);
for (const file of ["midair.wasm", "widget.mjs", "studio.html"]) {
  console.log(`${file}: ${await kilobytes(`${out}/${file}`)} kB gzip`);
}
