/** Words of the page, English and Japanese. */

import words from "./words.json";

/** A language of the page. */
export type Language = "en" | "ja";

/** Every text, [English, Japanese]; {name} stands for a value. */
export const WORDS = words;

/** A text's name. */
export type Word = keyof typeof WORDS;

/** A text in a language, with its values. */
export function say(language: Language, word: Word, put: Record<string, string | number> = {}): string {
  const text: string = WORDS[word][language === "ja" ? 1 : 0];
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(put[name]));
}
