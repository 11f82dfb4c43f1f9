/** The painter: one WebGL2 context for one canvas behind the page, with any number of views on it. */

import type { Lattice, Look } from "../state/types.ts";
import type { Box, Picture, Rgb } from "./picture.ts";
import { Scene } from "./scene.ts";
import { areaOf, enter } from "./view.ts";

/** Paints any number of views on one canvas. A frame is a call of `begin`, then of its views. */
export class Painter {
  /** Whether software renders, instead of a graphics card. */
  readonly slow: boolean;
  /** Whether the context is lost: then nothing is painted until `onRestored`. */
  lost = false;
  /** Is called when the painter can paint again. */
  onRestored: (() => void) | null = null;
  private page = { height: 0, ratio: 1 };
  private scenes: Scene;
  private readonly listening = new AbortController();

  /** Returns the painter of a canvas; null if the browser has no WebGL2. */
  static of(canvas: HTMLCanvasElement): Painter | null {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "high-performance" });
    return gl && new Painter(canvas, gl);
  }

  private constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gl: WebGL2RenderingContext,
  ) {
    this.scenes = new Scene(gl);
    const { UNMASKED_RENDERER_WEBGL: name = gl.RENDERER } = gl.getExtension("WEBGL_debug_renderer_info") ?? {};
    this.slow = /software|swiftshader|llvmpipe|basic render/i.test(gl.getParameter(name));
    const { signal } = this.listening;
    const lose = (event: Event) => {
      // Without this call the browser does not restore the context.
      event.preventDefault();
      this.lost = true;
    };
    const restore = () => {
      this.scenes = new Scene(gl);
      this.lost = false;
      this.onRestored?.();
    };
    canvas.addEventListener("webglcontextlost", lose, { signal });
    canvas.addEventListener("webglcontextrestored", restore, { signal });
  }

  /** Clears the canvas. The size is in CSS px, `ratio` is devicePixelRatio. */
  begin(width: number, height: number, ratio: number, background: Rgb): void {
    const { gl, canvas } = this;
    this.page = { height, ratio };
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== size[0]) canvas.width = size[0];
    if (canvas.height !== size[1]) canvas.height = size[1];
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.SCISSOR_TEST);
    const [red, green, blue] = background;
    gl.clearColor(red / 255, green / 255, blue / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
  }

  /**
   * Paints the lattice as a flat map that fills `box`, `v` up, clipped to `clip`. The texture `key` is uploaded again if the
   * values are another array.
   */
  slice(box: Box, lattice: Lattice, key: string, look: Look, clip = box): void {
    if (this.lost || clip.width <= 0 || clip.height <= 0) return;
    const { height, ratio } = this.page;
    enter(this.gl, areaOf(box, height, ratio), areaOf(clip, height, ratio));
    this.scenes.field.flat(lattice, key, look);
  }

  /** Paints the 3-D view. */
  scene(box: Box, picture: Picture): void {
    if (this.lost) return;
    const area = areaOf(box, this.page.height, this.page.ratio);
    enter(this.gl, area);
    this.scenes.paint(box, area, picture, this.page.ratio);
  }

  dispose(): void {
    this.listening.abort();
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
