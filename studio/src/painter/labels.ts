/** Short texts at places of the 3-D view, drawn once by a 2-D canvas. */

import type { Vec3 } from "../state/types.ts";
import { type Gl, LOOK_UP, program, texture, vectors } from "./gl.ts";
import type { Ink } from "./lines.ts";
import { aim, type View } from "./view.ts";

/** A text beside `place` (m), in the direction `away` (of length 1: right, up), where it does not cover other parts. */
export interface Label {
  place: Vec3;
  away: [number, number];
  text: string;
  ink: Ink;
}

const VERTEX = `${LOOK_UP}
uniform sampler2D signs;
uniform mat4 matrix;
uniform vec2 size;
out vec2 at;
out vec4 paint;
void main() {
  int sign = 3 * (gl_VertexID / 6), k = corner();
  vec4 place = vectorOf(signs, sign), p = matrix * vec4(place.xyz, 1);
  vec2 to = vec2(k & 1, k >> 1);
  vec4 box = vectorOf(signs, sign + 1);
  vec2 wide = box.xy;
  // Whole px keep the letters sharp. Labels are shifted so that the view's edge does not cut them.
  vec2 middle = (p.xy / p.w * .5 + .5) * size, left = floor(middle + (box.zw - 1.) * wide / 2. + .5);
  if (clamp(middle, vec2(0), size) == middle) left = clamp(left, vec2(0), size - wide);
  gl_Position = vec4(((left + to * wide) / size * 2. - 1.) * p.w, p.zw);
  at = vec2(to.x * wide.x, place.w + (1. - to.y) * wide.y);
  paint = vectorOf(signs, sign + 2);
}`;

const FRAGMENT = `
uniform sampler2D letters;
in vec2 at;
in vec4 paint;
out vec4 colour;
void main() {
  float cover = texture(letters, at / vec2(textureSize(letters, 0))).a * paint.a;
  colour = vec4(paint.rgb * cover, cover);
}`;

/**
 * Returns a function that paints labels of 11 CSS px or more. Each text is a row of one texture, which is made again when the
 * texts change.
 */
export function createLabels(gl: Gl): (view: View, labels: Label[]) => void {
  const letters = program(gl, VERTEX, FRAGMENT);
  const signs = vectors(gl, 4);
  const rows = texture(gl, gl.TEXTURE_2D, gl.NEAREST);
  const paper = document.createElement("canvas");
  const pen = paper.getContext("2d")!;
  let written = "";
  let widths = new Map<string, number>();

  function write(texts: string[], ratio: number): void {
    const key = `${ratio} ${texts.join("|")}`;
    if (key === written) return;
    written = key;
    const font = `${11 * ratio}px Inter, system-ui, sans-serif`;
    pen.font = font;
    widths = new Map(texts.map((text) => [text, Math.ceil(pen.measureText(text).width) + 2]));
    paper.width = Math.max(1, ...widths.values());
    paper.height = Math.max(1, texts.length * Math.ceil(16 * ratio));
    pen.font = font;
    pen.textBaseline = "middle";
    texts.forEach((text, i) => pen.fillText(text, 1, (i + 0.5) * Math.ceil(16 * ratio)));
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, rows);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, paper);
  }

  return (view, labels) => {
    const texts = [...new Set(labels.map((label) => label.text))].sort();
    // Labels are larger on a large screen, like the other texts of the page.
    const ratio = Math.max(view.ratio, view.size[1] / 1300);
    write(texts, ratio);
    const high = Math.ceil(16 * ratio);
    const row = (text: string) => [texts.indexOf(text) * high, widths.get(text)!, high];
    signs.set(labels.flatMap(({ place, away, text, ink }) => [...place, ...row(text), ...away, ...ink]));
    aim(letters, view);
    letters.set("size", view.size);
    letters.bind("letters", 0, gl.TEXTURE_2D, rows);
    letters.bind("signs", 1, gl.TEXTURE_2D, signs.texture);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * labels.length);
    gl.depthMask(true);
  };
}
