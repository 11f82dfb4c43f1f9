/** Texts of the page, in English and Japanese. */

import words from "./words.json";

/** A language of the page. */
export type Language = "en" | "ja";

/** All texts as [English, Japanese]; {name} stands for a value. */
export const WORDS = words;

/** The name of a text. */
export type Word = keyof typeof WORDS;

/** Returns a text in a language, with its values. */
export function say(language: Language, word: Word, put: Record<string, string | number> = {}): string {
  const text: string = WORDS[word][language === "ja" ? 1 : 0];
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(put[name]));
}
