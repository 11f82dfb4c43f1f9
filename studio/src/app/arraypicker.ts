/** Array picker: a select of arrays. Browsers that support it show a small picture of the transducers beside each name. */

import type { State } from "../state/types.ts";
import type { Context } from "./context.ts";
import type { Word } from "./words.ts";
import { element } from "./dom.ts";
import { initial } from "../state/initial.ts";
import { broughtBy, reached, roomOf } from "../state/points.ts";
import { sceneOf } from "../state/scene_file.ts";

/** The groups of presets, by their names. */
const GROUPS = { forTouch: /^(?!paper)(?!.*(pair|lev|cap))/, forLevitation: /pair|lev|cap/, ofPaper: /^paper/ };

/** Side of a picture, in units of its SVG. */
const SIDE = 24;

/** An array whose height is above this part of its width is drawn from the side, because its boards face each other. */
const TALL = 0.25;

/** Draws the transducers as dots, from positions (N, 3) in m. */
function drawn(positions: Float64Array): SVGElement {
  const along = (axis: number) => Array.from(positions).filter((_, k) => k % 3 === axis);
  const ends = [0, 1, 2].map((axis) => along(axis).reduce(([least, most], x) => [Math.min(least, x), Math.max(most, x)], [Infinity, -Infinity]));
  const wide = ends.map(([least, most]) => most - least);
  const up = wide[2] > TALL * Math.max(wide[0], wide[1]) ? 2 : 1;
  const scale = (0.86 * SIDE) / Math.max(wide[0], wide[up], 1e-3);
  const at = (value: number, axis: number) => (value - (ends[axis][0] + ends[axis][1]) / 2) * scale;
  const [across, above] = [along(0), along(up)];
  const dots = across.map((x, k) => `M${(SIDE / 2 + at(x, 0)).toFixed(1)} ${(SIDE / 2 - at(above[k], up)).toFixed(1)}h0`);
  const picture = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  picture.setAttribute("viewBox", `0 0 ${SIDE} ${SIDE}`);
  picture.setAttribute("aria-hidden", "true");
  picture.innerHTML = `<path stroke="currentColor" stroke-linecap="round" stroke-width="${up === 2 ? 1.6 : Math.min(2.4, (0.66 * SIDE) / Math.sqrt(across.length)).toFixed(2)}" d="${dots.join("")}"/>`;
  return picture;
}

/** Returns the positions (N, 3) in m of an array. */
async function placesOf({ engine }: Context, array: State["array"]): Promise<Float64Array> {
  const places = await engine.slow.arrayOf(JSON.stringify(sceneOf({ ...initial, array, points: [[0, 0, 0.1]] }, 0)));
  return places.subarray(0, places.length / 2);
}

/** Changes to another array, with its own scene; points that are not from the old array's scene stay, within its reach. */
export async function bring(context: Context, array: State["array"]): Promise<void> {
  const { studio, alarm, say } = context;
  const [from, to] = [studio.view.positions, await placesOf(context, array)].map(roomOf);
  const { state } = studio.view;
  const same = (points: unknown) => JSON.stringify(points) === JSON.stringify(state.points);
  const change: Partial<State> = same(broughtBy(from).points) ? broughtBy(to) : reached(state, from, to);
  studio.change({ array, obstacles: [], ...change });
  alarm(change.signature === undefined && !same(change.points) ? say("reached") : "");
}

/** Makes the select; calls `change` with the name of the chosen array. */
export function createArrayPicker(context: Context, change: (name: string) => void) {
  const { engine, studio, say } = context;
  const select = element("select", { className: "arrays", onchange: () => change(select.value) });
  // The button of the closed select: it shows the chosen array with its picture.
  const face = element("button");
  const pictures = new Map<string, SVGElement>();
  let offered = "";

  function illustrate() {
    for (const option of select.options) {
      const picture = pictures.get(option.value);
      if (picture && !option.contains(picture)) option.prepend(picture);
    }
    // A new element <selectedcontent> copies the chosen option again, now with its picture.
    face.replaceChildren(document.createElement("selectedcontent"));
  }

  /** Returns the options: an array from a file, then the presets in groups, each with its summary. */
  function grouped(pairs: (readonly [string, string])[]): HTMLElement[] {
    const summaries = new Map(engine.catalogue.presets.map(({ name, summary }) => [name, summary]));
    const options = (names: RegExp, known: boolean) =>
      pairs.filter(([name]) => summaries.has(name) === known && names.test(name)).map(([value, text]) => element("option", { value }, element("span", {}, text, element("small", {}, summaries.get(value)))));
    return [...options(/./, false), ...Object.entries(GROUPS).map(([word, names]) => element("optgroup", { label: say(word as Word) }, ...options(names, true)))];
  }

  /** Draws the pictures of all arrays. */
  async function draw() {
    if (!CSS.supports("appearance", "base-select")) return;
    for (const { name } of engine.catalogue.presets) {
      const places = await placesOf(context, { preset: name, tiles: [1, 1] }).catch(() => null);
      if (places) pictures.set(name, drawn(places));
    }
    illustrate();
  }
  // Draws the pictures only after the first field, which users wait for.
  void studio.settled().then(draw);

  return {
    root: select,
    /** Shows these [name, text] pairs, one of them chosen. */
    update(pairs: (readonly [string, string])[], chosen: string) {
      const same = offered === (offered = pairs.join());
      if (!same) select.replaceChildren(face, ...grouped(pairs));
      if (select.value !== chosen) select.value = chosen;
      if (!same) illustrate();
    },
  };
}
