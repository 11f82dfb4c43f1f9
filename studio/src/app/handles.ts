/** Handles: each slice of the 3-D view has a handle at its edge that moves it along its normal, also by keys. */

import { type Context, millimetres } from "./context.ts";
import { element } from "./dom.ts";
import { type Camera, lift } from "../painter/camera.ts";
import { middleOf, placeOn, planesOf, SIDES, through } from "../state/plane.ts";
import { AXES, type Axis, type Vec3 } from "../state/types.ts";
import type { Spot } from "./viewing.ts";

/** Steps of the arrow keys in m: without and with Shift. */
const STEPS = [1e-3, 1e-2];

const WAYS: Record<string, number> = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 };

/** Largest distance of a slice from 0 along its normal, in m. */
const REACH = 0.4;

/** Makes the handles in a view, and returns a function that moves them to their slices. */
export function createHandles(context: Context, view: HTMLElement, camera: () => Camera, local: (event: MouseEvent) => Spot, seen: (place: Vec3) => Vec3) {
  const { studio, say } = context;
  const state = () => studio.view.state;
  let gesture = 0;

  const made = AXES.map((axis, normal) => {
    const handle = element("div", { className: `handle ${axis}`, role: "slider", tabIndex: 0, "aria-orientation": normal === 2 ? "vertical" : "horizontal", "aria-valuemin": -1000 * REACH, "aria-valuemax": 1000 * REACH }, axis);
    let grip: { at: Spot; place: Vec3; middle: Vec3 } | null = null;
    const push = (value: number, name: string) => {
      const to = Math.round(1e5 * Math.min(Math.max(value, -REACH), REACH)) / 1e5;
      studio.change({ plane: through(state().plane, middleOf(state().plane).with(normal, to) as Vec3) }, name);
    };
    handle.onpointerdown = (event) => {
      event.preventDefault();
      event.stopPropagation();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      grip = { at: local(event), place: edge(axis), middle: middleOf(state().plane) };
      gesture += 1;
      studio.moving(true);
    };
    handle.onpointermove = (event) => {
      if (!grip) return;
      const way = lift(camera(), grip.at, local(event), grip.place, [view.clientWidth || 1, view.clientHeight || 1], normal);
      if (way !== null) push(grip.middle[normal] + way, `drag plane ${gesture}`);
    };
    handle.onpointerup = handle.onpointercancel = () => {
      if (grip) studio.moving(false);
      grip = null;
    };
    handle.onkeydown = (event) => {
      const way = WAYS[event.key];
      if (!way) return;
      event.preventDefault();
      push(middleOf(state().plane)[normal] + way * STEPS[Number(event.shiftKey)], `key plane ${axis}`);
    };
    view.append(handle);
    return { axis, handle };
  });

  /** Returns the place of a slice's handle: the middle of the right side, or the lower right corner of an upright slice. */
  const edge = (axis: Axis): Vec3 => placeOn({ ...state().plane, axis }, 1, axis === "z" ? 0.5 : 0);

  return function place() {
    const shown = state().view === "volume" ? [] : planesOf(state()).map(({ axis }) => axis);
    for (const { axis, handle } of made) {
      handle.hidden = !shown.includes(axis);
      if (handle.hidden) continue;
      const [x, y] = seen(edge(axis));
      const value = millimetres(middleOf(state().plane)[SIDES[axis][2]]);
      handle.style.transform = `translate(${x.toFixed(2)}px, ${y.toFixed(2)}px)`;
      for (const [name, text] of [["aria-label", say("sliceNormal", { axis })], ["aria-valuenow", value], ["aria-valuetext", `${axis} ${value} mm`]]) {
        if (handle.getAttribute(name) !== text) handle.setAttribute(name, text);
      }
    }
  };
}
