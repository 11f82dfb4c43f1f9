/** Slice choice: buttons for the axis that the slice is normal to, and for all three slices. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { SIDES } from "../state/plane.ts";
import { AXES } from "../state/types.ts";

/** Makes the buttons; each is named by the two axes along its slice. */
export function createSliceChoice({ studio, say }: Context): { root: HTMLElement; update(): void } {
  const state = () => studio.view.state;
  const names = ["z", "y", "x"] as const;
  const buttons = names.map((axis) =>
    element("button", { title: say("sliceNormal", { axis }), onclick: () => studio.change({ plane: { ...state().plane, axis } }) }, SIDES[axis].slice(0, 2).map((k) => AXES[k]).join("–")),
  );
  const three = element("button", { title: say("threeSlices"), "aria-label": say("threeSlices"), onclick: () => studio.change({ view: state().view === "planes" ? "slice" : "planes" }) }, "×3");
  return {
    root: element("div", { className: "joined", role: "group", "aria-label": say("sliceAxis") }, ...buttons, three),
    update() {
      names.forEach((axis, k) => buttons[k].setAttribute("aria-pressed", String(axis === state().plane.axis)));
      three.setAttribute("aria-pressed", String(state().view === "planes"));
    },
  };
}
