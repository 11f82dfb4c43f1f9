/** The floor: a grid that fades with the distance. */

import { type Gl, program } from "./gl.ts";
import type { Bounds } from "./stage.ts";
import { aim, type View } from "./view.ts";

const VERTEX = `
uniform mat4 matrix;
uniform vec4 area;
uniform float height;
out vec2 place;
void main() {
  place = area.xy + (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2. - 1.) * area.z;
  gl_Position = matrix * vec4(place, height, 1);
}`;

const FRAGMENT = `
uniform vec4 area, ink;
in vec2 place;
out vec4 colour;
float grid(float step) {
  vec2 x = place / step, wide = max(fwidth(x), 1e-6), away = abs(fract(x - .5) - .5) / wide;
  // Lines less than a few px apart would flicker, so they fade out.
  vec2 line = (1. - clamp(away, 0., 1.)) * smoothstep(.3, .05, wide);
  return max(line.x, line.y);
}
void main() {
  float far = length(place - area.xy) / area.z;
  float alpha = ink.a * max(grid(area.w), .4 * grid(area.w / 5.)) * smoothstep(1., .3, far);
  colour = vec4(ink.rgb * alpha, alpha);
}`;

/** Returns a function that paints the floor at height z (m), with lines `step` and step/5 apart. */
export function createFloor(gl: Gl) {
  const floor = program(gl, VERTEX, FRAGMENT);
  return (view: View, { least, most }: Bounds, z: number, step: number, dark: boolean): void => {
    aim(floor, view);
    const reach = 1.7 * Math.max(most[0] - least[0], most[1] - least[1], most[2] - least[2]);
    floor.set("area", [(least[0] + most[0]) / 2, (least[1] + most[1]) / 2, reach, step]);
    floor.set("height", z);
    floor.set("ink", dark ? [0.5, 0.58, 0.7, 0.3] : [0.35, 0.42, 0.52, 0.32]);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
  };
}
