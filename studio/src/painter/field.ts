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
const REFINED = `
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
const REFINING = `${SAMPLE}
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

/** A texture, and the values of the lattice that it has. */
interface Uploaded {
  texture: WebGLTexture;
  values: Float32Array | null;
}

/** Sets the uniforms for the whole view. */
function flatten(shader: Program): void {
  shader.set("matrix", FLAT);
  shader.set("corner", [0, 0, 0]);
  shader.set("u", [1, 0, 0]);
  shader.set("v", [0, 1, 0]);
  shader.set("part", ALL);
}

/** The fields and colour maps on the card, each field by its `key`. */
export class Field {
  private readonly sampling: Program;
  private readonly smooth: Program;
  private readonly refining: Program;
  /** Without this extension no refined lattice can be painted; an animated wave is then as slow as other pictures. */
  private readonly refines: boolean;
  private readonly frame: WebGLFramebuffer;
  private readonly maps: Map<string, WebGLTexture>;
  private readonly samples = new Map<string, Uploaded>();
  private readonly refined = new Map<string, Uploaded>();

  constructor(private readonly gl: Gl) {
    this.sampling = program(gl, VERTEX, fragment(SAMPLE));
    this.smooth = program(gl, VERTEX, fragment(REFINED));
    this.refining = program(gl, VERTEX, REFINING);
    this.refines = gl.getExtension("EXT_color_buffer_float") !== null;
    this.frame = gl.createFramebuffer();
    this.maps = new Map(
      Object.entries(TABLES).map(([name, table]) => {
        const map = texture(gl, gl.TEXTURE_2D, gl.LINEAR);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, table);
        return [name, map];
      }),
    );
  }

  /** Sets the uniforms of `look` that COLOUR needs; the colour map is bound to texture unit 3. */
  setLook(shader: Program, look: Look): void {
    shader.bind("map", 3, this.gl.TEXTURE_2D, this.maps.get(mapOf(look))!);
    shader.set("top", look.top);
    shader.set("scale", SCALES.indexOf(look.scale));
    shader.set("quantity", SHADES.indexOf(look.quantity));
    shader.set("turn", [Math.cos(look.turn), Math.sin(look.turn)]);
  }

  /** Paints the lattice over the whole view, opaque. */
  flat(lattice: Lattice, key: string, look: Look): void {
    this.draw(lattice, key, look, 1, flatten);
  }

  /** Paints a part of the lattice at its place in the scene. Where the field is quiet the opacity is `least`. */
  placed(view: View, lattice: Lattice, key: string, look: Look, least: number, part: Part): void {
    this.draw(lattice, key, look, least, (shader) => {
      aim(shader, view);
      shader.set("corner", lattice.corner);
      shader.set("u", lattice.u);
      shader.set("v", lattice.v);
      shader.set("part", part);
    });
  }

  /** Draws the lattice with a program; `aims` sets its matrix and its part. */
  private draw(lattice: Lattice, key: string, look: Look, least: number, aims: (shader: Program) => void): void {
    const { gl } = this;
    // A wave is painted again and again, so it uses a refined lattice. A field that changes from picture to picture is not
    // refined, because that takes too long.
    const still = this.samples.get(key)?.values === lattice.values;
    const refines = still && this.refines && look.quantity === "wave" && Math.max(lattice.nu, lattice.nv) <= LARGEST;
    const data = refines ? this.refine(lattice, key) : this.upload(lattice, key);
    const shader = refines ? this.smooth : this.sampling;
    shader.use();
    aims(shader);
    shader.bind("field", 0, gl.TEXTURE_2D, data);
    this.setLook(shader, look);
    shader.set("least", least);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  /** Returns the texture of a key among some; `fill` is called if it does not have these values. */
  private textureOf(among: Map<string, Uploaded>, key: string, filter: number, { values }: Lattice, fill: (texture: WebGLTexture) => void): WebGLTexture {
    const { gl } = this;
    const entry = among.get(key) ?? { texture: texture(gl, gl.TEXTURE_2D, filter), values: null };
    among.set(key, entry);
    if (entry.values !== values) fill(entry.texture);
    entry.values = values;
    return entry.texture;
  }

  /** Returns the spline coefficients of a lattice as a texture. */
  private upload(lattice: Lattice, key: string): WebGLTexture {
    const { gl } = this;
    return this.textureOf(this.samples, key, gl.NEAREST, lattice, (texture) => {
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, lattice.nu + 2, lattice.nv + 2, 0, gl.RG, gl.FLOAT, coefficients(lattice));
    });
  }

  /** Returns the refined lattice as half floats, which the card interpolates. */
  private refine(lattice: Lattice, key: string): WebGLTexture {
    const { gl, refining } = this;
    return this.textureOf(this.refined, key, gl.LINEAR, lattice, (texture) => {
      const data = this.upload(lattice, key);
      const [width, height] = [lattice.nu, lattice.nv].map((count) => FINER * (count - 1) + 1);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG16F, width, height, 0, gl.RG, gl.HALF_FLOAT, null);
      const [area, clip] = [gl.getParameter(gl.VIEWPORT), gl.getParameter(gl.SCISSOR_BOX)] as Area[];
      const tested = gl.isEnabled(gl.DEPTH_TEST);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      enter(gl, [0, 0, width, height]);
      gl.disable(gl.BLEND);
      gl.disable(gl.DEPTH_TEST);
      refining.use();
      flatten(refining);
      refining.set("size", [width, height]);
      refining.bind("field", 0, gl.TEXTURE_2D, data);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      gl.enable(gl.BLEND);
      if (tested) gl.enable(gl.DEPTH_TEST);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      enter(gl, area, clip);
    });
  }
}
