/** The volume of |p| as a glow: each ray sums samples of a 3-D texture, front to back. */

import type { Look, Obstacle, Vec3, Volume } from "../state/types.ts";
import { dot } from "./camera.ts";
import { COLOUR, type Field } from "./field.ts";
import { modulusAt } from "./maps.ts";
import { changes } from "../state/changes.ts";
import { type Gl, program, texture } from "./gl.ts";
import { aim, enter, type View } from "./view.ts";

/** Number of spheres that can hide the glow behind them; a scene rarely has more. */
const BALLS = 8;

/** Value on the colour map above which the volume glows. Most samples are below it and need one texture read per step. */
const FAINT = { linear: 0.18, squared: 0.06, decibel: 0.5 };

const VERTEX = `
uniform mat4 matrix;
uniform vec3 least, most;
out vec3 place;
void main() {
  // The cube as one strip of 14 vertices. Only its far faces are drawn, so that the camera can be inside.
  int bit = 1 << gl_VertexID;
  place = mix(least, most, vec3((0x287a & bit) != 0, (0x02af & bit) != 0, (0x31e3 & bit) != 0));
  gl_Position = matrix * vec4(place, 1);
}`;

const FRAGMENT = `${COLOUR}
uniform sampler3D moduli;
uniform vec3 eye, least, most;
uniform vec4 plane;
uniform vec4 balls[${BALLS}];
uniform float steps, faint, quiet;
in vec3 place;
out vec4 colour;
void main() {
  vec3 way = place - eye, size = most - least;
  vec3 a = (least - eye) / way, b = (most - eye) / way;
  vec3 low = min(a, b), high = max(a, b);
  float from = max(max(low.x, low.y), max(low.z, 0.)), to = min(min(high.x, high.y), high.z);
  for (int i = 0; i < ${BALLS}; i++) {
    vec3 d = eye - balls[i].xyz;
    float q = dot(way, way), h = dot(way, d), root = h * h - q * (dot(d, d) - balls[i].w * balls[i].w);
    if (balls[i].w > 0. && root > 0.) { float t = -(h + sqrt(root)) / q; if (t > 0.) to = min(to, t); }
  }
  // Only the part of the ray on the plane's positive side.
  float e = dot(plane.xyz, eye) + plane.w, w = dot(plane.xyz, way);
  if (e < 0.) { if (w <= 0.) discard; from = max(from, -e / w); }
  else if (w < 0.) to = min(to, -e / w);
  if (to <= from) discard;
  float stride = length(size) / steps / length(way);
  // A random start of each ray avoids visible bands.
  float start = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(.06711056, .00583715))));
  vec3 cells = vec3(textureSize(moduli, 0));
  vec4 sum = vec4(0);
  for (float t = from + start * stride; t < to; t += stride) {
    vec3 at = (eye + t * way - least) / size;
    float modulus = texture(moduli, (at * (cells - 1.) + .5) / cells).r;
    if (modulus < quiet) continue;
    float tones = tone(modulus), glow = smoothstep(faint, 1., tones);
    float alpha = 1. - exp(-140. / steps * glow);
    // The glow fades out towards the faces of the box, so that it does not end at a visible edge.
    vec3 edge = smoothstep(0., .06, min(at, 1. - at));
    alpha *= edge.x * edge.y * edge.z * (1. - sum.a);
    sum += vec4(entry(tones) * alpha, alpha);
    if (sum.a > .98) break;
  }
  colour = sum;
}`;

const SPREAD_VERTEX = `
out vec2 st;
void main() {
  st = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(st * 2. - 1., 0, 1);
}`;

const SPREAD_FRAGMENT = `
uniform sampler2D glow;
in vec2 st;
out vec4 colour;
void main() { colour = texture(glow, st); }`;

/** The side of a plane at `through` to which `normal` points. */
export interface Side {
  normal: Vec3;
  through: Vec3;
}

/** Returns a function that paints the volume, or only its part on one side of a plane. */
export function createVolume(gl: Gl, field: Field) {
  const glow = program(gl, VERTEX, FRAGMENT);
  const data = texture(gl, gl.TEXTURE_3D, gl.LINEAR);
  // A glow is smooth: it is computed at half the resolution, a quarter of the rays, and then scaled up.
  const spread = program(gl, SPREAD_VERTEX, SPREAD_FRAGMENT);
  const half = texture(gl, gl.TEXTURE_2D, gl.LINEAR);
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, half, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  let size = [0, 0];

  function toHalf(view: View): void {
    const [width, height] = view.size.map((side) => Math.ceil(side / 2));
    if (width !== size[0] || height !== size[1]) {
      size = [width, height];
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, half);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    enter(gl, [0, 0, width, height]);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }

  const upload = changes((volume: Volume) => {
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_3D, data);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R16F, ...volume.count, 0, gl.RED, gl.FLOAT, volume.moduli);
  });
  return (view: View, volume: Volume, look: Look, obstacles: Obstacle[], steps: number, side: Side | null) => {
    upload(volume);
    toHalf(view);
    aim(glow, view);
    field.setLook(glow, { ...look, quantity: "modulus" });
    glow.bind("moduli", 0, gl.TEXTURE_3D, data);
    glow.set("least", volume.least);
    glow.set("most", volume.most);
    glow.set("steps", steps);
    glow.set("faint", FAINT[look.scale]);
    glow.set("quiet", modulusAt(look, FAINT[look.scale]));
    glow.set("plane", side ? [...side.normal, -dot(side.normal, side.through)] : [0, 0, 0, 1]);
    const balls = obstacles.filter((obstacle) => "radius" in obstacle);
    for (let i = 0; i < BALLS; i++) {
      const ball = balls[i];
      glow.set(`balls[${i}]`, ball ? [...ball.center, ball.radius] : [0, 0, 0, 0]);
    }
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    gl.disable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 14);
    gl.disable(gl.CULL_FACE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    enter(gl, view.area);
    spread.use();
    spread.bind("glow", 0, gl.TEXTURE_2D, half);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.enable(gl.DEPTH_TEST);
  };
}
