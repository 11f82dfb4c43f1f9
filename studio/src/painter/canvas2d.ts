/** The painter for browsers without WebGL2: slices pixel by pixel, the 3-D view as dots and lines. */

import type { Lattice, Look, Vec3 } from "../state/types.ts";
import { project } from "./camera.ts";
import { sampleAt } from "./lattice.ts";
import { colour } from "./maps.ts";
import type { Box, Painter, Picture } from "./picture.ts";

/** The largest number of pixels along a side of a slice; larger slices are scaled up. */
const MOST = 256;

/** Draws the slice in pixels of `onto`, with `v` up. */
export function drawSlice(onto: HTMLCanvasElement, lattice: Lattice, look: Look): void {
  const { width, height } = onto;
  const pen = onto.getContext("2d")!;
  const image = pen.createImageData(width, height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const [re, im] = sampleAt(lattice, (x + 0.5) / width, 1 - (y + 0.5) / height);
      image.data.set([...colour(look, re, im), 255], 4 * (y * width + x));
    }
  }
  pen.putImageData(image, 0, 0);
}

/** Makes a painter with the canvas's 2-D context, for browsers where `createPainter` returns null. */
export function createFlat(canvas: HTMLCanvasElement): Painter {
  const pen = canvas.getContext("2d")!;
  const kept = new Map<string, { sheet: HTMLCanvasElement; values: Float32Array | null; look: string }>();

  function path(box: Box, picture: Picture, places: Vec3[]): void {
    pen.beginPath();
    for (const place of places) {
      const [x, y, depth] = project(picture.camera, place, box.width, box.height);
      if (depth > 0) pen.lineTo(box.x + x, box.y + y);
    }
  }

  return {
    begin(width, height, ratio, [red, green, blue]) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      pen.scale(ratio, ratio);
      pen.fillStyle = `rgb(${red} ${green} ${blue})`;
      pen.fillRect(0, 0, width, height);
    },
    slice(box, lattice, key, look, clip = box) {
      const size = [box.width, box.height].map((side) => Math.max(1, Math.min(MOST, Math.round(side))));
      const named = JSON.stringify([look, size]);
      const old = kept.get(key) ?? { sheet: document.createElement("canvas"), values: null, look: "" };
      kept.set(key, old);
      if (old.values !== lattice.values || old.look !== named) {
        [old.sheet.width, old.sheet.height] = size;
        drawSlice(old.sheet, lattice, look);
        old.values = lattice.values;
        old.look = named;
      }
      pen.save();
      pen.beginPath();
      pen.rect(clip.x, clip.y, clip.width, clip.height);
      pen.clip();
      pen.drawImage(old.sheet, box.x, box.y, box.width, box.height);
      pen.restore();
    },
    scene(box, picture) {
      const { positions, drive, slices, points, camera, theme } = picture;
      const ink = theme === "dark" ? "#9aa4b5" : "#4a5260";
      pen.save();
      pen.beginPath();
      pen.rect(box.x, box.y, box.width, box.height);
      pen.clip();
      let least = 0;
      for (let i = 0; i < positions.length; i += 3) {
        const place: Vec3 = [positions[i], positions[i + 1], positions[i + 2]];
        least = i ? Math.min(least, place[2]) : place[2];
        const [x, y, depth] = project(camera, place, box.width, box.height);
        if (depth <= 0) continue;
        const k = (2 * i) / 3;
        const amplitude = drive ? Math.hypot(drive[k], drive[k + 1]) : 0;
        pen.fillStyle = amplitude && picture.discs === "phase" ? `rgb(${colour({ ...picture.look, quantity: "phase" }, drive![k], drive![k + 1])})` : ink;
        pen.beginPath();
        pen.arc(box.x + x, box.y + y, Math.max(1.5, (0.0042 * 1.6 * box.height) / depth), 0, 2 * Math.PI);
        pen.fill();
      }
      pen.strokeStyle = ink;
      for (const { lattice: { corner: c, u, v } } of slices) {
        const at = (s: number, t: number): Vec3 => [0, 1, 2].map((k) => c[k] + s * u[k] + t * v[k]) as Vec3;
        path(box, picture, [at(0, 0), at(1, 0), at(1, 1), at(0, 1), at(0, 0)]);
        pen.stroke();
      }
      for (const point of points) {
        path(box, picture, [point, [point[0], point[1], least]]);
        pen.stroke();
        const [x, y, depth] = project(camera, point, box.width, box.height);
        if (depth <= 0) continue;
        pen.fillStyle = ink;
        pen.beginPath();
        pen.arc(box.x + x, box.y + y, 4, 0, 2 * Math.PI);
        pen.fill();
      }
      pen.restore();
    },
    runs: false,
    slow: true,
    lost: false,
    onRestored: null,
    dispose() {},
  };
}
