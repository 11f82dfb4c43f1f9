/** The transducers: small lit cans that face their normals, the phase as the colour of the face. */

import { changes, type Gl, program, vertices } from "./gl.ts";
import type { Picture } from "./picture.ts";
import { aim, type View } from "./view.ts";

/** Sides of a can. */
const SIDES = 20;

/** Height of a can, in radii. */
export const HEIGHT = 0.9;

const VERTEX = `
layout(location = 0) in vec4 shape;
layout(location = 1) in vec3 position;
layout(location = 2) in vec3 normal;
layout(location = 3) in vec2 drive;
uniform mat4 matrix;
uniform float radius;
out vec3 outward, place;
out vec2 at;
out vec2 weight;
flat out vec3 axis;
flat out int part;
void main() {
  // Two directions across the normal, by Frisvad's formula, which needs no branch but straight down.
  vec3 n = normal, across = n.z < -.9999 ? vec3(0, -1, 0) : vec3(1. - n.x*n.x/(1. + n.z), -n.x*n.y/(1. + n.z), -n.x);
  vec3 up = cross(n, across);
  at = shape.xy;
  part = int(shape.w);
  axis = n;
  outward = across * at.x + up * at.y;
  weight = drive;
  place = position + radius * (outward + n * shape.z);
  gl_Position = matrix * vec4(place, 1);
}`;

const FRAGMENT = `
uniform vec3 eye, metal, off;
uniform float known, shade;
in vec3 outward, place;
in vec2 at, weight;
flat in vec3 axis;
flat in int part;
out vec4 colour;
void main() {
  float r = length(at), soft = max(fwidth(r), 1e-4);
  if (part == 0) {
    float alpha = shade * (1. - smoothstep(.55, 1.55, r));
    colour = vec4(0, 0, 0, alpha);
    return;
  }
  vec3 n = part == 1 ? normalize(outward) : axis, light = normalize(vec3(-.35, -.5, .9)), to = normalize(eye - place);
  float lit = .42 + .58 * max(dot(n, light), 0.);
  if (part == 1) { colour = vec4(metal * lit * .72, 1); return; }
  if (dot(n, to) < 0.) { colour = vec4(metal * .45, 1.); if (r > 1.) discard; return; }
  float phase = atan(weight.y, weight.x), amplitude = min(length(weight), 1.);
  // One lightness for all phases, about 40 % saturation.
  vec3 hue = vec3(.60, .57, .63) + .205 * cos(phase + vec3(0, -2.0944, 2.0944));
  vec3 face = mix(off, hue, known * amplitude);
  // A dished face in a ring of metal.
  vec3 dish = normalize(n - .5 * smoothstep(.1, .8, r) * outward);
  float gloss = pow(max(dot(reflect(-light, dish), to), 0.), 24.);
  face = face * (.62 + .42 * max(dot(dish, light), 0.)) + .10 * gloss;
  float rim = smoothstep(.80 - soft, .80 + soft, r);
  face = mix(face, metal * (lit + .25 * gloss), rim);
  face *= 1. - .35 * (1. - smoothstep(0., .09, abs(r - .80)));
  float alpha = 1. - smoothstep(1. - soft, 1., r);
  if (alpha <= 0.) discard;
  colour = vec4(face * alpha, alpha);
}`;

/** Corners x, y, z in radii and part: 0 shadow on the floor, 1 side, 2 face. */
function can(): Float32Array<ArrayBuffer> {
  const square = (size: number, z: number, part: number) =>
    [[-1, -1], [1, -1], [-1, 1], [-1, 1], [1, -1], [1, 1]].flatMap(([x, y]) => [size * x, size * y, z, part]);
  const sides: number[] = [];
  for (let i = 0; i < SIDES; i++) {
    const [a, b] = [i, i + 1].map((k) => [Math.cos((2 * Math.PI * k) / SIDES), Math.sin((2 * Math.PI * k) / SIDES)]);
    for (const [corner, z] of [[a, -HEIGHT], [b, -HEIGHT], [a, 0], [a, 0], [b, -HEIGHT], [b, 0]] as const) {
      sides.push(...corner, z, 1);
    }
  }
  return new Float32Array([...square(1.6, -HEIGHT, 0), ...sides, ...square(1, 0, 2)]);
}

/** The radius (m) of cans that do not touch: half of the least distance from any of the first 64, at most 5 mm. */
export function canRadius(positions: Float32Array): number {
  let least = 0.01087;
  for (let i = 0; i < Math.min(positions.length, 3 * 64); i += 3) {
    for (let j = 0; j < positions.length; j += 3) {
      if (i === j) continue;
      const away = Math.hypot(...[0, 1, 2].map((axis) => positions[i + axis] - positions[j + axis]));
      if (away > 0 && away < least) least = away;
    }
  }
  return 0.46 * least;
}

/** Paints the transducers of a picture. */
export function createDiscs(gl: Gl): (view: View, picture: Picture) => void {
  const cans = program(gl, VERTEX, FRAGMENT);
  const mesh = vertices(gl);
  mesh.part(0, [4], 0)(can());
  const setPositions = mesh.part(1, [3], 1);
  const setNormals = mesh.part(2, [3], 1);
  const setDrive = mesh.part(3, [2], 1);
  let radius = 0;
  const placed = changes((positions: Float32Array) => {
    setPositions(new Float32Array(positions));
    radius = canRadius(positions);
  });
  const turned = changes((normals: Float32Array) => setNormals(new Float32Array(normals)));
  const driven = changes((drive: Float32Array) => setDrive(new Float32Array(drive)));
  let unknown = new Float32Array(0);

  return (view, picture) => {
    const count = picture.positions.length / 3;
    placed(picture.positions);
    turned(picture.normals);
    const known = picture.drive?.length === 2 * count;
    if (unknown.length !== 2 * count) unknown = new Float32Array(2 * count);
    driven(known ? picture.drive! : unknown);
    const dark = picture.theme === "dark";
    aim(cans, view);
    cans.set("radius", radius);
    cans.set("metal", dark ? [0.34, 0.37, 0.42] : [0.86, 0.87, 0.9]);
    cans.set("off", dark ? [0.1, 0.115, 0.14] : [0.33, 0.35, 0.39]);
    cans.set("known", known ? 1 : 0);
    cans.set("shade", dark ? 0.4 : 0.22);
    mesh.use();
    gl.depthMask(false);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, count);
    gl.depthMask(true);
    gl.drawArraysInstanced(gl.TRIANGLES, 6, 6 * SIDES + 6, count);
  };
}
