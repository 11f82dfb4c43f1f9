/** The page's modules, and those of npm, import only from lower layers, without cycles. Types, lazy imports and workers count. */

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join, posix } from "node:path";
import { expect, test } from "vitest";

const ROOT = join(import.meta.dirname, "../..");

/** The layers of folders, lowest first. Folders of one layer do not import each other. */
const LAYERS = [["studio/src/state"], ["studio/src/making", "studio/src/painter"], ["studio/src/solving"], ["studio/src/boards"], ["studio/src/app", "npm"]];

/** Matches every text that begins like the path of a module, in whatever statement it stands. */
const PATH = /(["'`])((?:\.{1,2}\/|\/src\/)[^"'`]*)\1/g;

/** For each file, the files that it imports. */
type Graph = Map<string, string[]>;

/** Returns the file that a path names, as the bundler finds it: with its ending, without, or with that of JavaScript. */
function resolved(file: string, path: string, sources: Map<string, string>): string {
  const plain = posix.join(path.startsWith("/") ? "studio" : posix.dirname(file), path.replace(/\?.*/, ""));
  const names = [plain, `${plain}.ts`, plain.replace(/\.js$/, ".ts"), `${plain}/index.ts`];
  const name = names.find((each) => sources.has(each)) ?? (/\.(css|json)$/.test(plain) && existsSync(join(ROOT, plain)) ? plain : undefined);
  // `make studio` builds the WebAssembly module.
  if (name === undefined && !plain.endsWith("/midair.wasm")) throw new Error(`${file} imports ${path}, which is no file`);
  return name ?? plain;
}

function graphOf(sources: Map<string, string>): Graph {
  const paths = (text: string) => [...text.matchAll(PATH)].map((match) => match[2]);
  return new Map([...sources].map(([file, text]) => [file, paths(text).map((path) => resolved(file, path, sources)).filter((other) => sources.has(other))]));
}

/** Returns the import cycles, one for each file that closes a cycle. */
function circles(graph: Graph): string[] {
  const closed: string[] = [];
  const done = new Set<string>();
  const visit = (file: string, path: string[]): void => {
    if (path.includes(file)) closed.push([...path.slice(path.indexOf(file)), file].join(" -> "));
    if (path.includes(file) || done.has(file)) return;
    for (const other of graph.get(file) ?? []) visit(other, [...path, file]);
    done.add(file);
  };
  for (const file of graph.keys()) visit(file, []);
  return closed;
}

function layerOf(folder: string): number {
  const layer = LAYERS.findIndex((folders) => folders.includes(folder));
  if (layer < 0) throw new Error(`${folder} has no layer: name it in LAYERS of studio/test/layers.test.ts`);
  return layer;
}

function upward(graph: Graph): string[] {
  const pairs = [...graph].flatMap(([file, others]) => others.map((other) => [file, other]));
  return pairs
    .filter(([file, other]) => posix.dirname(file) !== posix.dirname(other) && layerOf(posix.dirname(file)) <= layerOf(posix.dirname(other)))
    .map(([file, other]) => `${file} imports ${other}`);
}

const files = LAYERS.flat().flatMap((folder) => readdirSync(join(ROOT, folder)).map((name) => `${folder}/${name}`));
const sources = new Map(files.filter((file) => file.endsWith(".ts")).map((file) => [file, readFileSync(join(ROOT, file), "utf8")]));
const pasted = (file: string, line: string): Graph => graphOf(new Map(sources).set(file, `${line}\n${sources.get(file)}`));

test("every folder has a layer", () => {
  const folders = readdirSync(join(ROOT, "studio/src")).map((name) => `studio/src/${name}`);
  expect(LAYERS.flat().sort()).toEqual([...folders, "npm"].sort());
});

test("no module imports one that imports it", () => {
  expect(circles(graphOf(sources))).toEqual([]);
});

test("no module imports one of a higher layer, or of another folder of its layer", () => {
  expect(upward(graphOf(sources))).toEqual([]);
});

const FORMS = [
  'import { createPanels } from "PATH";',
  'import type { Panels } from "PATH";',
  'import {\n  type Panels,\n} from "PATH";',
  'import "PATH";',
  'import /* late */ "PATH";',
  'export * from "PATH";',
  'const late = await import("PATH");',
  "const late = await import(`PATH`);",
  "const late = await import('PATH');",
  'let late: import("PATH").Panels;',
  'const worker = new URL("PATH", import.meta.url);',
  "const worker = new Worker(new URL(`PATH`, import.meta.url));",
  'import late from "PATH?worker&inline";',
  'const all = import.meta.glob("PATH");',
];

test.each(FORMS.flatMap((form) => ["", ".ts", ".js"].map((ending) => [form, ending])))("the guards see %s with the ending '%s'", (form, ending) => {
  const line = (path: string) => form.replace("PATH", path + ending);
  // The panels import the controls of motion.
  expect(circles(pasted("studio/src/app/motion.ts", line("./panels")))).toEqual(["studio/src/app/panels.ts -> studio/src/app/motion.ts -> studio/src/app/panels.ts"]);
  expect(upward(pasted("studio/src/state/types.ts", line("../app/panels")))).toEqual(["studio/src/state/types.ts imports studio/src/app/panels.ts"]);
  expect(upward(pasted("studio/src/state/types.ts", line("/src/app/panels")))).toEqual(["studio/src/state/types.ts imports studio/src/app/panels.ts"]);
  expect(upward(pasted("studio/src/painter/gl.ts", line("../solving/door")))).toEqual(["studio/src/painter/gl.ts imports studio/src/solving/door.ts"]);
  expect(upward(pasted("npm/index.ts", line("../studio/src/app/dom")))).toEqual(["npm/index.ts imports studio/src/app/dom.ts"]);
  expect(circles(pasted("studio/src/solving/door.ts", line("../../../npm/index")))).not.toEqual([]);
});

test.each(['import "./panel";', "import(`./${name}.ts`);", 'import.meta.glob("./*.ts");', 'import("./" + name);', 'import "../app";'])("a path that names no file fails: %s", (line) => {
  expect(() => pasted("studio/src/app/motion.ts", line)).toThrow("which is no file");
});
