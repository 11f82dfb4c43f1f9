/** Notices: the English and Japanese sentences of errors and warnings, by their codes. */

// notices.json has, by code, the English sentence of the page's own notices and the Japanese sentence of all. The codes of the
// core, and their English sentences, are its own (docs/errors.md).

import sentences from "./notices.json";
import { type Notice, type Put, Refusal } from "./refusal.ts";

export { type Notice, type Put, Refusal } from "./refusal.ts";

/** A code of the core or of the page. */
export type Code = keyof typeof sentences;

/** Returns a sentence with its values; `shown` writes a notice among them. */
const filled = (sentence: string, put: Put, shown: (notice: Notice) => string) =>
  sentence.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = put[name];
    return typeof value === "object" && value ? shown(value) : String(value ?? "");
  });

/** Returns a notice of the page, about a file if it is given. */
export function notice(code: Code, put: Put = {}, place = ""): Notice {
  const plain = filled(sentences[code][0], put, ({ text }) => text);
  return { code, text: place ? `${place}: ${plain}` : plain, plain, place, put };
}

/** Throws a notice of the page. */
export function refuse(code: Code, put: Put = {}, place = ""): never {
  throw new Refusal(notice(code, put, place));
}

/** Returns the notice of any error; `place` is the file in which it was met, and is written before a place that lacks it. */
export function noticeOf(error: unknown, place = ""): Notice {
  const text = error instanceof Error ? error.message : String(error);
  const given: Notice = error instanceof Refusal ? error.notice : { code: "", text, plain: text, place: "", put: {} };
  if (given.place.startsWith(place)) return given;
  return { ...given, place: [place, given.place].filter(Boolean).join(": "), text: `${place}: ${given.text}` };
}

/** Returns the Japanese sentence of a notice, without its place; "" if it has none. */
export function japanese({ code, put }: Notice): string {
  return code && filled(sentences[code as Code][1], put, (other) => japanese(other) || other.plain);
}
