/** Drawing: the lines of an SVG, measured by the browser; only the SVG's geometry is used. */

import { box, type Contour, placed } from "./contours.ts";
import { refuse } from "../state/notice.ts";
import type { Vec3 } from "../state/types.ts";

const SVG = "http://www.w3.org/2000/svg";
const GEOMETRY: Record<string, string[]> = {
  g: [],
  svg: [],
  path: ["d"],
  rect: ["x", "y", "width", "height", "rx", "ry"],
  circle: ["cx", "cy", "r"],
  ellipse: ["cx", "cy", "rx", "ry"],
  line: ["x1", "y1", "x2", "y2"],
  polyline: ["points"],
  polygon: ["points"],
};
const MOST_TEXT = 2e6;
const MOST_ELEMENTS = 2000;
/** The largest number of straight pieces, over all lines. */
const MOST_PIECES = 20_000;

/** Returns the root element of the text. No page shows this document, so it runs no script and loads nothing. */
function parse(text: string): Element {
  if (text.length > MOST_TEXT) refuse("drawing-large", { other: "2 MB" });
  const root = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  if (root.localName !== "svg" || root.querySelector("parsererror")) refuse("drawing-unreadable");
  if (root.querySelector("script, foreignObject")) refuse("drawing-script");
  if (root.querySelectorAll("*").length > MOST_ELEMENTS) refuse("drawing-elements", { other: MOST_ELEMENTS });
  return root;
}

/** Returns a copy of the geometry: known elements with their shape attributes and transforms. */
function copied(element: Element): SVGElement | null {
  if (!Object.hasOwn(GEOMETRY, element.localName)) return null;
  const nested = element.localName === "svg" ? "g" : element.localName;
  const copy = document.createElementNS(SVG, nested) as SVGElement;
  for (const name of [...GEOMETRY[element.localName], "transform"]) {
    const value = element.getAttribute(name);
    if (value !== null) copy.setAttribute(name, value);
  }
  copy.append(...[...element.children].flatMap((child) => copied(child) ?? []));
  return copy;
}

/** Returns a shape as polylines in units of the drawing, one for each of its connected parts. */
function walked(shape: SVGGeometryElement, pieces: number): Contour[] {
  const length = shape.getTotalLength();
  const matrix = shape.getCTM();
  if (!(length > 0) || !matrix) return [];
  // The longest distance of neighbouring samples on a line; a larger distance is a jump to the next part.
  const longest = 1.01 * (length / pieces) * Math.hypot(matrix.a, matrix.b, matrix.c, matrix.d);
  const contours: Contour[] = [];
  let last: Vec3 | null = null;
  for (let k = 0; k <= pieces; k += 1) {
    const { x, y } = shape.getPointAtLength((length * k) / pieces).matrixTransform(matrix);
    const at: Vec3 = [x, y, 0];
    if (!last || Math.hypot(x - last[0], y - last[1]) > longest) contours.push([]);
    contours.at(-1)!.push(at);
    last = at;
  }
  return contours;
}

function outlines(text: string): Contour[] {
  const canvas = document.createElementNS(SVG, "svg");
  canvas.style.cssText = "position: fixed; width: 1px; height: 1px; visibility: hidden";
  canvas.append(copied(parse(text)) ?? "");
  document.body.append(canvas);
  try {
    const shapes = [...canvas.querySelectorAll<SVGGeometryElement>("*:not(g)")];
    const pieces = Math.max(16, Math.min(1000, Math.floor(MOST_PIECES / shapes.length)));
    return shapes.flatMap((shape) => walked(shape, pieces));
  } finally {
    canvas.remove();
  }
}

/**
 * Returns the lines of an SVG: the longer side is `size` m, the middle is at a place in m, and y points up as in the picture.
 *
 * Throws a message of one line if the SVG has no usable lines.
 */
export function drawing(text: string, size: number, at: Vec3): Contour[] {
  const contours = outlines(text);
  if (!contours.length) refuse("drawing-empty");
  const side = Math.max(...box(contours).map(([least, most]) => most - least));
  if (!(side > 0 && side < Infinity)) refuse("drawing-empty");
  return placed(contours, [size / side, -size / side], at);
}
