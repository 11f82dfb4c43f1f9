/** Viewing: pointers turn, shift and zoom the 3-D view; buttons look from above, along the slice's normal or as at first. */

import type { Sight, Spot } from "../painter/camera.ts";
import type { Context } from "./context.ts";
import { element, explained, icon } from "./dom.ts";
import type { Eye } from "./eye.ts";

/** The 3-D view, as it is seen now, and where a pointer is in it. */
export interface View {
  readonly view: HTMLElement;
  readonly sight: Sight;
  local(event: MouseEvent): Spot;
}

/**
 * Lets pointers move the view. One finger or the left button turns it, two fingers or the right button shift it, two fingers or
 * the wheel zoom. With Shift, the left button draws a rectangle: `box` is called with its corners, and with true at the end.
 */
export function createViewing(context: Context, eye: Eye, view: HTMLElement, local: (event: MouseEvent) => Spot, box: (from: Spot, to: Spot, done: boolean) => void) {
  const { say } = context;
  const fingers = new Map<number, Spot>();
  let corner: Spot | null = null;
  view.onpointerdown = (event) => {
    if (event.target !== view) return;
    view.setPointerCapture(event.pointerId);
    if (event.shiftKey && event.button === 0) corner = local(event);
    else fingers.set(event.pointerId, local(event));
  };
  view.onpointermove = (event) => {
    const now = local(event);
    if (corner) return box(corner, now, false);
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    const apart = (at: Spot) => Math.hypot(at[0] - other![0], at[1] - other![1]);
    if (other) {
      eye.zoom(apart(before) / Math.max(apart(now), 1));
      // The middle between two fingers moves half as far as one of them.
      eye.pan(dx / 2, dy / 2);
    } else if (event.buttons & 2) eye.pan(dx, dy);
    else eye.turn(dx, dy);
    fingers.set(event.pointerId, now);
    context.repaint();
  };
  view.onpointerup = view.onpointercancel = (event) => {
    if (corner) box(corner, local(event), true);
    corner = null;
    fingers.delete(event.pointerId);
  };
  view.oncontextmenu = (event) => event.preventDefault();
  view.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      eye.zoom(Math.exp(event.deltaY * 1e-3));
      context.repaint();
    },
    { passive: false },
  );
  const button = (word: "fromAbove" | "fromAhead" | "asFirst", sign: string) => {
    const act = () => {
      eye.look(word);
      context.repaint();
    };
    return explained(element("button", { onclick: act, "aria-label": say(word), innerHTML: icon(sign) }), say(word));
  };
  return element(
    "div",
    { className: "joined", role: "group", "aria-label": say("lookFrom") },
    button("fromAbove", "M3 20L8 14H21L16 20ZM12 2V9M9 6.5L12 9.5L15 6.5"),
    button("fromAhead", "M14 8L20 4V16L14 20ZM2 12H9M6.5 9L9.5 12L6.5 15"),
    button("asFirst", "M5 12A7 7 0 1 0 8 6.3M7.5 2.5V6.7H11.7"),
  );
}
