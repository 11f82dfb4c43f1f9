/** Errors and warnings of the core and of the page in the page's language. */

import { japanese, type Notice, type Put } from "../state/notice.ts";
import { type Language, type Word, say } from "./words.ts";

/** Returns a text of the page with its values; a notice among them is written in the page's language, with its place. */
export function report(language: Language, word: Word, put: Put = {}): string {
  const shown = (value: Put[string]) => (typeof value === "object" && value ? whole(language, value) : (value ?? ""));
  return say(language, word, Object.fromEntries(Object.entries(put).map(([name, value]) => [name, shown(value)])));
}

function whole(language: Language, notice: Notice): string {
  const sentence = language === "ja" ? japanese(notice) : "";
  return sentence ? [notice.place, sentence].filter(Boolean).join(": ") : notice.text;
}

/** Returns a notice without a place in a file and without an example, with points counted from 1, in the page's language. */
export function plain(language: Language, notice: Notice): string {
  const counted = (text: string) => text.replace(/points\[(\d+)\]/g, (_, k) => `point ${+k + 1}`);
  if (language === "en") return counted(notice.plain);
  return japanese(notice).replace(/points\[(\d+)\]/g, (_, k) => `点 ${+k + 1}`) || counted(notice.plain);
}
