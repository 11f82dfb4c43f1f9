// Words: none is missing in either language, and both put in the same.
import { expect, test } from "vitest";

import { WORDS, say } from "../src/words.ts";

test.each(Object.entries(WORDS))("%s", (_, [english, japanese]) => {
  const names = (text: string) => [...text.matchAll(/\{\w+\}/g)].map(String).sort();
  expect(english.trim()).not.toBe("");
  expect(japanese.trim()).not.toBe("");
  expect(names(japanese)).toEqual(names(english));
});

test("what is put in stands there", () => {
  expect(say("ja", "point", { n: 2, x: 1, y: 2, z: 3 })).toBe("点 2: x 1、y 2、z 3 mm");
});
