/** The painter: one WebGL2 context for one canvas behind the page, with any number of views on it. */

import type { Lattice, Vec3 } from "../state/types.ts";
import { along, dot } from "./camera.ts";
import { canRadius, createDiscs, HEIGHT } from "./discs.ts";
import { ALL, createField, type Part } from "./field.ts";
import { createFloor } from "./floor.ts";
import type { Gl } from "./gl.ts";
import { createLabels } from "./labels.ts";
import { createLines } from "./lines.ts";
import { roundStep } from "./maps.ts";
import type { Box, Painter, Picture } from "./picture.ts";
import { createSolids, wallLines } from "./solids.ts";
import { axes, boundsOf, guides, scaleBar } from "./stage.ts";
import { type Area, areaOf, enter, makeView } from "./view.ts";
import { createVolume } from "./volume.ts";

/** Steps of a ray through the volume: at rest, and while something moves. */
const STEPS = [96, 48];

/** The quarters of a slice. */
const QUARTERS: Part[] = [0, 0.5].flatMap((s) => [0, 0.5].map((t): Part => [s, t, s + 0.5, t + 0.5]));

/** Makes the functions that paint flat slices and the 3-D scene, with programs of this context. */
function createScene(gl: Gl) {
  const field = createField(gl);
  const volume = createVolume(gl, field);
  const discs = createDiscs(gl, field);
  const lines = createLines(gl);
  const solids = createSolids(gl);
  const floor = createFloor(gl);
  const labels = createLabels(gl);

  function scene(box: Box, area: Area, picture: Picture, ratio: number): void {
    const { camera, slices, obstacles, look } = picture;
    const view = makeView(camera, box, area, ratio);
    const bounds = boundsOf(picture.positions, picture.points);
    const plane = bounds.least[2];
    const ground = plane - HEIGHT * canRadius(picture.positions);
    const dark = picture.theme === "dark";
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const step = roundStep(
      Math.max(bounds.most[0] - bounds.least[0], bounds.most[1] - bounds.least[1], 0.1) / 4.5,
    );
    floor(view, bounds, ground, step, dark);
    discs(view, picture);
    solids.balls(view, obstacles);
    const bar = scaleBar(picture);
    const marks = axes(camera, bounds, ground, picture.theme);
    lines(view, [...marks.lines, ...guides(picture, plane), ...wallLines(obstacles, bounds)]);
    solids.walls(view, obstacles, bounds);

    const steps = STEPS[picture.moving ? 1 : 0];
    const glow = (side: { normal: Vec3; through: Vec3 } | null) => {
      if (picture.volume) volume(view, picture.volume, look, obstacles, steps, side);
    };
    const opacity = dark ? 0.34 : 0.42;
    if (slices.length > 1) {
      // Slices that cross are painted in quarters, the most distant first.
      const place = ({ corner, u, v }: Lattice, [s, t]: number[]) => along(along(corner, s, u), t, v);
      const away = ({ lattice, part: [a, b, c, d] }: (typeof quarters)[number]) => {
        const to = along(place(lattice, [(a + c) / 2, (b + d) / 2]), -1, view.eye);
        return dot(to, to);
      };
      const quarters = slices.flatMap(({ lattice, key }) => QUARTERS.map((part) => ({ lattice, key, part })));
      gl.depthMask(false);
      for (const { lattice, key, part } of quarters.toSorted((a, b) => away(b) - away(a))) field.placed(view, lattice, key, look, opacity, part);
      gl.depthMask(true);
    } else if (slices.length) {
      const [slice] = slices;
      // The glow behind the slice is painted before it, the glow in front of it after it.
      const { corner, u, v } = slice.lattice;
      const away: Vec3 = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const size = Math.sqrt(dot(away, away)) * (dot(along(view.eye, -1, corner), away) < 0 ? -1 : 1);
      const normal: Vec3 = [away[0] / size, away[1] / size, away[2] / size];
      glow({ normal: [-normal[0], -normal[1], -normal[2]], through: corner });
      gl.depthMask(false);
      field.placed(view, slice.lattice, slice.key, look, opacity, ALL);
      gl.depthMask(true);
      glow({ normal, through: corner });
    } else {
      glow(null);
    }
    lines(view, bar.lines);
    labels(view, [...marks.labels, ...bar.labels]);
    gl.disable(gl.DEPTH_TEST);
  }
  return { flat: field.flat, scene };
}

/** Makes a WebGL2 painter on `canvas`; returns null if the browser has no WebGL2 (then use `createFlat`). */
export function createPainter(canvas: HTMLCanvasElement): Painter | null {
  const gl = canvas.getContext("webgl2", {
    alpha: false,
    antialias: false,
    powerPreference: "high-performance",
  });
  if (!gl) return null;
  let page = { height: 0, ratio: 1 };
  let lost = false;
  let built = createScene(gl);

  const lose = (event: Event) => {
    // Without this call the browser does not restore the context.
    event.preventDefault();
    lost = true;
  };
  const restore = () => {
    built = createScene(gl);
    lost = false;
    painter.onRestored?.();
  };
  canvas.addEventListener("webglcontextlost", lose);
  canvas.addEventListener("webglcontextrestored", restore);

  const { UNMASKED_RENDERER_WEBGL: name = gl.RENDERER } = gl.getExtension("WEBGL_debug_renderer_info") ?? {};
  const painter: Painter = {
    runs: true,
    slow: /software|swiftshader|llvmpipe|basic render/i.test(gl.getParameter(name)),
    begin(width, height, ratio, background) {
      page = { height, ratio };
      const size = [Math.round(width * ratio), Math.round(height * ratio)];
      if (canvas.width !== size[0]) canvas.width = size[0];
      if (canvas.height !== size[1]) canvas.height = size[1];
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.disable(gl.SCISSOR_TEST);
      const [red, green, blue] = background;
      gl.clearColor(red / 255, green / 255, blue / 255, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.enable(gl.SCISSOR_TEST);
    },
    slice(box, lattice, key, look, clip = box) {
      if (lost || clip.width <= 0 || clip.height <= 0) return;
      enter(gl, areaOf(box, page.height, page.ratio), areaOf(clip, page.height, page.ratio));
      built.flat(lattice, key, look);
    },
    scene(box, picture) {
      if (lost) return;
      const area = areaOf(box, page.height, page.ratio);
      enter(gl, area);
      built.scene(box, area, picture, page.ratio);
    },
    get lost() {
      return lost;
    },
    onRestored: null,
    dispose() {
      canvas.removeEventListener("webglcontextlost", lose);
      canvas.removeEventListener("webglcontextrestored", restore);
      gl.getExtension("WEBGL_lose_context")?.loseContext();
    },
  };
  return painter;
}
