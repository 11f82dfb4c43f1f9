/** Figure: the exported picture as SVG: 3-D view, both slices with axes and colour bar, metrics, version and link. */

import type { Context } from "./context.ts";
import { millimetres } from "./context.ts";
import { element } from "./dom.ts";
import { marks } from "./instrument.ts";
import { writeLink } from "../state/link.ts";
import { numberRows } from "./numbers.ts";
import { sampleAt } from "../painter/lattice.ts";
import { colour, drawPixels, entry, mapOf, ticks } from "../painter/maps.ts";
import { middleOf, onPlane, SIDES } from "../state/plane.ts";
import { AXES, type Lattice, type Look, type Slot } from "../state/types.ts";
import { shownOf } from "../solving/studio.ts";
import type { Part } from "./recording.ts";
import type { Word } from "./words.ts";

/** In CSS px: width and height of a figure with one line at its foot; width and height of the 3-D view; side of a slice. */
const FIGURE = [1280, 760];
const VIEW = [560, 640];
const SIDE = 270;

/** Characters per line at the foot, which has link and version; and the distance of lines in px. */
const LINE = 190;
const LEADING = 14;

/** Pixels along a side of a slice's image. */
const PIXELS = 540;

/** A dark rim, which makes white signs legible on a bright ground. */
const RIM = 'style="filter: drop-shadow(0 0 1px #000)"';

