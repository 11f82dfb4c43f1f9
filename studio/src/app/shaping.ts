/** Shapes: buttons that replace the points by a circle, a line, a square, a heart or letters. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { MOST_POINTS } from "../state/initial.ts";
import { wavelength } from "../solving/lattices.ts";
import { traced } from "../making/glyphs.ts";
import { letters } from "../making/lettering.ts";
import { placeOn } from "../state/plane.ts";
import { noticeOf } from "../state/notice.ts";

/** Size of a drawn shape, in m. */
const SIZE = 0.06;

const SHAPES = ["circle", "line", "square", "heart", "text"] as const;
type Shape = (typeof SHAPES)[number];

/** Vertices of the shapes, in a square from -1 to 1; letters have none here. */
const CORNERS: Partial<Record<Shape, [number, number][]>> = {
  line: [[-1, 0], [1, 0]],
  square: [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]],
  circle: Array.from({ length: 65 }, (_, k) => [Math.cos((Math.PI * k) / 32), Math.sin((Math.PI * k) / 32)]),
  heart: Array.from({ length: 33 }, (_, k) => {
    const t = (Math.PI * k) / 16;
    return [Math.sin(t) ** 3, (13 * Math.cos(t) - 5 * Math.cos(2 * t) - 2 * Math.cos(3 * t) - Math.cos(4 * t)) / 16];
  }),
};

const path = (corners: [number, number][]) => `<path d="M${corners.map(([x, y]) => `${12 + 8 * x} ${12 - 8 * y}`).join("L")}"/>`;
const icon = (shape: Shape) =>
  `<svg viewBox="0 0 24 24" width="24" height="24" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="2" stroke-linejoin="round" stroke-linecap="round">` +
  `${CORNERS[shape] ? path(CORNERS[shape]) : '<path d="M5 20L12 4L19 20M7.6 14H16.4"/>'}</svg>`;

/** Makes the buttons. */
export function createShapes(context: Context): { root: HTMLElement } {
  const { studio, engine, say } = context;
  const text = element("input", { type: "text", value: "HI", maxLength: 24, hidden: true, "aria-label": say("letters") });
  text.onkeydown = ({ key }) => void (key === "Enter" && draw("text"));
  const buttons = SHAPES.map((shape) => {
    const name = say(shape === "text" ? "letters" : shape);
    const choose = () => {
      text.hidden = shape !== "text";
      void draw(shape);
    };
    return element("button", { className: "icon", innerHTML: icon(shape), "aria-label": name, title: name, onclick: choose });
  });

  /** Draws a shape on the slice, around its middle. */
  async function draw(shape: Shape) {
    const { plane } = studio.view.state;
    const half = Math.min(SIZE, plane.size / 2) / 2;
    const place = ([across, up]: number[]) => placeOn(plane, 0.5 + across / plane.size, 0.5 + up / plane.size);
    try {
      const corners = CORNERS[shape]?.map((corner) => corner.map((x) => half * x));
      const { contours, apart } = corners ? { contours: [corners], apart: Infinity } : letters(text.value, half, 0.9 * plane.size, [0, 0, 0], traced);
      const points = await engine.slots[0].along(contours.map((contour) => contour.map(place)), MOST_POINTS);
      studio.change({ points, pressures: null, path: null });
      const least = wavelength(studio.view.state) / 2;
      context.alarm(apart < least ? say("tooFine", { apart: (1000 * apart).toFixed(1), least: (1000 * least).toFixed(1) }) : "");
    } catch (error) {
      context.alarm(say("failed", { line: noticeOf(error) }));
    }
  }

  return { root: element("div", { className: "shapes", role: "group", "aria-label": say("shapes") }, ...buttons, text) };
}
