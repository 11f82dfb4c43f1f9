/** Recording: pictures of a canvas, one after another, as a film in WebM. */

import { save } from "./exchange.ts";

/** Part of a canvas, in its own px. */
export interface Part {
  canvas: HTMLCanvasElement;
  box: DOMRect;
}

/** The last picture stays for so long, in ms. */
const LAST = 100;

const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

/** Films what `act` shoots of a canvas, as fast as it does, and saves it; the size is that of the first picture. */
export async function record(source: () => Part, act: (shoot: () => void) => Promise<void>): Promise<void> {
  const mimeType = KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
  if (!mimeType) throw new Error("this browser records no WebM: take Chrome, Edge or Firefox");
  const sheet = document.createElement("canvas");
  const { box } = source();
  [sheet.width, sheet.height] = [Math.round(box.width), Math.round(box.height)];
  const pen = sheet.getContext("2d")!;
  const stream = sheet.captureStream(0);
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: 8e6 });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const ended = new Promise((done) => (recorder.onstop = done));
  recorder.start();
  await act(() => {
    const { canvas, box } = source();
    pen.drawImage(canvas, box.x, box.y, box.width, box.height, 0, 0, sheet.width, sheet.height);
    (stream.getVideoTracks()[0] as CanvasCaptureMediaStreamTrack).requestFrame();
  });
  await new Promise((done) => setTimeout(done, LAST));
  recorder.stop();
  await ended;
  save("midair.webm", new Blob(parts, { type: mimeType }), mimeType);
}
