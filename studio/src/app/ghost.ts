/** Ghost: an animated hand drags the first focus once along a loop, to show users that a focus can be dragged. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { onPlane, placeOn } from "../state/plane.ts";
import { moved } from "../state/points.ts";
import type { Vec3 } from "../state/types.ts";
import type { View } from "./viewing.ts";

/** Times in ms: before the hand appears, of its way to the focus, and of the loop. */
const WAIT = 2000;
const COME = 700;
const LOOP = 2600;

/** Half the loop's width and its height, relative to the side of the slice. */
const LOOPS = [0.1, 0.14];

const HAND =
  '<svg viewBox="0 0 24 24" width="40" height="40" fill="#fff" stroke="#0c0f14" stroke-width="1.2" stroke-linejoin="round">' +
  '<path d="M8 12V4.5a1.5 1.5 0 0 1 3 0V10l6.2 1.3c1.4.3 2.3 1.5 2.1 2.9l-.8 4.6c-.3 1.8-1.7 3-3.5 3h-3.6c-1.2 0-2.3-.6-3-1.6L4.3 15c-.6-.8-.4-1.9.4-2.4.7-.5 1.7-.4 2.3.3z"/></svg>';

/** Animates the hand in the 3-D view, once, or until the user does something. */
export async function haunt({ studio, ending }: Context, stage: View): Promise<void> {
  const { points, plane } = studio.view.state;
  const [from] = points;
  const hand = element("div", { className: "ghost", innerHTML: HAND, "aria-hidden": "true" });
  const over = new AbortController();
  const { signal } = over;
  let holds = false;
  const put = (place: Vec3) => studio.change(moved(studio.view.state, 0, place), "drag ghost");
  function end() {
    if (signal.aborted) return;
    over.abort();
    hand.remove();
    if (!holds) return;
    put(from);
    studio.setMoving(false);
  }
  for (const kind of ["pointerdown", "keydown", "wheel"]) window.addEventListener(kind, end, { signal, capture: true });
  ending(end);
  await studio.settled();
  await new Promise((done) => setTimeout(done, WAIT));
  if (signal.aborted || JSON.stringify(studio.view.state.points) !== JSON.stringify(points)) return end();

  const [right, up] = onPlane(plane, from);
  const begun = performance.now();
  stage.view.append(hand);
  const step = (now: number) => {
    if (signal.aborted) return;
    const [coming, part] = [Math.min((now - begun) / COME, 1), Math.max(now - begun - COME, 0) / LOOP];
    if (part >= 1) return end();
    // The speed is low at both ends.
    const turn = 2 * Math.PI * part ** 2 * (3 - 2 * part);
    const place = placeOn(plane, right + LOOPS[0] * Math.sin(turn), up + (LOOPS[1] * (1 - Math.cos(turn))) / 2);
    if (part > 0) {
      if (!holds) studio.setMoving((holds = true));
      put(place);
    }
    const [x, y] = stage.sight.project(place);
    hand.style.opacity = String(coming);
    hand.style.transform = `translate(${x + 120 * (1 - coming) ** 2}px, ${y + 90 * (1 - coming) ** 2}px)`;
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}
