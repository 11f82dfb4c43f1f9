/** The field on the graphics card: textures of spline coefficients and of maps, slices drawn with them. */

import { QUANTITIES, SCALES, type Lattice, type Look } from "../types.ts";
import { type Gl, type Program, program, texture } from "./gl.ts";
import { coefficients } from "./lattice.ts";
import { mapOf, RANGE, TABLES } from "./maps.ts";
import { aim, type Area, enter, type View } from "./view.ts";

/** `tone`, `shade` and `entry` of maps.ts in GLSL. */
export const COLOUR = `
uniform sampler2D map;
uniform float top, scale, quantity;
uniform vec2 turn;
float tone(float modulus) {
  float ratio = modulus / top;
  float t = scale < .5 ? ratio : scale < 1.5 ? ratio * ratio
    : 1. + 20. / ${RANGE}. * log(max(ratio, 1e-9)) / log(10.);
  return clamp(t, 0., 1.);
}
float shade(vec2 p) {
  return quantity < .5 ? tone(length(p)) : quantity < 1.5 ? clamp(.5 + .5 * dot(p, turn) / top, 0., 1.) : .5 + atan(p.y, p.x) / 6.2831853;
}
vec3 entry(float t) { return texture(map, vec2((t * 255. + .5) / 256., .5)).rgb; }`;

/** `sampleAt` of lattice.ts in GLSL. */
const SAMPLE = `
uniform sampler2D field;
vec4 weights(float f) {
  float g = 1. - f;
  return vec4(g*g*g, 3.*f*f*f - 6.*f*f + 4., 3.*g*g*g - 6.*g*g + 4., f*f*f) / 6.;
}
vec2 pressure(vec2 st) {
  vec2 count = vec2(textureSize(field, 0) - 2);
  vec2 x = clamp(st, 0., 1.) * (count - 1.);
  vec2 i = min(floor(x), count - 2.);
  vec4 across = weights(x.x - i.x), up = weights(x.y - i.y);
  vec2 sum = vec2(0);
  for (int b = 0; b < 4; b++) for (int a = 0; a < 4; a++)
    sum += up[b] * across[a] * texelFetch(field, ivec2(i) + ivec2(a, b), 0).rg;
  return sum;
}`;

/** The field from a spread lattice: its places are so near to one another that straight lines between them do. */
const SPREAD = `
uniform sampler2D field;
vec2 pressure(vec2 st) {
  vec2 count = vec2(textureSize(field, 0));
  return texture(field, (st * (count - 1.) + .5) / count).rg;
}`;

const VERTEX = `
uniform mat4 matrix;
uniform vec3 corner, u, v;
uniform vec4 part;
out vec2 st;
void main() {
  st = mix(part.xy, part.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
  gl_Position = matrix * vec4(corner + st.x * u + st.y * v, 1);
}`;

const fragment = (sample: string) => `${COLOUR}${sample}
uniform float least;
in vec2 st;
out vec4 colour;
void main() {
  vec2 p = pressure(st);
  float alpha = mix(least, 1., smoothstep(0., .45, tone(length(p))));
  colour = vec4(entry(shade(p)) * alpha, alpha);
}`;

/** The values at each place of a spread lattice. */
const SPREADING = `${SAMPLE}
uniform vec2 size;
in vec2 st;
out vec4 colour;
void main() { colour = vec4(pressure((gl_FragCoord.xy - .5) / (size - 1.)), 0, 1); }`;

/** This many places of a spread lattice lie along a side of a cell, in a lattice of at most this many along its own side. */
const FINER = 6;
const LARGEST = 160;

/** Takes the unit square to all of the view. */
const FLAT = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, -1, -1, 0, 1];

/** The range of a lattice, right and up, in its sides. */
export type Part = readonly [number, number, number, number];
export const ALL: Part = [0, 0, 1, 1];

/** The functions of fields that the painter and the volume need. */
export interface FieldPainter {
  /** The uniforms of `look` that COLOUR needs; the map goes to texture unit 3. */
  setLook(program: Program, look: Look): void;
  /** The lattice over all of the view, opaque. */
  flat(lattice: Lattice, key: string, look: Look): void;
  /** Part of the lattice where it lies, clear where it is quiet: there its opacity is `least`. */
  placed(view: View, lattice: Lattice, key: string, look: Look, least: number, part: Part): void;
}

