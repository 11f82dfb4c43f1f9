/** Short forms of WebGL2: programs, buffers of instances, textures. */

export type Gl = WebGL2RenderingContext;

/** A program with its uniforms by name. */
export interface Program {
  use(): void;
  /** One number, or a vector of 2, 3 or 4, or a matrix of 16. */
  set(name: string, value: number | readonly number[]): void;
  /** The texture goes to that unit. */
  bind(name: string, unit: number, target: number, texture: WebGLTexture): void;
}

const HEAD = "#version 300 es\nprecision highp float;precision highp int;precision highp sampler3D;\n";

/** Compiles and links; attributes are bound by `layout(location = ...)` in the source. */
export function program(gl: Gl, vertex: string, fragment: string): Program {
  const linked = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
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

/** A vertex array; `part` adds a buffer of floats that fills attributes of those sizes from location `first`. */
export function vertices(gl: Gl) {
  const array = gl.createVertexArray();
  return {
    use: () => gl.bindVertexArray(array),
    /** `divisor` 0: by vertex, 1: by instance. Returns what sets the buffer's numbers. */
    part(first: number, sizes: number[], divisor: 0 | 1): (data: Float32Array<ArrayBuffer>) => void {
      const buffer = gl.createBuffer();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      const stride = 4 * sizes.reduce((sum, size) => sum + size, 0);
      let offset = 0;
      sizes.forEach((size, i) => {
        gl.enableVertexAttribArray(first + i);
        gl.vertexAttribPointer(first + i, size, gl.FLOAT, false, stride, offset);
        gl.vertexAttribDivisor(first + i, divisor);
        offset += 4 * size;
      });
      return (data) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      };
    },
  };
}

/** A new texture, bound to unit 0, that ends at its edges. */
export function texture(gl: Gl, target: number, filter: number): WebGLTexture {
  const made = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(target, made);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
    gl.texParameteri(target, wrap, gl.CLAMP_TO_EDGE);
  }
  return made;
}

/** Runs `load` when `value` is another object than at the last call. */
export function changes<T>(load: (value: T) => void): (value: T) => void {
  let last: T | undefined;
  return (value) => {
    if (value === last) return;
    last = value;
    load(value);
  };
}
