/** The page's modules import only from lower layers, without cycles. Types, lazy imports and workers count. */

import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";
import { expect, test } from "vitest";

const SOURCES = join(import.meta.dirname, "../src");

/** The layers, lowest first; a name that ends with / is a folder. */
const LAYERS = [
  ["types", "gifenc.d", "door", "words", "dom", "tips", "changes", "decimal", "numbering"],
  ["initial", "signature", "scene_file", "files", "link", "gallery", "history", "points", "paths", "plane", "touch", "contours", "lettering", "glyphs", "drawing", "pixels", "check"],
  ["solve.worker", "lattices", "engine", "studio", "skin", "serial", "served"],
  ["painter/", "eye", "look", "numbers"],
  [
    "context", "announce", "refusals", "chart", "beads", "recording", "player", "readout", "instrument", "viewing", "handles", "slicechoice", "phasekey", "stage", "compare", "exchange", "boardbutton", "gallerybox", "bar", "table", "arraypicker",
    "shaping", "motion", "panels", "sheet", "sentence", "ghost",
  ],
  ["page", "hook", "main", "widget"],
];

/**
 * Matches every way to name a module: `import ... from`, `import type`, `import "..."`, `export ... from`, `import("...")`,
 * `URL`.
 */
const IMPORT = /(?:\bfrom\s*|\bimport\s*\(?\s*|\bnew\s+URL\(\s*)["'](\.[^"'?]*)/g;

type Graph = Map<string, string[]>;

/** Returns the files that each file imports. */
function graphOf(sources: Map<string, string>): Graph {
  const graph: Graph = new Map();
  for (const [file, text] of sources) {
    const named = [...text.matchAll(IMPORT)].map((found) => relative(SOURCES, resolve(SOURCES, dirname(file), found[1])));
    graph.set(file, named.filter((other) => sources.has(other)));
  }
  return graph;
}

/** Returns the import cycles, one for each file that closes a cycle. */
function circles(graph: Graph): string[] {
  const found: string[] = [];
  const done = new Set<string>();
  const visit = (file: string, path: string[]): void => {
    if (path.includes(file)) found.push([...path.slice(path.indexOf(file)), file].join(" -> "));
    if (path.includes(file) || done.has(file)) return;
    for (const other of graph.get(file) ?? []) visit(other, [...path, file]);
    done.add(file);
  };
  for (const file of graph.keys()) visit(file, []);
  return found;
}

function layerOf(file: string): number {
  const layer = LAYERS.findIndex((names) => names.some((name) => file === `${name}.ts` || (name.endsWith("/") && file.startsWith(name))));
  if (layer < 0) throw new Error(`${file} has no layer: name it in LAYERS of studio/test/layers.test.ts`);
  return layer;
}

function upward(graph: Graph): string[] {
  const pairs = [...graph].flatMap(([file, others]) => others.map((other) => [file, other]));
  return pairs.filter(([file, other]) => layerOf(file) < layerOf(other)).map(([file, other]) => `${file} imports ${other}`);
}

const files = readdirSync(SOURCES, { recursive: true }).map(String).filter((file) => file.endsWith(".ts"));
const sources = new Map(files.map((file) => [file, readFileSync(join(SOURCES, file), "utf8")]));

test("no module imports one that imports it", () => {
  expect(circles(graphOf(sources))).toEqual([]);
});

test("no module imports one of a higher layer", () => {
  expect(upward(graphOf(sources))).toEqual([]);
});

test.each([
  'import { createPanels } from "./panels.ts";',
  'import type { Panels } from "./panels.ts";',
  'import {\n  type Panels,\n} from "./panels.ts";',
  'import "./panels.ts";',
  'export * from "./panels.ts";',
  'const late = await import("./panels.ts");',
  'const worker = new URL("./panels.ts", import.meta.url);',
  'import late from "./panels.ts?worker&inline";',
])("the guards see %s", (line) => {
  const pasted = (file: string): Graph => graphOf(new Map(sources).set(file, `${line}\n${sources.get(file)}`));
  // The panels import both files.
  expect(circles(pasted("motion.ts"))).toEqual(["panels.ts -> motion.ts -> panels.ts"]);
  expect(upward(pasted("dom.ts"))).toEqual(["dom.ts imports panels.ts"]);
});
