/** The field on the graphics card: textures of spline coefficients and of colour maps, and the slices drawn with them. */

import { SCALES, SHADES, type Lattice, type Look } from "../state/types.ts";
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

/** The field from a refined lattice, whose samples are so dense that linear interpolation suffices. */
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

/** Computes the samples of a refined lattice. */
const SPREADING = `${SAMPLE}
uniform vec2 size;
in vec2 st;
out vec4 colour;
void main() { colour = vec4(pressure((gl_FragCoord.xy - .5) / (size - 1.)), 0, 1); }`;

/**
 * A refined lattice has this many samples along a side of a cell; only lattices of at most LARGEST samples per side are
 * refined.
 */
const FINER = 6;
const LARGEST = 160;

/** A matrix that maps the unit square to the whole view. */
const FLAT = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, -1, -1, 0, 1];

/** A part of a lattice: left, bottom, right, top, from 0 to 1 along its sides. */
export type Part = readonly [number, number, number, number];
export const ALL: Part = [0, 0, 1, 1];

/** The functions for fields that the painter and the volume need. */
export interface FieldPainter {
  /** Sets the uniforms of `look` that COLOUR needs; the colour map is bound to texture unit 3. */
  setLook(program: Program, look: Look): void;
  /** Paints the lattice over the whole view, opaque. */
  flat(lattice: Lattice, key: string, look: Look): void;
  /** Paints a part of the lattice at its place in the scene. Where the field is quiet the opacity is `least`. */
  placed(view: View, lattice: Lattice, key: string, look: Look, least: number, part: Part): void;
}

export function createField(gl: Gl): FieldPainter {
  const slices = program(gl, VERTEX, fragment(SAMPLE));
  const quick = program(gl, VERTEX, fragment(SPREAD));
  const spreading = program(gl, VERTEX, SPREADING);
  // Without this extension no refined lattice can be painted; an animated wave is then as slow as other pictures.
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

  /**
   * Returns the refined lattice as half floats, which the card interpolates; it is made when a wave first shows the
   * lattice.
   */
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

  /** Sets the uniforms for the whole view. */
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
    to.set("quantity", SHADES.indexOf(look.quantity));
    to.set("turn", [Math.cos(look.turn), Math.sin(look.turn)]);
  }

  /**
   * Draws the lattice with a program whose matrix `aims` sets. A wave is painted again and again, so it uses a refined
   * lattice.
   */
  function draw(lattice: Lattice, key: string, look: Look, least: number, part: Part, aims: (by: Program) => void): void {
    // A field that changes from picture to picture is not refined, because that takes too long.
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
