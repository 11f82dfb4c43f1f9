/** Context: the functions that every part of the page uses. */

import type { Engine } from "./engine.ts";
import type { ServedBoard } from "./served.ts";
import type { Studio } from "./studio.ts";
import type { Language, Word } from "./words.ts";

/** The page's parts share it. */
export interface Context {
  engine: Engine;
  studio: Studio;
  language: Language;
  theme: "dark" | "light";
  /** The board of `midair studio --on`. */
  board: ServedBoard | null;
  say(word: Word, put?: Record<string, string | number>): string;
  /** A line of the core on a scene of the page. */
  plain(line: string): string;
  /** Says a text to users of screen readers. */
  announce(text: string): void;
  /** Shows one line about a fault. */
  alarm(text: string): void;
  /** Asks for a new picture. */
  repaint(): void;
  /** Hears of changes until the page ends. */
  listen(listener: () => void): void;
  /** Called when the page ends. */
  ending(act: () => void): void;
}

/** Millimetres as they are shown and typed. */
export const millimetres = (metres: number) => String(Math.round(metres * 1e5) / 100 + 0);
