/** Lines of any width in px, with soft edges. */

import { type Piece, placeIn } from "./camera.ts";
import { type Gl, LOOK_UP, program, vectors } from "./gl.ts";
import { aim, type View } from "./view.ts";
import type { Vec3 } from "../state/types.ts";

/** Red, green, blue, opacity, all 0 to 1. */
export type Ink = [number, number, number, number];

/** A line from `a` to `b` (m), `width` in CSS px. */
export interface Line {
  a: Vec3;
  b: Vec3;
  ink: Ink;
  width: number;
}

const VERTEX = `${LOOK_UP}
uniform sampler2D ends;
uniform mat4 matrix;
uniform vec2 size;
out float across;
out vec4 paint;
flat out float half_;
void main() {
  int line = 3 * (gl_VertexID / 6), k = corner();
  vec4 a = vectorOf(ends, line), ink = vectorOf(ends, line + 2);
  vec4 p = matrix * vec4(a.xyz, 1), q = matrix * vec4(vectorOf(ends, line + 1).xyz, 1);
  // The part behind the camera is cut off, because the division below needs w > 0.
  float near = .001;
  if (p.w < near) p = mix(p, q, (near - p.w) / max(q.w - p.w, 1e-9));
  if (q.w < near) q = mix(q, p, (near - q.w) / max(p.w - q.w, 1e-9));
  vec2 way = (q.xy / q.w - p.xy / p.w) * size;
  vec2 side = length(way) > 0. ? normalize(vec2(-way.y, way.x)) : vec2(0);
  half_ = max(a.w, 1.) / 2.;
  across = (k & 1) == 0 ? -half_ - 1. : half_ + 1.;
  vec4 end = k < 2 ? p : q;
  gl_Position = end + vec4(side * across * 2. / size * end.w, 0, 0);
  paint = vec4(ink.rgb * ink.a, ink.a) * min(a.w, 1.);
}`;

const FRAGMENT = `
in float across;
in vec4 paint;
flat in float half_;
out vec4 colour;
void main() { colour = paint * clamp(half_ + .5 - abs(across), 0., 1.); }`;

/** Returns the four sides of a flat piece. */
export function outline(piece: Piece, ink: Ink, width: number): Line[] {
  const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([s, t]) => placeIn(piece, s, t));
  return corners.map((a, i) => ({ a, b: corners[(i + 1) % 4], ink, width }));
}

/** Returns the lines of a horizontal circle. */
export function ring(center: Vec3, radius: number, ink: Ink, width: number): Line[] {
  const at = (i: number): Vec3 => {
    const angle = (2 * Math.PI * i) / 28;
    return [center[0] + radius * Math.cos(angle), center[1] + radius * Math.sin(angle), center[2]];
  };
  return Array.from({ length: 28 }, (_, i) => ({ a: at(i), b: at(i + 1), ink, width }));
}

/** Returns a function that paints lines; later ones are painted over earlier ones. */
export function createLines(gl: Gl): (view: View, lines: Line[]) => void {
  const strokes = program(gl, VERTEX, FRAGMENT);
  const ends = vectors(gl, 4);
  return (view, lines) => {
    ends.set(lines.flatMap(({ a, b, ink, width }) => [...a, width * view.ratio, ...b, 0, ...ink]));
    aim(strokes, view);
    strokes.set("size", view.size);
    strokes.bind("ends", 0, gl.TEXTURE_2D, ends.texture);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * lines.length);
    gl.depthMask(true);
  };
}