const escaped = (text: string) => text.replace(/[&<>"]/g, (each) => `&#${each.charCodeAt(0)};`);

/** Returns a text at x, y; `more` are further attributes. */
const text = (x: number, y: number, words: string, more = "") => `<text x="${x}" y="${y}" ${more}>${escaped(words)}</text>`;

const picture = (canvas: HTMLCanvasElement, x: number, y: number, width: number, height: number) =>
  `<image x="${x}" y="${y}" width="${width}" height="${height}" preserveAspectRatio="none" href="${canvas.toDataURL()}"/>`;

/** Draws the slice in pixels of `canvas`, with `v` up. */
export const drawSlice = (canvas: HTMLCanvasElement, lattice: Lattice, look: Look) =>
  drawPixels(canvas, (right, up) => colour(look, ...sampleAt(lattice, right, up)));

/**
 * Returns the figure of the current view. `canvas` is the page's canvas, painted just before, `box` the 3-D view in it (px of
 * the canvas). A plain one is the shown slice alone, as on paper: in light colours, with rings but without numbers.
 */
export function figure({ studio, say, engine }: Context, colours: Look, root: HTMLElement, { canvas, box }: Part, plain = false): string {
  const look: Look = plain ? { ...colours, theme: "light" } : colours;
  const { view } = studio;
  const { state } = view;
  const style = getComputedStyle(root);
  const [back, ink, soft] = ["--back", "--text", "--soft"].map((name) => style.getPropertyValue(name));

  function space(): string {
    const copy = element("canvas", { width: box.width, height: box.height });
    copy.getContext("2d")!.drawImage(canvas, box.x, box.y, box.width, box.height, 0, 0, box.width, box.height);
    const scale = Math.min(VIEW[0] / box.width, VIEW[1] / box.height);
    return picture(copy, 24, 60 + (VIEW[1] - scale * box.height) / 2, scale * box.width, scale * box.height);
  }

  /** Returns a slice with its axes in mm, its rings and the colour bar. */
  function slice(slot: Slot, lattice: Lattice, x: number, y: number): string {
    const copy = element("canvas", { width: PIXELS, height: PIXELS });
    drawSlice(copy, lattice, look);
    const { plane } = state;
    const { size, axis: normal } = plane;
    const [right, up, off] = SIDES[normal];
    const middle = middleOf(plane);
    const across = marks(middle[right], size).map((mark) => text(x + SIDE * mark.at, y + SIDE + 14, mark.text, 'text-anchor="middle"'));
    const upward = marks(middle[up], size).map((mark) => text(x - 6, y + SIDE * (1 - mark.at) + 4, mark.text, 'text-anchor="end"'));
    const points = (view.frame?.results[slot] && view.frame.points) || state.points;
    const rings = points.map((point, k) => {
      const [aside, above] = onPlane(plane, point);
      if (Math.max(Math.abs(aside - 0.5), Math.abs(above - 0.5)) > 0.5) return "";
      const [left, top] = [x + SIDE * aside, y + SIDE * (1 - above)];
      const ring = `<circle cx="${left}" cy="${top}" r="7" fill="none" stroke="#fff" ${RIM}/>`;
      return plain ? ring : ring + text(left + 9, top - 5, String(k + 1), `fill="#fff" ${RIM}`);
    });
    if (plain) return `<svg xmlns="http://www.w3.org/2000/svg" width="${SIDE}" height="${SIDE}">${picture(copy, x, y, SIDE, SIDE)}${rings.join("")}</svg>`;
    const bar = element("canvas", { width: 1, height: 256 });
    drawPixels(bar, (_, up) => entry(mapOf(look), up));
    const levels = ticks(look).map((tick) => text(x + SIDE + 28, y + SIDE * (1 - tick.at) + 4, tick.label));
    const name = view.frame?.names[slot] || state.methods[slot];
    return [
      text(x, y - 10, `${"AB"[slot]}: ${name}, ${say(look.touch ?? look.quantity)} at ${normal} = ${millimetres(middle[off])} mm`, 'font-weight="600"'),
      picture(copy, x, y, SIDE, SIDE),
      ...rings,
      text(x + SIDE / 2, y + SIDE + 30, `${AXES[right]} / mm`, 'text-anchor="middle"'),
      text(x - 40, y + SIDE / 2, `${AXES[up]} / mm`, `text-anchor="middle" transform="rotate(-90 ${x - 40} ${y + SIDE / 2})"`),
      ...across,
      ...upward,
      picture(bar, x + SIDE + 12, y, 10, SIDE),
      ...levels,
    ].join("");
  }

  const shown = shownOf(view)[state.slot].lattice;
  if (plain && shown) return slice(state.slot, shown, 0, 0);
  const rows = numberRows(view).map(({ word, values, better }, k) => {
    const y = 90 + 26 * k;
    const cells = values.map((value, slot) => text(values.length === 1 ? 1220 : 1180 + 80 * slot, y, value, `text-anchor="end" font-weight="${better === slot ? 700 : 400}"`));
    return text(1010, y, say(word as Word), `fill="${soft}" font-size="11"`) + cells.join("");
  });
  const { array } = state;
  const name = "preset" in array ? `${array.preset} ${array.tiles.join(" × ")}` : array.name;
  // A skin is predicted for A only.
  const slices = shownOf(view).map(({ lattice }, slot) => (lattice && !(slot && view.frame?.touch) ? slice(slot as Slot, lattice, 650, slot ? 410 : 70) : ""));
  const foot = `midair ${engine.catalogue.version}  ${new URL(`#${writeLink(state)}`, location.href).href}`.match(new RegExp(`.{1,${LINE}}`, "g"))!;
  const height = FIGURE[1] + (foot.length - 1) * LEADING;
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${FIGURE[0]} ${height}" width="${FIGURE[0]}" height="${height}" font-family="Inter, system-ui, sans-serif" font-size="12" fill="${ink}">`,
    `<rect width="100%" height="100%" fill="${back}"/>`,
    text(24, 36, `${name}, ${say("points").toLowerCase()}: ${state.points.length}, ${state.temperature} °C`, 'font-size="18" font-weight="600"'),
    space(),
    ...slices,
    ...rows,
    text(1180, 64, "A", `text-anchor="end" fill="${soft}"`),
    text(1260, 64, "B", `text-anchor="end" fill="${soft}"`),
    ...foot.map((line, k) => text(24, 744 + k * LEADING, line, `fill="${soft}" font-size="10"`)),
    "</svg>",
  ].join("\n");
}
