/** The 3-D view: floor, transducers, obstacles, slices, glow, lines and labels, painted from back to front. */

import type { Lattice } from "../state/types.ts";
import { along, cross, dot, placeIn, unit } from "./camera.ts";
import { canRadius, createDiscs, HEIGHT } from "./discs.ts";
import { ALL, Field, type Part } from "./field.ts";
import { createFloor } from "./floor.ts";
import type { Gl } from "./gl.ts";
import { createLabels } from "./labels.ts";
import { createLines } from "./lines.ts";
import { roundStep } from "./maps.ts";
import type { Box, Picture } from "./picture.ts";
import { createSolids, wallLines } from "./solids.ts";
import { axes, boundsOf, guides, scaleBar } from "./stage.ts";
import { type Area, makeView, type View } from "./view.ts";
import { createVolume, type Side } from "./volume.ts";

/** Steps of a ray through the volume: at rest, and while something moves. */
const STEPS = [96, 48];

/** The quarters of a slice. */
const QUARTERS: Part[] = [0, 0.5].flatMap((s) => [0, 0.5].map((t): Part => [s, t, s + 0.5, t + 0.5]));

/** Paints 3-D scenes, with programs of one context. */
export class Scene {
  readonly field: Field;
  private readonly volume;
  private readonly discs;
  private readonly lines;
  private readonly solids;
  private readonly floor;
  private readonly labels;

  constructor(private readonly gl: Gl) {
    this.field = new Field(gl);
    this.volume = createVolume(gl, this.field);
    this.discs = createDiscs(gl, this.field);
    this.lines = createLines(gl);
    this.solids = createSolids(gl);
    this.floor = createFloor(gl);
    this.labels = createLabels(gl);
  }

  paint(box: Box, area: Area, picture: Picture, ratio: number): void {
    const { gl } = this;
    const { camera, obstacles } = picture;
    const view = makeView(camera, box, area, ratio);
    const bounds = boundsOf(picture.positions, picture.points);
    const plane = bounds.least[2];
    const ground = plane - HEIGHT * canRadius(picture.positions);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const step = roundStep(Math.max(bounds.most[0] - bounds.least[0], bounds.most[1] - bounds.least[1], 0.1) / 4.5);
    this.floor(view, bounds, ground, step, picture.theme === "dark");
    this.discs(view, picture);
    this.solids.balls(view, obstacles);
    const bar = scaleBar(picture);
    const marks = axes(camera, bounds, ground, picture.theme);
    this.lines(view, [...marks.lines, ...guides(picture, plane), ...wallLines(obstacles, bounds)]);
    this.solids.walls(view, obstacles, bounds);
    this.fields(view, picture);
    this.lines(view, bar.lines);
    this.labels(view, [...marks.labels, ...bar.labels]);
    gl.disable(gl.DEPTH_TEST);
  }

  /** Paints slices and glow. The glow behind a single slice is painted before it, the glow in front of it after it. */
  private fields(view: View, picture: Picture): void {
    const { slices } = picture;
    if (slices.length !== 1) {
      if (slices.length) this.crossing(view, picture);
      else this.glow(view, picture, null);
      return;
    }
    const [{ lattice, key }] = slices;
    const { corner: through, u, v } = lattice;
    const normal = unit(cross(u, v));
    const towards = dot(along(view.eye, -1, through), normal) < 0 ? along([0, 0, 0], -1, normal) : normal;
    this.glow(view, picture, { normal: along([0, 0, 0], -1, towards), through });
    this.slice(view, picture, lattice, key, ALL);
    this.glow(view, picture, { normal: towards, through });
  }

  /** Paints slices that cross, in quarters, the most distant first. */
  private crossing(view: View, picture: Picture): void {
    const away = (lattice: Lattice, [a, b, c, d]: Part) => {
      const to = along(placeIn(lattice, (a + c) / 2, (b + d) / 2), -1, view.eye);
      return dot(to, to);
    };
    const quarters = picture.slices.flatMap(({ lattice, key }) => QUARTERS.map((part) => ({ lattice, key, part, away: away(lattice, part) })));
    for (const { lattice, key, part } of quarters.toSorted((a, b) => b.away - a.away)) this.slice(view, picture, lattice, key, part);
  }

  private slice(view: View, { look, theme }: Picture, lattice: Lattice, key: string, part: Part): void {
    this.gl.depthMask(false);
    this.field.placed(view, lattice, key, look, theme === "dark" ? 0.34 : 0.42, part);
    this.gl.depthMask(true);
  }

  private glow(view: View, { volume, look, obstacles, moving }: Picture, side: Side | null): void {
    if (volume) this.volume(view, volume, look, obstacles, STEPS[moving ? 1 : 0], side);
  }
}
