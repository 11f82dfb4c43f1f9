/** Drawing: the lines of an SVG, measured by the browser; only the SVG's geometry is used. */

import { box, type Contour, placed } from "./contours.ts";
import { refuse } from "../state/notice.ts";
import type { Vec3 } from "../state/types.ts";

const SVG = "http://www.w3.org/2000/svg";
const GEOMETRY: Record<string, string[]> = {
  g: [],
  a: [],
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
  refuseForeign(root);
  if (root.querySelectorAll("*").length > MOST_ELEMENTS) refuse("drawing-elements", { other: MOST_ELEMENTS });
  return root;
}

/** What children inherit, with its initial values. */
const INHERITED = { visibility: "visible", fill: "black", stroke: "none" };
/** Properties that decide what is seen; style sheets that set them are refused. */
const OBEYED = /\b(display|visibility|opacity|transform)\s*:/;

/** Refuses what a browser draws and this page does not. */
function refuseForeign(root: Element): void {
  for (const element of root.querySelectorAll("use, switch, svg, style")) {
    if (element.localName !== "style" || OBEYED.test(element.textContent)) refuse("drawing-foreign", { other: element.localName });
  }
}

/** Returns a copy of the geometry that a browser shows: known elements with their shape attributes and transforms. */
function copied(element: Element, around = INHERITED): SVGElement | null {
  if (!Object.hasOwn(GEOMETRY, element.localName)) return null;
  // The page's policy allows no inline styles, so they are read as text.
  const declared = (element.getAttribute("style") ?? "").split(";").map((one) => one.split(":").map((part) => part.trim()));
  const style = new Map(declared.map(([name, value]) => [name, value]));
  const own = (name: string) => (style.get(name) || element.getAttribute(name) || "").trim();
  if (own("display") === "none" || /^0*\.?0*%?$/.test(own("opacity") || "1")) return null;
  const inherited = { ...around };
  for (const name of ["visibility", "fill", "stroke"] as const) {
    if (own(name) && own(name) !== "inherit") inherited[name] = own(name);
  }
  const painted = [inherited.fill, inherited.stroke].some((paint) => !/^(none|transparent)$/.test(paint));
  const seen = inherited.visibility === "visible" && painted;
  const inner = GEOMETRY[element.localName];
  if (inner.length && !seen) return null;
  const copy = document.createElementNS(SVG, inner.length ? element.localName : "g") as SVGElement;
  for (const name of [...inner, "transform"]) {
    const value = (name === "transform" && style.get(name)) || element.getAttribute(name);
    if (value) copy.setAttribute(name, value);
  }
  copy.append(...[...element.children].flatMap((child) => copied(child, inherited) ?? []));
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
