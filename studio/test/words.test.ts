// Texts: none is missing in either language, and both contain the same values; Japanese texts have the glossary's terms.
// browser/looks.test.ts checks that no text is cut on the page.
import { readFileSync, readdirSync } from "node:fs";

import { expect, test } from "vitest";

import { gallery } from "../src/state/gallery.ts";
import { WORDS, say } from "../src/app/words.ts";

const SOURCES = `${import.meta.dirname}/../src`;
const read = (name: string) => readFileSync(`${SOURCES}/${name}`, "utf8");

test.each(Object.entries(WORDS))("%s", (_, [english, japanese]) => {
  const names = (text: string) => [...text.matchAll(/\{\w+\}/g)].map(String).sort();
  expect(english.trim()).not.toBe("");
  expect(japanese.trim()).not.toBe("");
  expect(names(japanese)).toEqual(names(english));
});

test("what is put in stands there", () => {
  expect(say("ja", "point", { n: 2, x: 1, y: 2, z: 3 })).toBe("点 2: x 1、y 2、z 3 mm");
});

test("no key is there twice, and each is used", () => {
  const keys = [...read("app/words.json").matchAll(/^ {2}"(\w+)":/gm)].map((found) => found[1]);
  expect(keys).toEqual([...new Set(keys)]);
  const files = readdirSync(SOURCES, { recursive: true }).map(String);
  const sources = files.filter((name) => name.endsWith(".ts")).map(read).join("\n");
  const spoken = new Set([...sources.matchAll(/["`](\w+)["`]|\b(\w+):/g)].map((found) => found[1] ?? found[2]));
  expect(keys.filter((key) => !spoken.has(key) && !spoken.has(key.replace(/Tip$/, "")))).toEqual([]);
});

/** Words that are not the terms of the glossary (docs/ja/glossary.md). */
const OTHERS = /解法|一様性|均一さ|基板|ばらつき σ|トランスデューサ|ユーザー|スピーカー|駆動(?!信号)/;

test("the glossary's terms, with a space between Japanese and Latin letters", () => {
  const texts = [...Object.values(WORDS), ...gallery.flatMap(({ name, line }) => [name, line])].map(([, japanese]) => japanese);
  expect(texts.filter((text) => OTHERS.test(text))).toEqual([]);
  expect(texts.filter((text) => /[ぁ-んァ-ヶ一-龠][A-Za-z]|[A-Za-z][ぁ-んァ-ヶ一-龠]/.test(text))).toEqual([]);
});
