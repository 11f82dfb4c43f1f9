/** Array picker: a select of arrays. Browsers that support it show a small picture of the transducers beside each name. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { initial } from "../state/initial.ts";
import { sceneOf } from "../state/scene_file.ts";

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

/** Makes the select; calls `change` with the name of the chosen array. */
export function createArrayPicker({ engine, studio }: Context, change: (name: string) => void) {
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

  /** Draws the pictures of all arrays. */
  async function draw() {
    if (!CSS.supports("appearance", "base-select")) return;
    for (const { name } of engine.catalogue.presets) {
      const scene = JSON.stringify(sceneOf({ ...initial, array: { preset: name, tiles: [1, 1] }, points: [[0, 0, 0.1]] }, 0));
      const array = await engine.slow.arrayOf(scene).catch(() => null);
      if (array) pictures.set(name, drawn(array.subarray(0, array.length / 2)));
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
      if (!same) select.replaceChildren(face, ...pairs.map(([name, text]) => new Option(text, name)));
      if (select.value !== chosen) select.value = chosen;
      if (!same) illustrate();
    },
  };
}
