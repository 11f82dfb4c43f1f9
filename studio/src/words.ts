/** Words of the page, English and Japanese. */

import words from "./words.json";

/** A language of the page. */
export type Language = "en" | "ja";

/** Every word, [English, Japanese]; {name} stands for what is put in. */
export const WORDS = words;

/** A word's name. */
export type Word = keyof typeof WORDS;

/** A word in a language, with what is put in. */
export function say(language: Language, word: Word, put: Record<string, string | number> = {}): string {
  const text: string = WORDS[word][language === "ja" ? 1 : 0];
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(put[name]));
}
