/** Notices: errors and warnings as values, with a code and the values of their sentence. */

// notices.json has, by code, the English sentence of the page's own notices and the Japanese sentence of all. The codes of the
// core, and their English sentences, are its own (docs/errors.md).

import sentences from "./notices.json";

/** A code of the core or of the page. */
export type Code = keyof typeof sentences;

/** Values of a sentence; a notice among them is translated, too. */
export type Put = Record<string, string | number | null | Notice>;

/** An error or a warning. `plain` is its English text without a place in a file and without an example. */
export interface Notice {
  code: Code | "";
  text: string;
  plain: string;
  /** The file and the line, or "". */
  place: string;
  put: Put;
}

/** An error that has a notice. */
export class Refusal extends Error {
  constructor(readonly notice: Notice) {
    super(notice.text);
  }
}

/** Returns a sentence with its values; `shown` writes a notice among them. */
const filled = (sentence: string, put: Put, shown: (notice: Notice) => string) =>
  sentence.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = put[name];
    return typeof value === "object" && value ? shown(value) : String(value ?? "");
  });

/** Returns a notice of the page. */
export function notice(code: Code, put: Put = {}): Notice {
  const text = filled(sentences[code][0], put, ({ text }) => text);
  return { code, text, plain: text, place: "", put };
}

/** Throws a notice of the page. */
export function refuse(code: Code, put: Put = {}): never {
  throw new Refusal(notice(code, put));
}

/** Returns the notice of any error; `place` is where it was met, unless it has a place of its own. */
export function noticeOf(error: unknown, place = ""): Notice {
  const text = error instanceof Error ? error.message : String(error);
  const given: Notice = error instanceof Refusal ? error.notice : { code: "", text, plain: text, place: "", put: {} };
  return place && !given.place ? { ...given, place, text: `${place}: ${given.text}` } : given;
}

/** Returns the Japanese sentence of a notice, without its place; "" if it has none. */
export function japanese({ code, put }: Notice): string {
  return code && filled(sentences[code][1], put, (other) => japanese(other) || other.plain);
}
