/** The field by the graphics card: a fragment a place, which sums the waves of all transducers. */

import type { Grid } from "../solve.worker.ts";
import { type Gl, LOOK_UP, program, texture, vectors } from "./gl.ts";

/** What the waves of an array are like, as the core has them. */
export interface Waves {
  /** N x 3, m. */
  positions: Float32Array;
  normals: Float32Array;
  /** m. */
  wavelength: number;
  /** p r e^{-jkr} (Pa m) of one transducer at full amplitude, by the cosine of the angle to its normal, from -1 to 1. */
  pattern: Float32Array;
}

/** re and im of p (Pa) of a drive (N of re, im) on a lattice. */
export type Summing = (waves: Waves, drive: Float32Array, grid: Grid) => Float32Array;

const VERTEX = `void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2. - 1., 0, 1); }`;

// Sine and cosine of our own, of half the angle and as polynomials: those of software are off by 4e-4.
const FRAGMENT = `${LOOK_UP}
uniform sampler2D positions, normals, drives, pattern;
uniform vec3 corner, u, v;
uniform vec2 count;
uniform float total, wavelength, steps;
out vec2 sum;
void main() {
  vec2 st = (gl_FragCoord.xy - .5) / (count - 1.);
  vec3 at = corner + st.x * u + st.y * v;
  sum = vec2(0);
  for (int i = 0; i < int(total); i++) {
    vec3 d = at - vectorOf(positions, i).xyz;
    float r = length(d), turns = r / wavelength, y = 3.14159265 * (turns - round(turns)), q = y * y;
    float s = y*(1.-q/6.*(1.-q/20.*(1.-q/42.*(1.-q/72.*(1.-q/110.)))));
    float c = 1.-q/2.*(1.-q/12.*(1.-q/30.*(1.-q/56.*(1.-q/90.*(1.-q/132.)))));
    float x = (dot(d, vectorOf(normals, i).xyz) / r + 1.) / 2. * (steps - 1.), f = min(floor(x), steps - 2.);
    float a = mix(vectorOf(pattern, int(f)).x, vectorOf(pattern, int(f) + 1).x, x - f) / r;
    vec2 wave = a * vec2(1. - 2. * s * s, 2. * s * c), w = vectorOf(drives, i).xy;
    sum += vec2(wave.x * w.x - wave.y * w.y, wave.x * w.y + wave.y * w.x);
  }
}`;

/** The sum on that context; null where it cannot draw into floats. */
export function createSumming(gl: Gl): Summing | null {
  if (!gl.getExtension("EXT_color_buffer_float")) return null;
  const sums = program(gl, VERTEX, FRAGMENT);
  const lists = { positions: vectors(gl, 3), normals: vectors(gl, 3), drives: vectors(gl, 2), pattern: vectors(gl, 1) };
  const sheet = texture(gl, gl.TEXTURE_2D, gl.NEAREST);
  const frame = gl.createFramebuffer();
  return ({ positions, normals, wavelength, pattern }, drive, { corner, u, v, nu, nv }) => {
    lists.positions.set(positions);
    lists.normals.set(normals);
    lists.drives.set(drive);
    lists.pattern.set(pattern);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, sheet);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, nu, nv, 0, gl.RG, gl.FLOAT, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, sheet, 0);
    gl.disable(gl.BLEND);
    gl.disable(gl.SCISSOR_TEST);
    gl.viewport(0, 0, nu, nv);
    sums.use();
    Object.entries(lists).forEach(([name, list], unit) => sums.bind(name, unit, gl.TEXTURE_2D, list.texture));
    sums.set("corner", corner);
    sums.set("u", u);
    sums.set("v", v);
    sums.set("count", [nu, nv]);
    sums.set("total", positions.length / 3);
    sums.set("wavelength", wavelength);
    sums.set("steps", pattern.length);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    // Four numbers a place are what every card gives back.
    const read = new Float32Array(4 * nu * nv);
    gl.readPixels(0, 0, nu, nv, gl.RGBA, gl.FLOAT, read);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return read.filter((_, k) => k % 4 < 2);
  };
}
