/** Exchange: opens and saves scenes, drives, arrays and drawings as files. */

import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { drawing } from "../making/drawing.ts";
import { MOST_POINTS } from "../state/initial.ts";
import { noticeOf, refuse, Refusal } from "../state/notice.ts";
import { gridOf, wavelength } from "../solving/lattices.ts";
import { pictured } from "../making/pixels.ts";
import { planesOf } from "../state/plane.ts";
import { stateOf } from "../state/scene_file.ts";
import { resultOf } from "../solving/studio.ts";
import type { Slot } from "../state/types.ts";

/** The longer side of an opened drawing, in m. */
const SIZE = 0.08;

/** Endings of files that are opened as pictures. */
const PICTURES = ["png", "jpg", "jpeg", "webp"];

/** Opens a file according to its ending. */
export async function open(context: Context, file: File): Promise<void> {
  const { studio, engine } = context;
  try {
    const ending = file.name.split(".").at(-1)!.toLowerCase();
    const { state } = studio.view;
    const text = PICTURES.includes(ending) ? "" : await file.text();
    if (PICTURES.includes(ending)) {
      studio.change({ ...(await pictured(file, state.plane, Math.min(SIZE, state.plane.size), wavelength(state) / 2, MOST_POINTS)), path: null });
    } else if (ending === "toml" || ending === "json") {
      studio.change(stateOf(await engine.slots[0].read(text, ending === "toml"), state));
    } else if (ending === "svg") {
      const [x, y] = state.plane.center;
      const contours = drawing(text, Math.min(SIZE, state.plane.size), [x, y, state.plane.z]);
      studio.change({ points: await engine.slots[0].along(contours, MOST_POINTS), pressures: null, path: null });
    } else if (/^index\b.*\bamplitude\b/.test(text)) {
      await compareDrive(context, await engine.slots[0].readDrive(text, file.name), file.name);
    } else if (ending === "csv") {
      studio.change({ array: await engine.slots[0].readArray(text, file.name) });
    } else {
      refuse("file-kind");
    }
    context.alarm("");
    context.announce(context.say("opened", { name: file.name }));
  } catch (error) {
    context.alarm(context.say("unread", { line: noticeOf(error, file.name) }));
  }
}

/** Shows a drive from a file in place of A's drive, with the file's metrics, until the state changes. */
async function compareDrive({ studio, engine }: Context, drive: Float32Array, name: string): Promise<void> {
  const { state, results } = studio.view;
  const grids = planesOf(state).map((plane) => gridOf(state, undefined, plane));
  const result = resultOf(await engine.slow.judged(studio.scene(0), drive, grids, state.ear));
  if (result.refused) throw new Refusal(result.refused);
  studio.show({ points: state.points, results: [result, results[1]], names: [name, ""] });
}

/** Downloads a file to the user. */
export function save(name: string, content: BlobPart, type: string): void {
  const link = element("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Saves the scene as the command line reads it, with slot A's method. */
export async function exportScene({ studio, engine, plain }: Context): Promise<void> {
  await studio.settled();
  const { refused } = studio.view.results[0];
  if (refused) throw new Error(plain(refused));
  save("scene.toml", await engine.slots[0].save(true), "text/plain");
}

/** Saves the drive of the shown slot, as `midair solve -o drive.csv` writes it. */
export async function exportDrive({ studio, engine, alarm, say, plain }: Context, slot: Slot): Promise<void> {
  await studio.settled();
  const { answer, refused } = studio.view.results[slot];
  if (answer) save("drive.csv", await engine.slots[0].writeDrive(studio.scene(slot), answer.drive), "text/csv");
  else if (refused) alarm(say("unsolved", { line: plain(refused) }));
}

/** Saves the figure of the current view, as SVG or as PNG of double resolution. */
export async function exportFigure(svg: string, ending: "png" | "svg"): Promise<void> {
  if (ending === "svg") return save("field.svg", svg, "image/svg+xml");
  const drawn = new Image();
  drawn.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  await drawn.decode();
  const { width, height } = drawn;
  const canvas = element("canvas", { width: 2 * width, height: 2 * height });
  canvas.getContext("2d")!.drawImage(drawn, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => blob && save("field.png", blob, "image/png"));
}
