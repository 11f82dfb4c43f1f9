/** Phase key: the colours of phases around a circle, as transducers show them. */

import type { Context } from "./context.ts";
import { element, explained } from "./dom.ts";
import { discsOf } from "./look.ts";
import { entry } from "../painter/maps.ts";

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
