/** Shapes: letters, a line or a circle in place of the points. */

import type { Context } from "./context.ts";
import { choice, element } from "./dom.ts";
import { letters } from "./lettering.ts";
import { circle, fitting, line } from "./shapes.ts";
import type { Vec3 } from "./types.ts";

/** Sizes of what is drawn, in m. */
const SIZE = 0.06;

/** Makes the controls. */
export function createShapes(context: Context): { root: HTMLElement } {
  const { studio, say } = context;
  const kind = choice(
    [
      ["circle", say("shapeCircle")],
      ["line", say("shapeLine")],
      ["text", say("shapeText")],
    ],
    "circle",
    (value) => (text.hidden = value !== "text"),
    { "aria-label": say("shapes") },
  );
  const text = element("input", { type: "text", value: "HI", maxLength: 8, hidden: true, "aria-label": say("shapeText") });
  const draw = element("button", { className: "small", onclick: apply }, say("draw"));

  function apply() {
    const { plane } = studio.view.state;
    const [x, y] = plane.center;
    const half = Math.min(SIZE, plane.size / 2) / 2;
    const makers: Record<string, (step: number) => Vec3[]> = {
      circle: (step) => circle([x, y, plane.z], half, step),
      line: (step) => line([x - half, y, plane.z], [x + half, y, plane.z], step),
      text: (step) => letters(text.value, half, plane.z, step).map(([a, b, z]) => [a + x, b + y, z]),
    };
    try {
      studio.change({ points: fitting(makers[kind.value]), pressures: null, path: null });
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
  }

  return { root: element("div", { className: "row shapes" }, kind, text, draw) };
}
