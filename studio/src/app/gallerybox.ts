/** Gallery dialog: lets the user choose an example scene. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { lookOf } from "./look.ts";
import { sampleAt } from "../painter/lattice.ts";
import { colour, drawPixels } from "../painter/maps.ts";
import { gridOf } from "../solving/lattices.ts";
import { resultOf } from "../solving/studio.ts";
import { gallery } from "../state/gallery.ts";
import { onPlane } from "../state/plane.ts";
import { sceneOf } from "../state/scene_file.ts";
import type { Slot, State, Vec3 } from "../state/types.ts";

/** Size of a picture in px, and its samples along a side. */
const [WIDE, HIGH] = [240, 150];
const SAMPLES = 110;

/** Paints a scene's slice: of A, or for a comparison of A on the left and B on the right; with its beads and spheres. */
async function paint({ engine, theme }: Context, canvas: HTMLCanvasElement, state: State): Promise<void> {
  const plane: State["plane"] = state.view === "planes" ? { ...state.plane, axis: "y" } : state.plane;
  const slots: Slot[] = state.level === "compare" ? [0, 1] : [0];
  const results = [];
  for (const slot of slots) results.push(resultOf(await engine.slow.update(JSON.stringify(sceneOf(state, slot)), [gridOf(state, SAMPLES, plane)], null, true)));
  const lattices = results.flatMap(({ lattice }) => lattice ?? []);
  if (lattices.length < slots.length) return;
  const look = lookOf({ state, results, frame: null }, theme);
  const crop = (up: number) => 0.5 + ((up - 0.5) * HIGH) / WIDE;
  drawPixels(canvas, (right, up) => colour(look, ...sampleAt(lattices[right < 0.5 ? 0 : slots.length - 1], right, crop(up))));
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = "#fff";
  if (slots.length > 1) pen.fillRect(WIDE / 2 - 0.5, 0, 1, HIGH);
  const round = (place: Vec3, radius: number, ink: string) => {
    const [right, up, off] = onPlane(plane, place);
    pen.fillStyle = ink;
    pen.beginPath();
    pen.arc(WIDE * right, HIGH / 2 - WIDE * (up - 0.5), radius, 0, 2 * Math.PI);
    if (Math.abs(off) < 0.02) pen.fill();
  };
  for (const each of state.obstacles) if ("radius" in each) round(each.center, (WIDE * each.radius) / plane.size, "#8b98a8");
  if (state.signature) for (const point of state.points) round(point, 5, "#f2e6cc");
}

/** Shows the dialog; a chosen scene replaces the state. Undo restores the old state. */
export function showGallery(context: Context): void {
  const { studio, say, language } = context;
  const pictures: (() => Promise<void>)[] = [];
  const cards = gallery.map(({ name, line, state }) => {
    const word = (pair: string[]) => pair[language === "ja" ? 1 : 0];
    const choose = () => {
      dialog.close();
      studio.change({ ...state, level: studio.view.state.level === "engineer" ? "engineer" : state.level });
      context.announce(say("opened", { name: word(name) }));
    };
    const text = element("span", {}, word(line));
    const picture = element("canvas", { width: WIDE, height: HIGH, "aria-hidden": "true" });
    pictures.push(() => paint(context, picture, state));
    return element("li", {}, element("button", { onclick: choose }, picture, element("b", {}, word(name)), text));
  });
  const dialog = context.dialog("gallery", say("gallery"), element("p", {}, say("galleryHint")), element("ul", {}, ...cards));
  // One after another, and none after the dialog is closed.
  void (async () => {
    for (const draw of pictures) if (dialog.open) await draw();
  })();
}
