/** Context: the objects and functions that every part of the page uses, and the lines that it reports. */

import type { ServedBoard } from "../boards/served.ts";
import type { Theme } from "../state/types.ts";
import type { Engine } from "../solving/engine.ts";
import type { Studio } from "../solving/studio.ts";
import { element, write } from "./dom.ts";
import { plain, report } from "./refusals.ts";
import type { Language, Word } from "./words.ts";
import { type Notice, type Put } from "../state/notice.ts";

/** Announcements within this time, in ms, are made together. */
const GATHER = 250;

/** The time in ms for which a button says that it has copied. */
const COPIED = 2000;

/** The context that all parts of the page share. */
export class Context {
  /** The places of faults, and of announcements (an ARIA live region). */
  readonly alert = element("div", { className: "alert", role: "alert" });
  readonly status = element("div", { className: "hidden", role: "status", "aria-live": "polite" });
  private readonly endings: (() => void)[] = [];
  private announced: string[] = [];
  private timer = 0;

  /** `board` is that of `midair studio --on`, if there is one; `repaint` requests a new picture. */
  constructor(
    readonly engine: Engine,
    readonly studio: Studio,
    readonly language: Language,
    readonly theme: Theme,
    readonly board: ServedBoard | null,
    readonly repaint: () => void,
  ) {}

  readonly say = (word: Word, put?: Put) => report(this.language, word, put);

  /** Returns an error or a warning of a scene in the words and the language of the page. */
  readonly plain = (notice: Notice) => plain(this.language, notice);

  /** Announces a text to users of screen readers. */
  readonly announce = (text: string): void => {
    if (!this.announced.includes(text)) this.announced.push(text);
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      write(this.status, this.announced.join(". "));
      this.announced = [];
    }, GATHER);
  };

  /** Shows one line about a fault; "" removes it. */
  readonly alarm = (text: string): void => {
    const close = element("button", { className: "plain", "aria-label": this.say("close"), onclick: () => this.alarm("") }, "×");
    this.alert.replaceChildren(...(text ? [element("span", {}, text), close] : []));
  };

  /** Shows a dialog with a title; returns it. */
  dialog(className: string, title: string, ...children: HTMLElement[]): HTMLDialogElement {
    const close = element("button", { className: "icon", "aria-label": this.say("close"), onclick: () => dialog.close() }, "×");
    const dialog = element("dialog", { className, "aria-label": title }, element("header", {}, element("h2", {}, title), close), ...children);
    dialog.onclose = () => dialog.remove();
    (this.alert.closest(".studio") ?? document.body).append(dialog);
    dialog.showModal();
    return dialog;
  }

  /** Copies a text, and says so on the button for two seconds; shows the text in a field if the browser does not copy it. */
  async copy(button: HTMLElement, text: string): Promise<void> {
    const name = button.textContent!;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const field = element("textarea", { value: text, readOnly: true, rows: 6, "aria-label": name });
      this.dialog("about", name, field);
      return field.select();
    }
    this.announce(this.say("shared"));
    write(button, `✓ ${this.say("shared")}`);
    setTimeout(() => name.startsWith("✓") || write(button, name), COPIED);
  }

  /** Calls `listener` at each change, until the page ends. */
  readonly listen = (listener: () => void) => this.ending(this.studio.listen(listener));

  /** Calls `act` when the page ends. */
  readonly ending = (act: () => void) => void this.endings.push(act);

  /** Ends the page. */
  end(): void {
    this.endings.forEach((act) => act());
  }
}

/** Formats a length in m as millimetres, with at most two decimals. */
export const millimetres = (metres: number) => String(Math.round(metres * 1e5) / 100 + 0);
