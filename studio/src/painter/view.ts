/** The camera in the form that shaders need. */

import { type Camera, FOCAL, frame } from "./camera.ts";
import type { Gl, Program } from "./gl.ts";
import type { Box } from "./picture.ts";
import type { Vec3 } from "../state/types.ts";

/** Left, bottom, width, height of a part of the canvas, in device px. */
export type Area = [number, number, number, number];

/** A view while it is painted: its part of the canvas, its matrix, its size in device px, the place of the camera. */
export interface View {
  area: Area;
  matrix: number[];
  size: [number, number];
  ratio: number;
  eye: Vec3;
}

/** Returns the view of a camera; its matrix from m to clip space is the same projection as `project`. */
export function makeView(camera: Camera, box: Box, area: Area, ratio: number): View {
  const { right, up, ahead, eye } = frame(camera);
  const near = 0.02 * camera.distance;
  const far = 30 * camera.distance;
  const rows = [
    { axis: right, scale: (2 * FOCAL * box.height) / box.width, add: 0 },
    { axis: up, scale: 2 * FOCAL, add: 0 },
    { axis: ahead, scale: (far + near) / (far - near), add: (-2 * far * near) / (far - near) },
    { axis: ahead, scale: 1, add: 0 },
  ];
  const matrix: number[] = [];
  for (let column = 0; column < 4; column++) {
    for (const { axis, scale, add } of rows) {
      const moved = axis[0] * eye[0] + axis[1] * eye[1] + axis[2] * eye[2];
      matrix.push(column < 3 ? scale * axis[column] : add - scale * moved);
    }
  }
  return { area, matrix, size: [area[2], area[3]], ratio, eye };
}

/** Returns the part of the canvas for `box`, on a page `height` CSS px high. */
export function areaOf(box: Box, height: number, ratio: number): Area {
  const left = Math.round(box.x * ratio);
  const bottom = Math.round((height - box.y - box.height) * ratio);
  return [left, bottom, Math.round(box.width * ratio), Math.round(box.height * ratio)];
}

/** Restricts drawing to `clip`, by default all of `area`, from now on. */
export function enter(gl: Gl, area: Area, clip = area): void {
  gl.viewport(...area);
  gl.scissor(...clip);
}

/** Sets the uniforms that all programs of the 3-D view have. */
export function aim(program: Program, view: View): void {
  program.use();
  program.set("matrix", view.matrix);
  program.set("eye", view.eye);
}
