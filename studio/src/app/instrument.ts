/** Instrument: adds axes in mm, a bar of one wavelength and a cross-hair with field values to the picture of a slice. */

import { changes } from "../state/changes.ts";
import type { Context } from "./context.ts";
import { element, stepOf } from "./dom.ts";
import { wavelength } from "../solving/lattices.ts";
import { roundStep } from "../painter/maps.ts";
import { middleOf, placeOn, SIDES } from "../state/plane.ts";
import { createReadout } from "./readout.ts";
import type { Slot, State } from "../state/types.ts";

/** Returns the marks along an axis of a slice: position as a part of the side, and text in mm. */
export function marks(middle: number, size: number): { at: number; text: string }[] {
  const step = roundStep((1000 * size) / 5);
  const first = Math.ceil((1000 * (middle - size / 2)) / step - 1e-9);
  const last = Math.floor((1000 * (middle + size / 2)) / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => ({
    at: (step * (first + k)) / 1000 / size - middle / size + 0.5,
    text: String(step * (first + k)),
  }));
}

/**
 * Adds scales, cross-hair and field values to a picture of the slice; `slotAt` returns the slot whose field is shown at a
 * fraction of the width. Returns a function that writes the scales again if plane or wavelength has changed.
 */
export function createInstrument(context: Context, picture: HTMLElement, slotAt: (right: number) => Slot): () => void {
  const { studio, say } = context;
  const state = () => studio.view.state;
  const readout = createReadout(context, (line) => document.activeElement === picture && context.announce(line));
  const hair = [element("i", { className: "hair across", hidden: true }), element("i", { className: "hair up", hidden: true })];
  const scales = [element("div", { className: "marks across" }), element("div", { className: "marks up" })];
  const bar = element("div", { className: "wavelength" });
  picture.append(element("div", { className: "instrument", "aria-hidden": "true" }, ...scales, bar, ...hair, readout.root));
  picture.tabIndex = 0;
  let at: [number, number] = [0.5, 0.5];

  function show(right: number, up: number) {
    at = [right, up].map((x) => Math.min(Math.max(x, 0), 1)) as [number, number];
    for (const line of hair) line.hidden = false;
    hair[0].style.bottom = `${100 * at[1]}%`;
    hair[1].style.left = `${100 * at[0]}%`;
    // The values are in the half of the picture where they do not cover the pointer.
    readout.root.classList.toggle("low", at[1] < 0.5);
    readout.show(slotAt(at[0]), placeOn(state().plane, ...at));
  }

  function hide() {
    for (const line of hair) line.hidden = true;
    readout.hide();
  }

  picture.addEventListener("pointermove", (event) => {
    if (event.buttons || event.pointerType === "touch") return hide();
    const box = picture.getBoundingClientRect();
    show((event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
  });
  picture.addEventListener("pointerleave", hide);
  picture.addEventListener("focus", () => picture.matches(":focus-visible") && show(...at));
  picture.addEventListener("blur", hide);
  picture.addEventListener("keydown", (event) => {
    const way = stepOf(event);
    if (!way || way[2] || event.target !== picture) return;
    event.preventDefault();
    const { size } = state().plane;
    show(at[0] + way[0] / size, at[1] + way[1] / size);
  });

  const write = changes((key: string) => {
    const { plane, long } = JSON.parse(key) as { plane: State["plane"]; long: number };
    const middle = middleOf(plane);
    scales.forEach((scale, k) => {
      const axis = SIDES[plane.axis][k];
      const texts = marks(middle[axis], plane.size).map(({ at, text }) => {
        // No text for the first marks, which would be cut, and the last, which would cover the axis's name.
        const mark = element("span", {}, at < 0.04 || at > 0.92 ? "" : text);
        mark.style[k ? "bottom" : "left"] = `${100 * at}%`;
        return mark;
      });
      scale.replaceChildren(...texts, element("b", {}, `${"xyz"[axis]} mm`));
    });
    bar.style.width = `${(100 * long) / plane.size}%`;
    bar.textContent = `λ ${(1000 * long).toFixed(1)}`;
    bar.title = say("wavelength");
  });
  return () => write(JSON.stringify({ plane: state().plane, long: wavelength(state()) }));
}
