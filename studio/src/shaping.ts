/** Shapes: letters, a line or a circle in place of the points. */

import type { Context } from "./context.ts";
import { choice, element } from "./dom.ts";
import { MOST_POINTS } from "./initial.ts";
import { letters } from "./lettering.ts";
import type { Vec3 } from "./types.ts";

/** Sizes of what is drawn, in m. */
const SIZE = 0.06;

/** Makes the controls. */
export function createShapes(context: Context): { root: HTMLElement } {
  const { studio, engine, say } = context;
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
  text.onkeydown = ({ key }) => void (key === "Enter" && apply());
  const draw = element("button", { className: "small", onclick: apply }, say("draw"));

  async function apply() {
    const { plane } = studio.view.state;
    const [x, y] = plane.center;
    const half = Math.min(SIZE, plane.size / 2) / 2;
    const at: Vec3 = [x, y, plane.z];
    const [first] = engine.slots;
    const makers: Record<string, () => Promise<Vec3[]>> = {
      circle: () => first.circle(at, half, MOST_POINTS),
      line: () => first.along([[[x - half, y, plane.z], [x + half, y, plane.z]]], MOST_POINTS),
      text: async () => first.along(letters(text.value, half, 0.9 * plane.size, at), MOST_POINTS),
    };
    try {
      studio.change({ points: await makers[kind.value](), pressures: null, path: null });
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
  }

  return { root: element("div", { className: "row shapes" }, kind, text, draw) };
}
