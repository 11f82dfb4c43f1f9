/** Keys of colours: of phases around a circle, as transducers show them, and of the slice as a bar. */

import type { Context } from "./context.ts";
import { element, explained, write } from "./dom.ts";
import { discsOf, lookOf } from "./look.ts";
import { entry, mapOf, ticks } from "../painter/maps.ts";

/** Number of colours around the circle. */
const COUNT = 32;

/** Makes the key; phase 0 is at the right, and phases increase counterclockwise, as in the complex plane. */
export function createPhaseKey({ studio, say }: Context): { root: HTMLElement; update(): void } {
  // A conic gradient runs clockwise from the top, which is a phase of a quarter of a turn.
  const colours = Array.from({ length: COUNT + 1 }, (_, k) => `rgb(${entry("phase", (1.75 - k / COUNT) % 1).map(Math.round)})`);
  const ring = element("span", { className: "wheel" });
  ring.style.background = `conic-gradient(${colours.join()})`;
  const marks = ["0", "π/2", "π", "−π/2"].map((text) => element("i", {}, text));
  const root = explained(element("div", { className: "phasekey", role: "img", "aria-label": say("phaseKey") }, ring, ...marks), say("phaseKeyTip"));
  return { root, update: () => (root.hidden = discsOf(studio.view.state) !== "phase") };
}

/** Makes the key of the slice's colours at the level "play": other levels have a bar with all marks. */
export function createColourKey({ studio, theme, say }: Context): { root: HTMLElement; update(): void } {
  const bar = element("span");
  const marks = ["least", "none", "most"].map(() => element("i"));
  const root = explained(element("div", { className: "colourkey", role: "img", "aria-label": say("scaleOf") }, bar, ...marks), say("scaleTip"));
  const update = () => {
    if ((root.hidden = studio.view.state.level !== "play" || discsOf(studio.view.state) === "phase")) return;
    const look = lookOf(studio.view, theme);
    bar.style.background = `linear-gradient(to right, ${Array.from({ length: COUNT + 1 }, (_, k) => `rgb(${entry(mapOf(look), k / COUNT).map(Math.round)})`)})`;
    const all = ticks(look);
    [all[0], all.find(({ label }) => label === "0"), all.at(-1)].forEach((tick, k) => {
      write(marks[k], tick?.label ?? "");
      marks[k].style.left = `${100 * (tick?.at ?? 0)}%`;
    });
  };
  return { root, update };
}
