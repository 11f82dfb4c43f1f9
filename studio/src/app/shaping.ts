/** Shapes: buttons that replace the points by a level circle, line, square, heart or letters, or move them. */

import type { Context } from "./context.ts";
import { element, explained, icon } from "./dom.ts";
import { MANY, MOST_POINTS } from "../state/initial.ts";
import { wavelength } from "../solving/lattices.ts";
import { traced } from "../making/glyphs.ts";
import { letters } from "../making/lettering.ts";
import { placeOn } from "../state/plane.ts";
import { roomOf } from "../state/points.ts";
import { noticeOf } from "../state/notice.ts";
import { isTouch, skinPlane } from "../solving/touch.ts";
import type { Path, State } from "../state/types.ts";

/** The largest size of a drawn shape in m, its part of the array's width, and the part of the slice that it fills. */
const SIZE = 0.1;
const SHARE = 0.4;
const FILLED = 0.7;

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

const drawn = (shape: Shape) => icon(CORNERS[shape] ? `M${CORNERS[shape].map(([x, y]) => `${12 + 8 * x} ${12 - 8 * y}`).join("L")}` : "M5 20L12 4L19 20M7.6 14H16.4");

/** The paths of points, and of a single point, which is then felt. */
const PATH: Path = { kind: "circle", radius: 0.01, frequency: 4 };
const FELT: Path = { kind: "circle", radius: 0.015, frequency: 56 };

/** Makes the buttons. */
export function createShapes(context: Context): { root: HTMLElement; update(state: State): void } {
  const { studio, engine, say } = context;
  const text = element("input", { type: "text", value: "HI", maxLength: 24, hidden: true, "aria-label": say("letters") });
  text.onkeydown = ({ key }) => void (key === "Enter" && draw("text"));
  const buttons = SHAPES.map((shape) => {
    const name = say(shape === "text" ? "letters" : shape);
    const choose = () => {
      text.hidden = shape !== "text";
      void draw(shape);
    };
    return explained(element("button", { className: "icon", innerHTML: drawn(shape), "aria-label": name, onclick: choose }), name);
  });
  const move = explained(element("button", { className: "icon", innerHTML: icon("M19 12A7 7 0 1 1 16 6.3M16.5 2.5V6.7H12.3"), "aria-label": say("moves"), onclick: go }), say("movesTip"));

  /** Moves the points in circles, or stops them. The slice of a single point shows how it is felt. */
  function go() {
    const { state } = studio.view;
    const one = state.points.length === 1 && !state.signature;
    const path = state.path ? null : one ? FELT : PATH;
    const quantity = isTouch(state.quantity) ? "modulus" : state.quantity;
    studio.change(path && one ? { path, quantity: "felt", plane: skinPlane({ ...state, path }), view: "slice" } : { path, quantity });
  }

  let last: Shape = "heart";
  const finer = element("button", { className: "small", hidden: true, onclick: refine }, say("finer"));

  /** Takes four boards, and draws the last shape again, which is larger above them. */
  function refine() {
    studio.change({ array: { ...studio.view.state.array, tiles: [2, 2] } as State["array"] });
    return studio.settled().then(() => draw(last));
  }

  /** Draws a shape on a level slice at the height of the points, above the middle of the array. Its points are half a wavelength or more apart. */
  async function draw(shape: Shape) {
    last = shape;
    const { state, positions } = studio.view;
    const { middle, side } = roomOf(positions);
    const height = state.points.reduce((sum, point) => sum + point[2], 0) / state.points.length;
    const half = Math.min(SIZE, SHARE * side) / 2;
    const plane: State["plane"] = { axis: "z", z: Math.round(1000 * height) / 1000, size: Math.round(2000 * half / FILLED) / 1000, center: [middle[0], middle[1]] };
    const least = wavelength(state) / 2;
    const place = ([across, up]: number[]) => placeOn(plane, 0.5 + across / plane.size, 0.5 + up / plane.size);
    try {
      const corners = CORNERS[shape]?.map((corner) => corner.map((x) => half * x));
      const { contours, apart } = corners ? { contours: [corners], apart: Infinity } : letters(text.value, half, FILLED * plane.size, [0, 0, 0], traced);
      const long = contours.flatMap((contour) => contour.slice(1).map((at, k) => Math.hypot(at[0] - contour[k][0], at[1] - contour[k][1]))).reduce((a, b) => a + b, 0);
      const points = await engine.slots[0].along(contours.map((contour) => contour.map(place)), Math.min(MOST_POINTS, Math.max(2, Math.floor(long / least))));
      studio.change({ points, pressures: null, path: null, plane, quantity: "modulus", view: "slice", signature: "" });
      context.alarm(apart < least ? say("tooFine", { apart: (1000 * apart).toFixed(1), least: (1000 * least).toFixed(1) }) : "");
    } catch (error) {
      context.alarm(say("failed", { line: noticeOf(error) }));
    }
  }

  return {
    root: element("div", { className: "shapes", role: "group", "aria-label": say("shapes") }, ...buttons, move, text, finer),
    update({ array, points, path, level }: State) {
      move.hidden = level !== "play";
      move.setAttribute("aria-pressed", String(path !== null));
      finer.hidden = !("preset" in array && array.tiles.join() === "1,1" && points.length > MANY && engine.catalogue.presets.some(({ name, tiles }) => tiles && name === array.preset));
    },
  };
}
