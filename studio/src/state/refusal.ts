/** Refusals: errors and warnings as values, with a code and the values of their sentence. */

/** Values of a sentence; a notice among them is translated, too. */
export type Put = Record<string, string | number | null | Notice>;

/** An error or a warning. `plain` is its English text without a place in a file and without an example. */
export interface Notice {
  /** A code of the core (docs/errors.md) or of the page, "" for any other error. */
  code: string;
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
