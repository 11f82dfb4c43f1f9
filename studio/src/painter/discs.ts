/** The transducers: small shaded cylinders, grey and pulsing with the wave, or in the colours of their phases. */

import { changes } from "../state/changes.ts";
import { COLOUR, type Field } from "./field.ts";
import { type Gl, LOOK_UP, type Program, program, vectors } from "./gl.ts";
import type { Picture } from "./picture.ts";
import { aim, type View } from "./view.ts";

/**
 * Strips on the visible half of a cylinder's side; fewer above this number of cylinders, which are then small. Software
 * rendering takes 1 us per vertex.
 */
const STRIPS = [5, 3];
const MANY = 400;

/** Height of a cylinder, in radii. */
export const HEIGHT = 0.9;

/** GLSL for all parts of a cylinder: `across` gives one of the directions perpendicular to the axis. */
const CAN = `${LOOK_UP}
uniform sampler2D positions, normals, drives;
uniform mat4 matrix;
uniform vec3 eye, metal, off;
uniform float radius;
const vec3 light = vec3(-.3216, -.4594, .8270);
vec3 across(vec3 n) {
  // Frisvad's formula, which needs a branch only for normals straight down.
  return n.z < -.9999 ? vec3(0, -1, 0) : vec3(1. - n.x*n.x/(1. + n.z), -n.x*n.y/(1. + n.z), -n.x);
}`;

/** A strip around the half of the side that faces the camera. */
const SIDE_VERTEX = `${CAN}
uniform float strips;
out vec3 paint;
void main() {
  int all = int(strips), can = gl_VertexID / (6 * all), k = corner();
  vec3 position = vectorOf(positions, can).xyz, normal = vectorOf(normals, can).xyz;
  vec3 to = eye - position, sight = to - normal * dot(normal, to);
  vec3 a = length(sight) > 1e-6 ? normalize(sight) : across(normal);
  float turn = (float(gl_VertexID / 6 % all + (k & 1)) / strips - .5) * 3.1415927;
  vec3 outward = cos(turn) * a + sin(turn) * cross(normal, a);
  paint = metal * .4 * (1. + max(dot(outward, light), 0.));
  gl_Position = matrix * vec4(position + radius * (outward - normal * ${HEIGHT} * float(k >> 1)), 1);
}`;

const SIDE_FRAGMENT = `
in vec3 paint;
out vec4 colour;
void main() { colour = vec4(paint, 1); }`;

const FACE_VERTEX = `${CAN}${COLOUR}
uniform float known;
uniform vec3 lit;
out vec3 outward;
out vec2 at;
flat out vec3 axis, halfway, face, rim;
void main() {
  int can = gl_VertexID / 3;
  vec3 position = vectorOf(positions, can).xyz, normal = vectorOf(normals, can).xyz;
  vec2 drive = vectorOf(drives, can).xy;
  vec3 a = across(normal), to = normalize(eye - position);
  // A triangle that contains the disc.
  at = vec2[3](vec2(0, 2), vec2(-1.7320508, -1), vec2(1.7320508, -1))[gl_VertexID % 3];
  outward = a * at.x + cross(normal, a) * at.y;
  axis = normal;
  halfway = normalize(light + to);
  bool back = dot(normal, to) < 0.;
  // The discs are dim, so that the field is the brightest part; at a crest of the wave a disc is bright.
  float t = shade(drive), share = quantity < .5 ? 0. : quantity < 1.5 ? t * t : .72 * min(length(drive), 1.);
  face = back ? metal * .45 : mix(off, quantity < 1.5 ? lit : entry(t), known * share);
  rim = back ? face : metal * (.5 + .5 * max(dot(normal, light), 0.));
  // A transducer is a cylinder, closed at its back.
  gl_Position = matrix * vec4(position + radius * (back ? outward - normal * ${HEIGHT} : outward), 1);
}`;

const FACE_FRAGMENT = `
const vec3 light = vec3(-.3216, -.4594, .8270);
in vec3 outward;
in vec2 at;
flat in vec3 axis, halfway, face, rim;
out vec4 colour;
void main() {
  float r = length(at), soft = max(fwidth(r), 1e-4), alpha = 1. - smoothstep(1. - soft, 1., r);
  if (alpha <= 0.) discard;
  // A concave face inside a metal ring.
  vec3 dish = normalize(axis - .5 * smoothstep(.1, .8, r) * outward);
  float gloss = pow(max(dot(dish, halfway), 0.), 96.);
  vec3 inner = face * (.62 + .42 * max(dot(dish, light), 0.)) + .10 * gloss;
  inner = mix(inner, rim + .08 * gloss, smoothstep(.80 - soft, .80 + soft, r));
  inner *= 1. - .35 * (1. - smoothstep(0., .09, abs(r - .80)));
  colour = vec4(inner * alpha, alpha);
}`;

const radii = new WeakMap<Float32Array, number>();

/**
 * Returns the radius (m) of cylinders that do not touch, at most 5 mm, from the distances to the first 64 transducers. It is
 * computed once for each array.
 */
export function canRadius(positions: Float32Array): number {
  const known = radii.get(positions);
  if (known) return known;
  let least = 0.01087;
  for (let i = 0; i < Math.min(positions.length, 3 * 64); i += 3) {
    const [x, y, z] = positions.subarray(i, i + 3);
    for (let j = 0; j < positions.length; j += 3) {
      const away = Math.hypot(positions[j] - x, positions[j + 1] - y, positions[j + 2] - z);
      if (away > 0 && away < least) least = away;
    }
  }
  radii.set(positions, 0.46 * least);
  return 0.46 * least;
}

/** Returns a function that paints the transducers of a picture. */
export function createDiscs(gl: Gl, field: Field): (view: View, picture: Picture) => void {
  const sides = program(gl, SIDE_VERTEX, SIDE_FRAGMENT);
  const faces = program(gl, FACE_VERTEX, FACE_FRAGMENT);
  const lists = { positions: vectors(gl, 3), normals: vectors(gl, 3), drives: vectors(gl, 2) };
  const placed = changes(lists.positions.set);
  const turned = changes(lists.normals.set);
  const driven = changes(lists.drives.set);
  let unknown = new Float32Array(0);

  return (view, picture) => {
    const count = picture.positions.length / 3;
    placed(picture.positions);
    turned(picture.normals);
    const known = picture.drive?.length === 2 * count;
    if (unknown.length !== 2 * count) unknown = new Float32Array(2 * count);
    driven(known ? picture.drive! : unknown);
    const dark = picture.theme === "dark";
    const draw = (part: Program, corners: number) => {
      aim(part, view);
      Object.entries(lists).forEach(([name, list], unit) => part.bind(name, unit, gl.TEXTURE_2D, list.texture));
      part.set("radius", canRadius(picture.positions));
      part.set("metal", dark ? [0.34, 0.37, 0.42] : [0.93, 0.94, 0.96]);
      part.set("off", dark ? [0.1, 0.115, 0.14] : [0.78, 0.8, 0.83]);
      part.set("lit", dark ? [0.62, 0.68, 0.76] : [0.36, 0.4, 0.46]);
      part.set("known", known ? 1 : 0);
      gl.drawArrays(gl.TRIANGLES, 0, corners * count);
    };
    const strips = STRIPS[Number(count > MANY)];
    sides.use();
    sides.set("strips", strips);
    draw(sides, 6 * strips);
    faces.use();
    field.setLook(faces, { ...picture.look, top: 1, quantity: picture.discs });
    draw(faces, 3);
  };
}
