/** Bar at the top: name, undo and redo, levels, gallery, board, link, and a menu for files, language and theme. */

import { createBoardButton } from "./boardbutton.ts";
import type { Context } from "./context.ts";
import { element, explained } from "./dom.ts";
import { exportDrive, exportScene, open } from "./exchange.ts";
import { showGallery } from "./gallerybox.ts";
import { writeLink } from "../state/link.ts";
import { noticeOf } from "../state/notice.ts";
import type { Word } from "./words.ts";

/** Functions of the page that the bar calls. */
export interface Deeds {
  language(): void;
  theme(): void;
  picture(ending: "png" | "svg", plain?: boolean): void;
}

const LOGO =
  '<svg viewBox="0 0 24 24" width="24" height="24" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="2" ' +
  'stroke-linecap="round"><circle cx="12" cy="5.5" r="2.4" fill="currentColor" stroke="none"/>' +
  '<path d="M7.2 9.5a6.6 6.6 0 0 0 9.6 0M4.5 13a11 11 0 0 0 15 0M2 17a15.5 15.5 0 0 0 20 0"/></svg>';

/** Makes the bar. `levels` are the buttons for the page's levels, which the bar contains. */
export function createBar(context: Context, levels: HTMLElement, deeds: Deeds): { root: HTMLElement; update(): void } {
  const { studio, say } = context;
  const button = (text: string, act: () => void, name = text, className = "") => {
    const made = element("button", { onclick: act, className, "aria-label": name }, text);
    return name === text ? made : explained(made, name);
  };
  const step = (way: "undo" | "redo") => {
    if (studio[way]()) context.announce(say(way === "undo" ? "undone" : "redone"));
  };
  const undo = button("↶", () => step("undo"), say("undo"), "icon");
  const redo = button("↷", () => step("redo"), say("redo"), "icon");
  const file = element("input", {
    type: "file",
    hidden: true,
    accept: ".toml,.json,.csv,.svg,.png,.jpg,.jpeg,.webp",
    onchange: () => {
      if (file.files?.[0]) void open(context, file.files[0]);
      file.value = "";
    },
  });
  const share = async () => {
    history.replaceState(null, "", `#${writeLink(studio.view.state)}`);
    const { href, hostname } = location;
    context.alarm(/[#&]a=own(&|$)/.test(href) ? say("linkLacks") : /^(127\.|localhost$)/.test(hostname) ? say("linkLocal") : "");
    if (!matchMedia("(hover: none)").matches || !navigator.share) return context.copy(shared, href);
    await navigator.share({ title: document.title, url: href }).catch(() => undefined);
  };
  const shared = button(say("share"), () => void share(), say("share"), "filled");
  const python = () =>
    `import midair\n\nscene = midair.Scene.parse("""${studio.scene(0)}""")\nname, options = scene.solver\nsolution = midair.solve(scene, name, **options)\nprint(solution.metrics)\nsolution.plot().savefig("field.png")\n`;
  const about = () => {
    const copy = button(say("asPython"), () => void context.copy(copy, python()), say("asPython"), "filled");
    // In the book, the page is in a folder beside the manual.
    const manual = location.pathname.replace(/\/studio\/(index.html)?$/, "/studio.html");
    const links = [["paper", "https://doi.org/10.1109/TOH.2021.3076489"], ...(manual === location.pathname ? [] : [["manual", manual]])];
    const row = element("p", {}, ...links.map(([word, href]) => element("a", { href, target: "_blank", rel: "noopener" }, say(word as Word))));
    context.dialog("about", `midair ${context.engine.catalogue.version}`, element("p", {}, say("aboutText")), element("p", {}, say("aboutInstall")), row, copy);
  };
  const name = element("h1", {}, "midair ", element("small", {}, say("studio")));
  const logo = element("span", { className: "logo", innerHTML: LOGO });
  const report = (error: unknown) => context.alarm(say("failed", { line: noticeOf(error) }));
  const tools = element(
    "div",
    { className: "tools", id: "tools" },
    button(say("open"), () => file.click(), say("openHint")),
    button(say("exportScene"), () => void exportScene(context).catch(report)),
    button(say("exportDrive"), () => void exportDrive(context, studio.view.state.slot).catch(report)),
    button(say("exportPicture"), () => deeds.picture("png")),
    button(say("exportPlain"), () => deeds.picture("png", true)),
    button(say("exportDrawing"), () => deeds.picture("svg")),
    button(say("language"), deeds.language),
    button(say("theme"), deeds.theme),
    button(say("about"), about),
    file,
  );
  const menu = element("button", { className: "menu icon", "aria-label": say("menu"), "aria-controls": "tools", "aria-expanded": "false" }, "☰");
  const fold = (open: boolean) => menu.setAttribute("aria-expanded", String(tools.classList.toggle("open", open)));
  menu.onclick = () => fold(menu.ariaExpanded === "false");
  // Closes the menu before an entry acts, so that a closed dialog returns the focus to the menu button.
  tools.addEventListener("click", () => (fold(false), menu.focus()), true);
  const root = element(
    "header",
    { className: "top" },
    logo,
    name,
    undo,
    redo,
    levels,
    button(say("gallery"), () => showGallery(context)),
    createBoardButton(context),
    shared,
    menu,
    tools,
  );
  const folds = ({ target, key }: { target: EventTarget | null; key?: string }) => {
    if (key === "Escape" || (!key && !root.contains(target as Node))) fold(false);
  };
  window.addEventListener("pointerdown", folds);
  root.addEventListener("keydown", folds);
  context.ending(() => window.removeEventListener("pointerdown", folds));
  return {
    root,
    update() {
      undo.disabled = !studio.history.canUndo();
      redo.disabled = !studio.history.canRedo();
    },
  };
}
