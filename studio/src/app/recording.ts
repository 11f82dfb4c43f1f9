/** Recording: makes a film, WebM or animated GIF, from pictures of a canvas. */

import { applyPalette, GIFEncoder, quantize } from "gifenc/dist/gifenc.esm.js";

import { element } from "./dom.ts";
import { save } from "./exchange.ts";
import { refuse } from "../state/notice.ts";

/** A rectangle of a canvas, in its own px. */
export interface Part {
  canvas: HTMLCanvasElement;
  box: DOMRect;
}

/** The kinds of films. */
export const FILMS = ["WebM", "GIF"] as const;
export type Film = (typeof FILMS)[number];

/** Time in ms for which the last picture of a WebM film stays, and for each picture of a GIF. */
const LAST = 100;
const EACH = 50;

/** The largest width of a GIF, whose files are large, in px. */
const WIDEST = 720;

const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

/** A recorder: `shoot` adds the current picture of its canvas, `end` returns the film. */
interface Recorder {
  shoot(): void;
  end(): Promise<Blob>;
}

function webm(film: HTMLCanvasElement): Recorder {
  const mimeType = globalThis.MediaRecorder && KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
  if (!mimeType) return refuse("no-webm");
  const stream = film.captureStream(0);
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: 8e6 });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const ended = new Promise((done) => (recorder.onstop = done));
  recorder.start();
  return {
    shoot: () => (stream.getVideoTracks()[0] as CanvasCaptureMediaStreamTrack).requestFrame(),
    async end() {
      await new Promise((done) => setTimeout(done, LAST));
      recorder.stop();
      await ended;
      return new Blob(parts, { type: mimeType });
    },
  };
}

function gif(film: HTMLCanvasElement): Recorder {
  const encoder = GIFEncoder();
  const { width, height } = film;
  return {
    shoot() {
      const { data } = film.getContext("2d")!.getImageData(0, 0, width, height);
      const palette = quantize(data, 256);
      encoder.writeFrame(applyPalette(data, palette), width, height, { palette, delay: EACH });
    },
    async end() {
      encoder.finish();
      return new Blob([encoder.bytes()], { type: "image/gif" });
    },
  };
}

/**
 * Records the pictures for which `act` calls `shoot`, in real time, and saves the film. Its size is that of the first
 * picture.
 */
export async function record(kind: Film, source: () => Part, act: (shoot: () => void) => Promise<void>): Promise<void> {
  const { box } = source();
  const scale = kind === "GIF" ? Math.min(1, WIDEST / box.width) : 1;
  const film = element("canvas", { width: Math.round(scale * box.width), height: Math.round(scale * box.height) });
  const pen = film.getContext("2d", { willReadFrequently: kind === "GIF" })!;
  const recorder = kind === "GIF" ? gif(film) : webm(film);
  await act(() => {
    const { canvas, box } = source();
    pen.drawImage(canvas, box.x, box.y, box.width, box.height, 0, 0, film.width, film.height);
    recorder.shoot();
  });
  const blob = await recorder.end();
  save(`midair.${kind.toLowerCase()}`, blob, blob.type);
}
