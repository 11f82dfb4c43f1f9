/** The camera as the shaders take it. */

import { type Camera, FOCAL, frame } from "./camera.ts";
import type { Gl, Program } from "./gl.ts";
import type { Box } from "./picture.ts";
import type { Vec3 } from "../types.ts";

/** One view while it is painted: its matrix, its size in device px, the eye. */
export interface View {
  matrix: number[];
  size: [number, number];
  ratio: number;
  eye: Vec3;
  right: Vec3;
  up: Vec3;
  ahead: Vec3;
}

/** The same projection as `project`, as a matrix from m to clip space. */
export function makeView(camera: Camera, box: Box, ratio: number): View {
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
  return { matrix, size: [box.width * ratio, box.height * ratio], ratio, eye, right, up, ahead };
}

/** Draws from now on go to `box` of a page `height` px high, and nowhere else. */
export function enter(gl: Gl, box: Box, height: number, ratio: number): void {
  const left = Math.round(box.x * ratio);
  const bottom = Math.round((height - box.y - box.height) * ratio);
  const size = [Math.round(box.width * ratio), Math.round(box.height * ratio)] as const;
  gl.viewport(left, bottom, ...size);
  gl.scissor(left, bottom, ...size);
}

/** The uniforms that every program of the 3-D view shares. */
export function aim(program: Program, view: View): void {
  program.use();
  program.set("matrix", view.matrix);
  program.set("eye", view.eye);
}
