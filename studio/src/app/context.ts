/** Context: the objects and functions that every part of the page uses. */

import type { Engine } from "../work/engine.ts";
import type { ServedBoard } from "../boards/served.ts";
import type { Studio } from "../work/studio.ts";
import type { Language, Word } from "./words.ts";

/** The context that all parts of the page share. */
export interface Context {
  engine: Engine;
  studio: Studio;
  language: Language;
  theme: "dark" | "light";
  /** The board of `midair studio --on`, if there is one. */
  board: ServedBoard | null;
  say(word: Word, put?: Record<string, string | number>): string;
  /** Returns a message of the core in the words and the language of the page. */
  plain(line: string): string;
  /** Announces a text to users of screen readers. */
  announce(text: string): void;
  /** Shows one line about a fault. */
  alarm(text: string): void;
  /** Requests a new picture. */
  repaint(): void;
  /** Calls `listener` at each change, until the page ends. */
  listen(listener: () => void): void;
  /** Calls `act` when the page ends. */
  ending(act: () => void): void;
}

/** Formats a length in m as millimetres, with at most two decimals. */
export const millimetres = (metres: number) => String(Math.round(metres * 1e5) / 100 + 0);
