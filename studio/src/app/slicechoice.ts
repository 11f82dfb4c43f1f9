/** Slice choice: buttons for the axis that the slice is normal to, and for all three slices. */

import type { Context } from "./context.ts";
import { element, explained, icon } from "./dom.ts";
import { SIDES } from "../state/plane.ts";
import { AXES } from "../state/types.ts";

/** Drawings of the slices. */
const PLANES = { z: "M2 15L8 9H22L16 15Z", y: "M5 5H19V19H5Z", x: "M8 9L16 4V15L8 20Z" };

/** Makes a button with a drawing and a name, which is left out on a phone. */
function named(path: string, tip: string, name: string, onclick: () => void): HTMLButtonElement {
  const button = explained(element("button", { innerHTML: icon(path), "aria-label": name, onclick }), tip);
  button.append(element("span", {}, name));
  return button;
}

/** Makes the buttons; each is named by the two axes along its slice. */
export function createSliceChoice({ studio, say }: Context): { root: HTMLElement; update(): void } {
  const state = () => studio.view.state;
  const names = ["z", "y", "x"] as const;
  const buttons = names.map((axis) =>
    named(PLANES[axis], say("sliceNormal", { axis }), SIDES[axis].slice(0, 2).map((k) => AXES[k]).join("–"), () => studio.change({ plane: { ...state().plane, axis } })),
  );
  const three = named("M2 14L7 10H22L17 14ZM6 5H18V19H6ZM12 3V21", say("threeSlices"), "×3", () => studio.change({ view: state().view === "planes" ? "slice" : "planes" }));
  three.ariaLabel = say("threeSlices");
  return {
    root: element("div", { className: "joined", role: "group", "aria-label": say("sliceAxis") }, ...buttons, three),
    update() {
      names.forEach((axis, k) => buttons[k].setAttribute("aria-pressed", String(axis === state().plane.axis)));
      three.setAttribute("aria-pressed", String(state().view === "planes"));
    },
  };
}
