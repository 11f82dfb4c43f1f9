/** The website: starts the engine, reads the link, shows the page. */

import "./style.css";
import { check } from "../state/check.ts";
import { type Engine, startEngine } from "../solving/engine.ts";
import { stateOf } from "../state/scene_file.ts";
import { Eye } from "./eye.ts";
import { createHook, type Hook } from "./hook.ts";
import { first, initial } from "../state/initial.ts";
import { readLink } from "../state/link.ts";
import { type Manner, Page } from "./page.ts";
import { report } from "./refusals.ts";
import SolveWorker from "../solving/solve.worker.ts?worker&inline";
import { Studio } from "../solving/studio.ts";
import type { State } from "../state/types.ts";
import type { Language } from "./words.ts";
import wasmUrl from "../../built/midair.wasm?url";
import { type Notice, noticeOf } from "../state/notice.ts";

declare global {
  interface Window {
    midair?: Hook;
  }
}

const root = document.getElementById("studio")!;
const language: Language = navigator.language.startsWith("ja") ? "ja" : "en";

/** Returns the state in the page's address; throws a message of one line about its fault. */
function linked({ catalogue }: Engine): State {
  const state = readLink(location.hash);
  check(state, catalogue);
  return state;
}

async function start() {
  const wasm = await (await fetch(wasmUrl)).arrayBuffer();
  const engine = await startEngine(() => new SolveWorker(), wasm);
  const wrong: Notice[] = [];
  let begun = first;
  if (location.hash.length > 1) {
    try {
      begun = linked(engine);
    } catch (error) {
      wrong.push(noticeOf(error));
    }
  }
  const served = new URLSearchParams(location.search);
  if (served.has("scene")) {
    try {
      const name = served.get("scene");
      const text = await (await fetch(name ? `scenes/${encodeURIComponent(name)}.json` : "scene.json")).text();
      begun = stateOf(await engine.slow.read(text, false), initial);
    } catch (error) {
      wrong.push(noticeOf(error));
    }
  }
  const studio = new Studio(engine, begun);
  const manner: Manner = {
    eye: new Eye(studio),
    language,
    board: served.has("board") ? await (await fetch("board.json")).json() : null,
    greets: begun === first,
    theme: matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark",
    again(changes) {
      const buttons = () => [...root.querySelectorAll("button")];
      const focused = buttons().indexOf(document.activeElement as HTMLButtonElement);
      page.dispose();
      page = new Page(root, engine, studio, Object.assign(manner, changes));
      buttons()[focused]?.focus();
    },
  };
  const unread = (line: Notice) => report(manner.language, "unread", { line });
  let page = new Page(root, engine, studio, manner);
  window.midair = createHook(engine, studio, () => page);
  window.addEventListener("hashchange", () => {
    try {
      studio.change(linked(engine));
    } catch (error) {
      page.alarm(unread(noticeOf(error)));
    }
  });
  // Stores the site for use without a network; a page opened from a disk needs no storage.
  if (location.protocol !== "file:") void navigator.serviceWorker?.register("sw.js").catch(() => undefined);
  if (wrong.length) page.alarm(wrong.map(unread).join("\n"));
}

start().catch((error: Error) => {
  root.textContent = report(language, "failed", { line: noticeOf(error) });
  root.setAttribute("role", "alert");
});
