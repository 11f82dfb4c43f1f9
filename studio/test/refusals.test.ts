// Error messages as the page shows them: without positions in files and examples; the most common are in Japanese on the
// Japanese page.
import { readdirSync, readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { compile, Door } from "../src/solving/door.ts";
import { plain, report } from "../src/app/refusals.ts";
import { type Notice, notice, noticeOf, Refusal } from "../src/state/notice.ts";
import sentences from "../src/state/notices.json";

const door = new Door(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));

/** Returns the core's first notice about points over an array. */
function said(points: object[], more: object = {}): Notice {
  try {
    door.open(JSON.stringify({ array: { preset: "sonicsurface" }, points, solver: { name: "uniform" }, ...more }));
    return door.solve().said[0];
  } catch (error) {
    return noticeOf(error);
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
  const notice = said(points, more);
  expect(plain("en", notice)).toMatch(english);
  expect(plain("en", notice)).not.toMatch(/scene file|for example|points\[/);
  expect(plain("ja", notice)).toMatch(japanese);
  expect(plain("ja", notice)).not.toMatch(/[a-z]{4}/);
});

test("a notice without a code stays as it is", () => {
  expect(plain("ja", noticeOf("steps is 0: give at least 1"))).toBe("steps is 0: give at least 1");
});

test("the wording of a notice does not matter: its code and its values make the Japanese sentence", () => {
  const notice = said([{ ...here, pressure: 1e6 }]);
  const other = { ...notice, text: "other words", plain: "other words" };
  expect(plain("ja", other)).toBe(plain("ja", notice));
});

const table = Object.entries(sentences);

test("each code of the core, as docs/errors.md lists them, has a Japanese sentence, and no other English one", () => {
  const listed = [...readFileSync(`${import.meta.dirname}/../../docs/errors.md`, "utf8").matchAll(/^\| `([a-z-]+)` \|/gm)].map((match) => match[1]);
  expect(listed.length).toBeGreaterThan(30);
  expect(table.filter(([, [english]]) => !english).map(([code]) => code).toSorted()).toEqual(listed.toSorted());
  expect(table.filter(([, [, japanese]]) => !/[\u3040-\u30ff\u4e00-\u9fff]/.test(japanese))).toEqual([]);
});

test("both sentences of a notice have the same values, and each code of the page is used", () => {
  const values = (sentence: string) => new Set(sentence.match(/\{\w+\}/g));
  const source = readdirSync(`${import.meta.dirname}/../src`, { recursive: true, encoding: "utf8" })
    .filter((name) => name.endsWith(".ts"))
    .map((name) => readFileSync(`${import.meta.dirname}/../src/${name}`, "utf8"))
    .join("\n");
  for (const [code, [english, japanese]] of table.filter(([, [english]]) => english)) {
    expect([...values(japanese)].filter((value) => !values(english).has(value) && value !== "{point}"), code).toEqual([]);
    expect(source).toContain(`"${code}"`);
  }
});

test.each([
  [notice("file-kind"), "a.txt", "a.txt: 開けるファイルは .toml"],
  [notice("page-most", { item: "points", value: 80, other: 64 }), "", "points が 80 個あります: "],
  [notice("rows", { value: 9000, other: 4096 }), "a.csv", "a.csv: 振動子が 9000 個あります: 4096 個"],
  [notice("letter-unknown", { value: "~" }), "", "「~」は描けません"],
  [notice("port-gone", { item: "sonicsurface", value: notice("unplugged") }), "", "sonicsurface との接続が切れました (取り外されました): ボードは停止しました"],
  [notice("port-lost", { item: "sonicsurface", value: notice("stalled") }), "", "sonicsurface との接続が切れました (応答がありません): 出力が続いて"],
])("%j in %j", (each, place, japanese) => {
  const line = noticeOf(new Refusal(each), place);
  expect(report("ja", "failed", { line })).toContain(`実行できません: ${japanese}`);
  expect(report("en", "failed", { line })).toBe(`Did not work: ${[place, each.text].filter(Boolean).join(": ")}`);
});
