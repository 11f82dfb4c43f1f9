/** Short functions for WebGL2: programs, textures, and vectors that shaders read by index. */

export type Gl = WebGL2RenderingContext;

/** A program, with its uniforms by name. */
export interface Program {
  use(): void;
  /** Sets a uniform: one number, a vector of 2, 3 or 4 numbers, or a matrix of 16. */
  set(name: string, value: number | readonly number[]): void;
  /** Binds the texture to this unit. */
  bind(name: string, unit: number, target: number, texture: WebGLTexture): void;
}

const HEAD = "#version 300 es\nprecision highp float;precision highp int;precision highp sampler3D;\n";

/** Compiles and links a program. It has no attributes: shaders use gl_VertexID to tell vertices apart. */
export function program(gl: Gl, vertex: string, fragment: string): Program {
  const linked = gl.createProgram();
  for (const [type, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(type)!;
    gl.shaderSource(shader, HEAD + text);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
    gl.deleteShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
    }
  }
  gl.linkProgram(linked);
  const places = new Map<string, WebGLUniformLocation | null>();
  const place = (name: string) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(linked, name));
    return places.get(name)!;
  };
  return {
    use: () => gl.useProgram(linked),
    set(name, value) {
      const at = place(name);
      if (typeof value === "number") gl.uniform1f(at, value);
      else if (value.length === 2) gl.uniform2fv(at, value);
      else if (value.length === 3) gl.uniform3fv(at, value);
      else if (value.length === 4) gl.uniform4fv(at, value);
      else gl.uniformMatrix4fv(at, false, value);
    },
    bind(name, unit, target, texture) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(target, texture);
      gl.uniform1i(place(name), unit);
    },
  };
}

/** Vectors per row of the texture. */
const ROW = 1024;

/**
 * GLSL: `vectorOf` reads a vector of a texture; `corner` returns the corner, 0 to 3, of the quad (two triangles) of a
 * vertex.
 */
export const LOOK_UP = `
vec4 vectorOf(sampler2D vectors, int index) { return texelFetch(vectors, ivec2(index % ${ROW}, index / ${ROW}), 0); }
int corner() { return int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6]; }`;

/**
 * Makes a texture of vectors of this many numbers, which vertex shaders read by index. Instanced drawing would be slow with
 * software rendering.
 */
export function vectors(gl: Gl, size: 2 | 3 | 4) {
  const map = texture(gl, gl.TEXTURE_2D, gl.NEAREST);
  const [internal, format] = { 2: [gl.RG32F, gl.RG], 3: [gl.RGB32F, gl.RGB], 4: [gl.RGBA32F, gl.RGBA] }[size];
  return {
    texture: map,
    set(data: ArrayLike<number>): void {
      const rows = Math.max(1, Math.ceil(data.length / size / ROW));
      const padded = new Float32Array(rows * ROW * size);
      padded.set(data);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, map);
      gl.texImage2D(gl.TEXTURE_2D, 0, internal, ROW, rows, 0, format, gl.FLOAT, padded);
    },
  };
}

/** Makes a texture, bound to unit 0, which is clamped at its edges. */
export function texture(gl: Gl, target: number, filter: number): WebGLTexture {
  const map = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(target, map);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
    gl.texParameteri(target, wrap, gl.CLAMP_TO_EDGE);
  }
  return map;
}
