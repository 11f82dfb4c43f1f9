/** Painting: the canvas behind the page, on which the painter paints the 3-D view and the compared slices. */

import { FOCAL } from "../painter/camera.ts";
import { Painter } from "../painter/painter.ts";
import type { Box } from "../painter/picture.ts";
import type { Lattice, Look, Slot, Theme } from "../state/types.ts";
import { isTrap } from "../state/signature.ts";
import { balls } from "../solving/beads.ts";
import { wavelength } from "../solving/lattices.ts";
import { type Result, shownOf } from "../solving/studio.ts";
import type { Compare } from "./compare.ts";
import type { Context } from "./context.ts";
import { element } from "./dom.ts";
import { discsOf, lookOf, turnAt } from "./look.ts";
import type { Part } from "./recording.ts";
import type { Stage } from "./stage.ts";

const BACKGROUNDS: Record<Theme, [number, number, number]> = {
  dark: [12, 15, 20],
  light: [246, 248, 250],
};

/** Pixels per CSS px of the canvas while something moves, if software renders the canvas. */
const COARSE = 0.5;

/** The parts of the page over the canvas. */
interface Parts {
  stage: Stage;
  compare: Compare;
  /** The panels, out of which the compared slice scrolls. */
  panels: HTMLElement;
}

/** The canvas and its pictures; without WebGL2 there are none, and a line says so. */
export class Painting {
  readonly canvas = element("canvas", { className: "canvas", "aria-hidden": "true" });
  /** Whether software renders. */
  readonly slow: boolean;
  private readonly painter = Painter.of(this.canvas);
  private readonly calm = matchMedia("(prefers-reduced-motion: reduce)");
  /** The phase of the wave, the requested picture, and whether something other than the wave has changed since the last one. */
  private turn = 0;
  private request = 0;
  private fresh = true;
  private ended = false;
  private painted: (Lattice | null)[] = [];

  constructor(
    private readonly context: Context,
    private readonly parts: Parts,
  ) {
    const { painter, calm } = this;
    this.slow = painter?.slow ?? false;
    if (painter) painter.onRestored = context.repaint;
    else context.alarm(context.say("noPictures"));
    const size = new ResizeObserver(context.repaint);
    [this.canvas, parts.stage.view, parts.compare.slice].forEach((each) => size.observe(each));
    calm.addEventListener("change", context.repaint);
    context.ending(() => {
      this.ended = true;
      cancelAnimationFrame(this.request);
      size.disconnect();
      calm.removeEventListener("change", context.repaint);
      painter?.dispose();
    });
  }

  get look(): Look {
    return lookOf(this.context.studio.view, this.context.theme, this.turn);
  }

  /** Whether the page shows other fields than the picture. */
  get late(): boolean {
    return this.context.studio.view.results.some(({ lattice }, slot) => lattice !== this.painted[slot]);
  }

  repaint(): void {
    this.fresh = true;
    this.next();
  }

  /** Paints with so many pixels per CSS px, or as the screen has; returns the canvas and the rectangle of the 3-D view in it. */
  paint(pixels?: number): Part {
    const ratio = this.pictures(pixels);
    const [outer, inner] = [this.canvas, this.parts.stage.view].map((each) => each.getBoundingClientRect());
    const [x, y, width, height] = [inner.left - outer.left, inner.top - outer.top, inner.width, inner.height].map((px) => Math.round(px * ratio));
    return { canvas: this.canvas, box: new DOMRect(x, y, width, height) };
  }

  /** Whether the wave is animated; it is not if the user prefers less motion. */
  private get runs(): boolean {
    const { painter } = this;
    return !this.ended && painter !== null && !painter.lost && this.context.studio.view.state.quantity === "wave" && !this.calm.matches;
  }

  /** Requests a picture; while the wave runs, each picture requests the next. */
  private next(): void {
    this.request ||= requestAnimationFrame((now) => {
      if (this.runs) this.turn = turnAt(now);
      this.pictures();
      if (this.runs) this.next();
    });
  }

