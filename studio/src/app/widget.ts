/** The notebook widget: the same page in a cell, in exchange with Python in both directions. */

import style from "./style.css?inline";
import { type Engine, startEngine } from "../solving/engine.ts";
import { element } from "./dom.ts";
import { Eye } from "./eye.ts";
import { stateOf } from "../state/scene_file.ts";
import { initial } from "../state/initial.ts";
import { metricsOf } from "./numbers.ts";
import { type Manner, Page } from "./page.ts";
import SolveWorker from "../solving/solve.worker.ts?worker&inline";
import { Studio } from "../solving/studio.ts";
import type { State } from "../state/types.ts";

/** The model that anywidget provides. */
interface Model {
  get(name: string): unknown;
  set(name: string, value: unknown): void;
  save_changes(): void;
  on(event: string, act: () => void): void;
  off(event: string, act: () => void): void;
}

async function render({ model, el }: { model: Model; el: HTMLElement }): Promise<() => void> {
  const shadow = el.attachShadow({ mode: "open" });
  const root = element("div");
  shadow.append(element("style", { textContent: style }), root);
  const { buffer, byteOffset, byteLength } = model.get("wasm") as DataView<ArrayBuffer>;
  // The WebAssembly functions accept no DataView.
  const bytes = new Uint8Array(buffer, byteOffset, byteLength);
  const engine: Engine = await startEngine(() => new SolveWorker(), bytes);
  const read = async (before: State) => stateOf(await engine.slow.read(model.get("scene") as string, false), before);
  const studio = new Studio(engine, await read(initial));
  const manner: Manner = {
    eye: new Eye(studio),
    language: "en",
    theme: matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
    compact: true,
    again: () => undefined,
  };
  const page = new Page(root, engine, studio, manner);
  let sent = "";
  studio.listen(() => {
    const { state, results } = studio.view;
    const metrics = Object.fromEntries(results.flatMap((result, slot) => (result.answer ? [[state.methods[slot], metricsOf(result)]] : [])));
    const shown = { state: studio.scene(0), methods: state.methods, metrics };
    if (sent === (sent = JSON.stringify(shown))) return;
    for (const [name, value] of Object.entries(shown)) model.set(name, value);
    model.save_changes();
  });
  const changed = () => {
    read(studio.view.state).then((state) => studio.change(state), (error: Error) => page.alarm(error.message));
  };
  model.on("change:scene", changed);
  return () => {
    model.off("change:scene", changed);
    studio.stop();
    page.dispose();
    engine.dispose();
    shadow.replaceChildren();
  };
}

export default { render };
