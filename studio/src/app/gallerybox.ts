/** Gallery dialog: lets the user choose an example scene. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { gallery } from "../state/gallery.ts";

/** Shows the dialog; a chosen scene replaces the state. Undo restores the old state. */
export function showGallery(context: Context): void {
  const { studio, say, language } = context;
  const root = document.querySelector(".studio") ?? document.body;
  const cards = gallery.map(({ name, line, state }) => {
    const word = (pair: string[]) => pair[language === "ja" ? 1 : 0];
    const choose = () => {
      dialog.close();
      const { level } = studio.view.state;
      studio.change({ ...state, level: level === "play" ? "compare" : level });
      context.announce(say("opened", { name: word(name) }));
    };
    const text = element("span", {}, word(line));
    return element("li", {}, element("button", { onclick: choose }, element("b", {}, word(name)), text));
  });
  const dialog = element(
    "dialog",
    { className: "gallery", "aria-label": say("gallery") },
    element("header", {}, element("h2", {}, say("gallery")), element("button", { className: "icon", "aria-label": say("close"), onclick: () => dialog.close() }, "×")),
    element("ul", {}, ...cards),
  );
  dialog.onclose = () => dialog.remove();
  root.append(dialog);
  dialog.showModal();
}
