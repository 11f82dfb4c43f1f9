/** Handles: each slice of the 3-D view has a handle at its edge that moves it along its normal, also by keys. */

import { middleOf, placeOn, planesOf, SIDES, through } from "../state/plane.ts";
import { AXES, type Axis, type Vec3 } from "../state/types.ts";
import { type Context, millimetres } from "./context.ts";
import { draggable, element, explained, icon, stepOf } from "./dom.ts";
import type { View } from "./viewing.ts";

/** Largest distance of a slice from 0 along its normal, in m. */
const REACH = 0.4;

/** Makes the handles in the 3-D view, and returns a function that moves them to their slices. */
export function createHandles({ studio, say }: Context, stage: View): () => void {
  const plane = () => studio.view.state.plane;
  /** Returns the place of a slice's handle: the middle of the right side, or the lower right corner of an upright slice. */
  const edge = (axis: Axis): Vec3 => placeOn({ ...plane(), axis }, 1, axis === "z" ? 0.5 : 0);

  const handles = AXES.map((axis, normal) => {
    const handle = element("div", { className: `handle ${axis}`, role: "slider", tabIndex: 0, "aria-orientation": normal === 2 ? "vertical" : "horizontal", "aria-valuemin": -1000 * REACH, "aria-valuemax": 1000 * REACH, innerHTML: icon(normal === 2 ? "M12 3V21M8 7L12 3L16 7M8 17L12 21L16 17" : "M3 12H21M7 8L3 12L7 16M17 8L21 12L17 16") });
    explained(handle, say("moveSlice"));
    const push = (value: number, gesture: string) => {
      const height = Math.round(1e5 * Math.min(Math.max(value, -REACH), REACH)) / 1e5;
      studio.change({ plane: through(plane(), middleOf(plane()).with(normal, height) as Vec3) }, gesture);
    };
    draggable(handle, studio, {
      begin(event) {
        event.preventDefault();
        handle.focus();
        return { pointer: stage.local(event), place: edge(axis), height: middleOf(plane())[normal] };
      },
      move({ pointer, place, height }, event, gesture) {
        const way = stage.sight.lift(pointer, stage.local(event), place, normal);
        if (way !== null) push(height + way, gesture);
      },
    });
    handle.onkeydown = (event) => {
      const [right, up] = stepOf(event) ?? [0, 0];
      if (!(right + up)) return;
      event.preventDefault();
      push(middleOf(plane())[normal] + right + up, `key plane ${axis}`);
    };
    stage.view.append(handle);
    return handle;
  });

  return () => {
    const { state } = studio.view;
    const shown = state.view === "volume" ? [] : planesOf(state).map(({ axis }) => axis);
    AXES.forEach((axis, k) => {
      const handle = handles[k];
      handle.hidden = !shown.includes(axis);
      if (handle.hidden) return;
      const [x, y] = stage.sight.project(edge(axis));
      const value = millimetres(middleOf(plane())[SIDES[axis][2]]);
      handle.style.transform = `translate(${x.toFixed(2)}px, ${y.toFixed(2)}px)`;
      for (const [name, text] of [["aria-label", say("sliceNormal", { axis })], ["aria-valuenow", value], ["aria-valuetext", `${axis} ${value} mm`]]) {
        if (handle.getAttribute(name) !== text) handle.setAttribute(name, text);
      }
    });
  };
}