  /** Paints all pictures; returns the pixels per CSS px. */
  private pictures(pixels?: number): number {
    this.request = 0;
    const { painter, context } = this;
    const { view } = context.studio;
    if (this.ended || painter?.lost) return 1;
    const ratio = pixels ?? Math.min(devicePixelRatio, 2) * ((view.moving || this.runs) && this.slow ? COARSE : 1);
    this.painted = view.results.map(({ lattice }) => lattice);
    if (painter) {
      const { width, height } = this.fit();
      painter.begin(width, height, ratio, BACKGROUNDS[context.theme]);
      this.space(painter);
      this.slices(painter);
    }
    if (this.fresh) this.parts.stage.update();
    this.fresh = false;
    return ratio;
  }

  /** Makes the canvas end below the lowest view: a long page on a phone would need more pixels than a canvas may have. */
  private fit(): DOMRect {
    const bottoms = [this.parts.stage.view, this.parts.compare.slice].map((view) => view.getBoundingClientRect().bottom);
    const { top } = this.canvas.getBoundingClientRect();
    this.canvas.style.height = `${Math.ceil(Math.max(...bottoms) - top)}px`;
    return this.canvas.getBoundingClientRect();
  }

  /** Returns the rectangle of an element on the canvas. */
  private box(element: HTMLElement): Box {
    const outer = this.canvas.getBoundingClientRect();
    const { left, top, width, height } = element.getBoundingClientRect();
    return { x: left - outer.left, y: top - outer.top, width, height };
  }

  private space(painter: Painter): void {
    const { stage } = this.parts;
    const { view } = this.context.studio;
    const { state, frame } = view;
    const box = this.box(stage.view);
    if (!box.width) return;
    const { sight } = stage;
    const results = shownOf(view);
    const slot = frame && (frame.touch || !frame.results[state.slot]) ? 0 : state.slot;
    const points = frame?.points ?? state.points;
    // A bead is at rest in the middle of its trap, until its motion is simulated.
    const beads = frame?.beads?.length ? frame.beads : points.filter((_, k) => isTrap(state.signature, k));
    painter.scene(box, {
      camera: sight.camera,
      positions: view.positions,
      normals: view.normals,
      drive: results[slot].answer?.drive ?? null,
      discs: discsOf(state),
      slices: state.view !== "volume" || !view.volume || frame ? slicesOf(results[slot], slot) : [],
      wavelength: wavelength(state),
      // The glow of |p| would cover the wave or the phase.
      volume: ["slice", "planes"].includes(state.view) || frame || (state.view === "both" && state.quantity !== "modulus") ? null : view.volume,
      points,
      obstacles: [...state.obstacles, ...balls(beads, (place) => sight.project(place)[2] / (FOCAL * box.height), state.bead?.radius)],
      look: this.look,
      theme: this.context.theme,
      moving: view.moving,
    });
  }

  /** Paints the compared slices, A to the left of the movable line and B to its right. */
  private slices(painter: Painter): void {
    const { compare, panels } = this.parts;
    const whole = this.box(compare.slice);
    if (!whole.width) return;
    const lattices = shownOf(this.context.studio.view).map(({ lattice }) => lattice);
    // The part of the slice that is scrolled out of its panel is clipped.
    const y = panels.contains(compare.slice) ? Math.max(whole.y, this.box(panels).y) : whole.y;
    lattices.forEach((lattice, slot) => {
      if (!lattice) return;
      const share = whole.width * (lattices[1 - slot] ? compare.share() : 1 - slot);
      const [x, width] = slot ? [whole.x + share, whole.width - share] : [whole.x, share];
      painter.slice(whole, lattice, "AB"[slot], this.look, { x, y, width, height: whole.y + whole.height - y });
    });
  }
}

/** Returns the slices of a slot, each with the key of its texture. */
function slicesOf({ lattice, crossing }: Result, slot: Slot): { lattice: Lattice; key: string }[] {
  return lattice ? [lattice, ...crossing].map((lattice, k) => ({ lattice, key: "AB"[slot] + (k || "") })) : [];
}