export function createField(gl: Gl): FieldPainter {
  const slices = program(gl, VERTEX, fragment(SAMPLE));
  const quick = program(gl, VERTEX, fragment(SPREAD));
  const spreading = program(gl, VERTEX, SPREADING);
  // Without it a spread lattice cannot be painted: waves are then as slow as all else.
  const spreads = gl.getExtension("EXT_color_buffer_float") !== null;
  const frame = gl.createFramebuffer();
  const maps = new Map(
    Object.entries(TABLES).map(([name, table]) => {
      const made = texture(gl, gl.TEXTURE_2D, gl.LINEAR);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, table);
      return [name, made];
    }),
  );
  interface Kept {
    texture: WebGLTexture;
    values: Float32Array | null;
  }
  const fields = new Map<string, Kept>();
  const spread = new Map<string, Kept>();

  function upload(lattice: Lattice, key: string): WebGLTexture {
    const kept = fields.get(key) ?? { texture: texture(gl, gl.TEXTURE_2D, gl.NEAREST), values: null };
    fields.set(key, kept);
    if (kept.values !== lattice.values) {
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, kept.texture);
      const { nu, nv } = lattice;
      const data = coefficients(lattice);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, nu + 2, nv + 2, 0, gl.RG, gl.FLOAT, data);
      kept.values = lattice.values;
    }
    return kept.texture;
  }

  /** A lattice as half floats between which the card interpolates; made when a wave first shows it. */
  function spreadOut(lattice: Lattice, key: string): WebGLTexture {
    const kept = spread.get(key) ?? { texture: texture(gl, gl.TEXTURE_2D, gl.LINEAR), values: null };
    spread.set(key, kept);
    if (kept.values === lattice.values) return kept.texture;
    kept.values = lattice.values;
    const data = upload(lattice, key);
    const size = [lattice.nu, lattice.nv].map((count) => FINER * (count - 1) + 1);
    gl.bindTexture(gl.TEXTURE_2D, kept.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG16F, size[0], size[1], 0, gl.RG, gl.HALF_FLOAT, null);
    const [area, clip] = [gl.getParameter(gl.VIEWPORT), gl.getParameter(gl.SCISSOR_BOX)] as Area[];
    const tested = gl.isEnabled(gl.DEPTH_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, kept.texture, 0);
    enter(gl, [0, 0, size[0], size[1]]);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    spreading.use();
    flatten(spreading);
    spreading.set("size", size);
    spreading.bind("field", 0, gl.TEXTURE_2D, data);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.enable(gl.BLEND);
    if (tested) gl.enable(gl.DEPTH_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    enter(gl, area, clip);
    return kept.texture;
  }

  /** Over all of the view. */
  function flatten(by: Program): void {
    by.set("matrix", FLAT);
    by.set("corner", [0, 0, 0]);
    by.set("u", [1, 0, 0]);
    by.set("v", [0, 1, 0]);
    by.set("part", ALL);
  }

  function setLook(to: Program, look: Look): void {
    to.bind("map", 3, gl.TEXTURE_2D, maps.get(mapOf(look))!);
    to.set("top", look.top);
    to.set("scale", SCALES.indexOf(look.scale));
    to.set("quantity", QUANTITIES.indexOf(look.quantity));
    to.set("turn", [Math.cos(look.turn), Math.sin(look.turn)]);
  }

  /** Draws the lattice by a program that `aims` where; a wave, which is painted again and again, from a spread lattice. */
  function draw(lattice: Lattice, key: string, look: Look, least: number, part: Part, aims: (by: Program) => void): void {
    // A field that changes from picture to picture is not spread: that would take too long.
    const still = fields.get(key)?.values === lattice.values;
    const is = still && spreads && look.quantity === "wave" && Math.max(lattice.nu, lattice.nv) <= LARGEST;
    const data = is ? spreadOut(lattice, key) : upload(lattice, key);
    const by = is ? quick : slices;
    by.use();
    aims(by);
    by.bind("field", 0, gl.TEXTURE_2D, data);
    setLook(by, look);
    by.set("least", least);
    by.set("part", part);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  return {
    setLook,
    flat: (lattice, key, look) => draw(lattice, key, look, 1, ALL, flatten),
    placed: (view, lattice, key, look, least, part) =>
      draw(lattice, key, look, least, part, (by) => {
        aim(by, view);
        by.set("corner", lattice.corner);
        by.set("u", lattice.u);
        by.set("v", lattice.v);
      }),
  };
}
