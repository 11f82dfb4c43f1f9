// Error messages as the page shows them: without positions in files and examples; the most common are in Japanese on the
// Japanese page.
import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { compile, Door } from "../src/work/door.ts";
import { plain, report } from "../src/app/refusals.ts";

const door = new Door(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));

/** Returns the core's messages about points over an array. */
function said(points: object[], more: object = {}): string {
  try {
    door.open(JSON.stringify({ array: { preset: "sonicsurface" }, points, solver: { name: "uniform" }, ...more }));
    return door.solve().said.join("\n");
  } catch (error) {
    return (error as Error).message;
  }
}

const here = { position: [0.03, 0, 0.15] };
const obstacles = (each: object) => ({ obstacles: [{ ...each, kind: "rigid" }] });

test.each([
  [[{ position: [0, 0, -0.05] }], {}, /^point 1 is reached by no transducer/, /^点 1 に音が届き/],
  [[here, { position: [0, 0, 0.15] }], obstacles({ center: [0, 0, 0.15], radius: 0.02 }), /^point 2\.position is .*: inside the sphere/, /^点 2 は障害物の中/],
  [[here], obstacles({ center: [0, 0, 0.01], radius: 0.02 }), /^obstacles\[0\] is a sphere/, /^障害物がアレイに/],
  [[here], obstacles({ point: [0, 0, 0.1], normal: [0, 0, 1] }), /^point 1\.position is .*: behind the wall/, /^点 1 は障害物の中か裏/],
  [[here], obstacles({ point: [0.02, 0, 0.1], normal: [1, 0, 0] }), /^obstacles\[0\] is a wall/, /^障害物がアレイに/],
  [[{ ...here, pressure: 0 }], {}, /^pressures is all 0/, /^すべての点が 0 Pa/],
  [[{ ...here, pressure: 1e6 }], {}, /^point 1\.pressure is 1000000 Pa, beyond reach/, /^点 1 の音圧.*\d Pa です$/m],
  [[{ ...here, pressure: 100 }], {}, /scale all drives by 0\.\d+/, /全体の出力を 0\.\d+ 倍/],
  [[{ position: [0, 0, 300] }], {}, /^point 1\.position is .*bring it within/, /^点 1 はアレイから遠すぎます/],
  [[here, { position: [-0.03, 0, 0.15] }].map((each) => ({ ...each, pressure: 2400 })), {}, /^the pressures are missed by/, /^目標音圧からのずれが \d/],
  [[{ ...here, pressure: 20e3 }], { array: { preset: "autd3", tiles: [4, 4] } }, /^at 20\.0 kPa the second harmonic/, /^20\.0 kPa では、/],
  [[here], { obstacles: [0.06, 0.12].map((z) => ({ center: [0, 0, z], radius: 0.02, kind: "rigid" })) }, /^obstacles\[0\] is a sphere among/, /^球はほかの障害物と/],
  [[here], obstacles({ center: [1, 0, 0.1], radius: 0.8 }), /^obstacles\[0\]\.radius is/, /^球が大きすぎます: 半径は [\d.]+ m 以下/],
])("%j %j", (points, more, english, japanese) => {
  const line = said(points, more);
  expect(plain("en", line)).toMatch(english);
  expect(plain("en", line)).not.toMatch(/scene file|for example|points\[/);
  expect(plain("ja", line)).toMatch(japanese);
  expect(plain("ja", line)).not.toMatch(/[a-z]{4}/);
});

test("other lines stay as they are", () => {
  expect(plain("ja", "steps is 0: give at least 1")).toBe("steps is 0: give at least 1");
});

const MESSAGES = `${import.meta.dirname}/../src`;

/** The source file of a message, a part of it as written there, the message, and its beginning in Japanese. */
test.each([
  ["app/exchange.ts", "give .toml, .json", "a.txt: give .toml, .json, .csv, .svg, .png or .jpg", "a.txt: 開けるファイルは .toml"],
  ["state/scene_file.ts", "at most ${most}", "points is 80: the page has at most 64, use the package", "点が 80 個あります: "],
  ["state/scene_file.ts", "the page has ${", "motion is {}: the page has no place for it, use the package", "motion ({}) はこのページでは"],
  ["work/door.ts", "rows: give at most", "a.csv: 9000 rows: give at most 4096", "a.csv: 振動子が 9000 個あります: 4096 個"],
  ["making/drawing.ts", "is larger than 2 MB", "the drawing is larger than 2 MB: give an SVG file", "図形が大きすぎます: 2 MB 以下"],
  ["making/drawing.ts", "elements", "the drawing has more than 500 elements: give an SVG", "図形の要素が多すぎます: 500 個以下"],
  ["making/drawing.ts", "cannot be read", "a.svg: the drawing cannot be read: give an SVG", "a.svg: SVG として読めません"],
  ["making/drawing.ts", "has a script or", "the drawing has a script or a page in it: give an SVG", "SVG にスクリプト"],
  ["making/drawing.ts", "has no lines", "the drawing has no lines: give an SVG", "図形に線がありません"],
  ["making/pixels.ts", "it cannot be read as a picture: ", "a.png: it cannot be read as a picture: give a PNG or JPEG", "a.png: 画像として読めません"],
  ["making/pixels.ts", "it is dark everywhere (", "it is dark everywhere (black or transparent): give white on black", "画像に明るいところがありません"],
  ["making/lettering.ts", 'the text has "', 'the text has "~": give A to Z', "「~」は描けません"],
  ["making/lettering.ts", "the text is empty: ", "the text is empty: give at least a letter", "文字がありません"],
  ["state/link.ts", 'the link has a broken "%": ', 'the link has a broken "%": copy it once more', "リンクが壊れています"],
  ["app/recording.ts", "this browser records no WebM: ", "this browser records no WebM: choose GIF", "このブラウザでは WebM に"],
  ["work/door.ts", "this browser cannot run midair (", "this browser cannot run midair (x): WebAssembly with SIMD is needed", "このブラウザでは midair を"],
  ["boards/serial.ts", "cannot be opened (", "the port of sonicsurface cannot be opened (x): plug the board in", "sonicsurface のポートを開けません (x): "],
  ["boards/serial.ts", "it was unplugged", "the port of sonicsurface is gone (it was unplugged): the board was turned off, connect again", "sonicsurface との接続が切れました (取り外されました): ボードは停止しました"],
  ["boards/serial.ts", "it takes nothing", "the port of sonicsurface is gone (it takes nothing): the board may still play, switch", "sonicsurface との接続が切れました (応答がありません): 出力が続いて"],
  ["boards/serial.ts", "cannot play this (", "sonicsurface cannot play this (x): it is off", "sonicsurface では出力できません (x): "],
])("%s: %s", (file, words, line, japanese) => {
  expect(readFileSync(`${MESSAGES}/${file}`, "utf8")).toContain(words);
  const shown = report("ja", "failed", { line });
  expect(shown.startsWith(`実行できません: ${japanese}`), shown).toBe(true);
  expect(report("en", "failed", { line })).toBe(`Did not work: ${line}`);
});
