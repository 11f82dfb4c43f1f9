/** What painter.browser.mjs runs in the page: slices read back, and a scene to look at. */

import { fit } from "../src/painter/camera.ts";
import { createFlat } from "../src/painter/canvas2d.ts";
import { sampleAt } from "../src/painter/lattice.ts";
import { colour } from "../src/painter/maps.ts";
import { createPainter } from "../src/painter/painter.ts";
import type { Painter, Picture } from "../src/painter/picture.ts";
import { type Look, MAPS, SCALES, type Vec3, type Volume } from "../src/types.ts";
import { focused, plane, pressure, square } from "./field.ts";

function canvas(): HTMLCanvasElement {
  const made = document.createElement("canvas");
  document.body.append(made);
  return made;
}

function read(from: HTMLCanvasElement, x: number, y: number): number[] {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [1, 1];
  const pen = copy.getContext("2d")!;
  pen.drawImage(from, -x, -y);
  return [...pen.getImageData(0, 0, 1, 1).data];
}

/** The greatest difference (of 255) of a painted slice from `colour(look, |sample|)` at 50 places a look. */
function worst(painter: Painter, on: HTMLCanvasElement): number {
  const positions = square(10);
  const lattice = plane(positions, focused(positions, [[0, 0, 0.1], [0.02, 0.01, 0.1]]), 0.1, 0.1, 65);
  const box = { x: 30, y: 20, width: 200, height: 180 };
  let most = 0;
  for (const map of MAPS) {
    for (const scale of SCALES) {
      const look: Look = { map, scale, top: 2500 };
      painter.begin(300, 240, 1, [12, 15, 20]);
      painter.slice(box, lattice, "A", look);
      for (let i = 0; i < 50; i++) {
        const x = Math.floor(((i * 0.7548776662) % 1) * box.width);
        const y = Math.floor(((i * 0.569840291) % 1) * box.height);
        const p = sampleAt(lattice, (x + 0.5) / box.width, 1 - (y + 0.5) / box.height);
        const want = colour(look, Math.hypot(...p));
        const got = read(on, box.x + x, box.y + y);
        want.forEach((value, k) => (most = Math.max(most, Math.abs(value - got[k]))));
      }
      const outside = read(on, box.x - 2, box.y + 5);
      if (outside[0] !== 12) throw new Error(`slice: outside its box the page is ${outside}, 12 15 20 is meant`);
    }
  }
  return most;
}

const points: Vec3[] = [[0, 0, 0.18]];
for (let i = 0; i < 6; i++) {
  points.push([0.055 * Math.cos((i * Math.PI) / 3), 0.055 * Math.sin((i * Math.PI) / 3), 0.18]);
}

function picture(width: number, height: number, theme: Picture["theme"], extras: boolean): Picture {
  const positions = square(30);
  const drive = focused(positions, points);
  for (let i = 0; extras && i < 150; i++) {
    drive[2 * i] *= 0.2;
    drive[2 * i + 1] *= (i % 30) / 30;
  }
  const normals = new Float32Array(positions.length).map((_, i) => (i % 3 === 2 ? 1 : 0));
  const volume: Volume = { least: [-0.08, -0.08, 0.09], most: [0.08, 0.08, 0.29], count: [48, 48, 44], moduli: new Float32Array(48 * 48 * 44) };
  let k = 0;
  for (let z = 0; z < 44; z++) {
    for (let y = 0; y < 48; y++) {
      for (let x = 0; x < 48; x++) {
        const place: Vec3 = [-0.08 + (0.16 * x) / 47, -0.08 + (0.16 * y) / 47, 0.09 + (0.2 * z) / 43];
        volume.moduli[k++] = Math.hypot(...pressure(positions, drive, place));
      }
    }
  }
  const top = Math.hypot(...pressure(positions, drive, points[1]));
  return {
    camera: fit(positions, points, width, height),
    positions,
    normals,
    drive,
    slice: { lattice: plane(positions, drive, 0.18, 0.18, 117), key: "A" },
    volume,
    points,
    obstacles: [],
    look: { map: "viridis", scale: "linear", top: 1.1 * top },
    theme,
    moving: false,
  };
}

let shared: { painter: Painter; canvas: HTMLCanvasElement; picture: Picture } | null = null;

const checks = {
  webgl(): number {
    const on = canvas();
    const painter = createPainter(on);
    if (!painter) throw new Error("painter: this browser has no WebGL2");
    const most = worst(painter, on);
    painter.dispose();
    on.remove();
    return most;
  },
  flat(): number {
    const on = canvas();
    const most = worst(createFlat(on), on);
    on.remove();
    return most;
  },
  /** Paints the scene, waits for it, and says how long it took (ms). */
  scene(width: number, height: number, changes: Partial<Picture>, flat = false): number {
    const on = shared && !flat ? shared.canvas : canvas();
    document.body.style.margin = "0";
    on.style.cssText = `width:${width}px;height:${height}px;display:block`;
    const painter = flat ? createFlat(on) : (shared?.painter ?? createPainter(on)!);
    const base = shared?.picture ?? picture(width, height, "dark", true);
    if (!flat) shared = { painter, canvas: on, picture: base };
    const box = { x: 0, y: 0, width, height };
    const shown = { ...base, camera: fit(base.positions, points, width, height), ...changes };
    const start = performance.now();
    painter.begin(width, height, devicePixelRatio, shown.theme === "dark" ? [12, 15, 20] : [247, 248, 250]);
    painter.scene(box, shown);
    read(on, 1, 1);
    return performance.now() - start;
  },
  /** Loses the context and gets it back; true if the slice is then as it was. */
  async restored(): Promise<boolean> {
    const on = canvas();
    const painter = createPainter(on)!;
    const loser = on.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
    const before = worst(painter, on);
    const back = new Promise<void>((done) => (painter.onRestored = done));
    loser.loseContext();
    await new Promise((done) => setTimeout(done, 50));
    if (!painter.lost) return false;
    loser.restoreContext();
    await back;
    return worst(painter, on) === before && !painter.lost;
  },
};

Object.assign(window, { checks });
