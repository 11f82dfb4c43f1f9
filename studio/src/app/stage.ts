/** Stage: the 3-D view, its camera, and the points as buttons on it, which can be moved one by one or several together. */

import { MANY, MOST_POINTS } from "../state/initial.ts";
import { following, middleOf, onPlane, SIDES } from "../state/plane.ts";
import { added, removed, shifted } from "../state/points.ts";
import type { State, Vec3 } from "../state/types.ts";
import { Sight, type Spot } from "../painter/camera.ts";
import { type Context, millimetres } from "./context.ts";
import { draggable, element, resize, stepOf } from "./dom.ts";
import type { Eye } from "./eye.ts";
import { createHandles } from "./handles.ts";
import { number } from "./numbering.ts";
import { createColourKey, createPhaseKey } from "./phasekey.ts";
import { createReadout } from "./readout.ts";
import { createSliceChoice } from "./slicechoice.ts";
import { createViewing } from "./viewing.ts";

/** A pointer that moves less than this, in px, is a click. */
const CLICK = 3;

/**
 * A drag: the point under the pointer and all dragged points; where points and pointer were at its start; and whether it moves
 * the points off the slice.
 */
interface Grip {
  index: number;
  all: number[];
  points: Vec3[];
  pointer: Spot;
  from: Spot;
  lifts: boolean;
  /** Whether the pointer has moved. */
  moved: boolean;
}

/** The 3-D view. */
export class Stage {
  readonly root: HTMLElement;
  readonly view: HTMLElement;
  private readonly buttons: HTMLButtonElement[] = [];
  private readonly ear: HTMLElement;
  private readonly lifter: HTMLElement;
  private readonly lasso = element("div", { className: "lasso", hidden: true });
  private readonly readout;
  private readonly updates: (() => void)[];
  /** The numbers of the selected points, and of the point selected last. */
  private readonly selected = new Set<number>();
  private latest = -1;

  constructor(
    private readonly context: Context,
    private readonly eye: Eye,
  ) {
    const { say } = context;
    this.view = element("div", { className: "view3d", role: "group", "aria-label": say("view3d") });
    this.ear = element("div", { className: "listener", "aria-hidden": "true" }, say("ear"));
    this.lifter = element("div", { className: "lifter", "aria-hidden": "true", title: say("lift") }, "↕");
    this.readout = createReadout(context);
    this.view.append(this.ear, this.lifter, this.lasso);
    this.drag(this.lifter, () => this.latest, () => true);
    const looks = createViewing(context, eye, this.view, this.local, this.box);
    const [slices, key, colours] = [createSliceChoice(context), createPhaseKey(context), createColourKey(context)];
    const hint = element("p", { className: "hint" }, say(matchMedia("(hover: none)").matches ? "hintTouch" : "hint"));
    this.root = element("section", { className: "stage" }, this.view, hint, element("div", { className: "viewing" }, slices.root, looks), key.root, colours.root, this.readout.root);
    this.updates = [createHandles(context, this), slices.update, key.update, colours.update];
    this.view.addEventListener("pointermove", (event) => this.probe(event));
    this.view.addEventListener("pointerleave", this.readout.hide);
    this.view.ondblclick = (event) => event.target === this.view && this.add(this.local(event));
  }

  /** The 3-D view as it is seen now. */
  get sight(): Sight {
    const size: Spot = [this.view.clientWidth || 1, this.view.clientHeight || 1];
    return new Sight(this.eye.camera(size), size);
  }

  /** Returns where a place is, in CSS px of the window. */
  readonly project = (place: Vec3): [number, number] => {
    const box = this.view.getBoundingClientRect();
    const [x, y] = this.sight.project(place);
    return [box.left + x, box.top + y];
  };

  /** Returns where a pointer is in the view. */
  readonly local = (event: MouseEvent): Spot => {
    const box = this.view.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  /** Moves the buttons to their points. */
  update(): void {
    const { state, frame } = this.context.studio.view;
    const points = frame?.points ?? state.points;
    const { sight } = this;
    this.view.classList.toggle("many", points.length > MANY);
    this.ear.hidden = !state.ear;
    if (state.ear) {
      const [x, y] = sight.project(state.ear);
      this.ear.style.transform = `translate(${x}px, ${y}px) translate(-50%, -64px)`;
    }
    resize(this.view, this.buttons, points.length, (index) => this.button(index));
    const rings = points.map((point) => sight.project(point));
    const style = getComputedStyle(this.view);
    const [ring, wide] = ["--ring", "--number"].map((name) => parseFloat(style.getPropertyValue(name)));
    const spots = number(points.length > MANY ? [] : rings, ring / 2, wide);
    this.buttons.forEach((button, index) => {
      const name = this.label(index);
      if (button.ariaLabel !== name) button.ariaLabel = name;
      const spot = spots[index];
      (button.firstElementChild as HTMLElement).style.translate = spot ? `${spot[0]}px ${spot[1]}px` : "";
      button.classList.toggle("crowded", !spot);
      this.put(button, rings[index]);
      button.classList.toggle("selected", this.selected.has(index));
      button.classList.toggle("quiet", state.pressures?.[index] === 0);
    });
    const active = rings[this.latest];
    this.lifter.hidden = !active || frame !== null;
    this.lifter.classList.toggle("under", active?.[1] < 110);
    if (active) this.put(this.lifter, active);
    this.updates.forEach((update) => update());
  }

  private get state(): State {
    return this.context.studio.view.state;
  }

  /** The number of the axis normal to the slice: points are dragged along the slice, and lifted off it along this axis. */
  private get normal(): number {
    return SIDES[this.state.plane.axis][2];
  }

  private put(handle: HTMLElement, [left, top]: number[]): void {
    handle.style.transform = `translate(${left.toFixed(2)}px, ${top.toFixed(2)}px)`;
  }

  private button(index: number): HTMLButtonElement {
    const button = element("button", { className: "point" }, element("span", {}, String(index + 1)));
    const nearest = (event: PointerEvent) => {
      // Where buttons overlap, the point nearest to the pointer is taken.
      const taken = this.nearest(this.local(event));
      this.buttons[taken].focus();
      return taken;
    };
    this.drag(button, nearest, (event) => event.shiftKey);
    button.onfocus = () => {
      this.latest = index;
      this.update();
    };
    button.onkeydown = (event) => this.press(event, index);
    return button;
  }

  /** Lets a handle drag a point, together with all selected points if it is one of them; a click selects the point. */
  private drag(handle: HTMLElement, index: (event: PointerEvent) => number, lifts: (event: PointerEvent) => boolean): void {
    const { studio, announce } = this.context;
    draggable(handle, studio, {
      begin: (event) => this.grasp(event, index(event), lifts(event)),
      move: (grip, event, gesture) => {
        const [x, y] = this.local(event);
        grip.moved ||= Math.hypot(x - grip.pointer[0], y - grip.pointer[1]) > CLICK;
        if (grip.moved) this.carry(grip.index, grip.all, grip.points, this.way(grip, [x, y]), gesture);
      },
      end: (grip, event) => {
        const beside = grip.lifts || event.ctrlKey || event.metaKey;
        if (grip.moved) announce(this.label(grip.index));
        else if (handle !== this.lifter) this.select(beside ? [grip.index] : [], beside);
      },
    });
  }

  private grasp(event: PointerEvent, index: number, lifts: boolean): Grip {
    event.preventDefault();
    const { points } = this.state;
    const [x, y] = this.sight.project(points[index]);
    return { index, all: this.group(index), points, pointer: this.local(event), from: [x, y], lifts, moved: false };
  }

  /** Returns the shift in m of a dragged point for a place of the pointer; null beyond the horizon. */
  private way({ index, points, pointer, from, lifts }: Grip, [x, y]: Spot): Vec3 | null {
    const to: Spot = [from[0] + x - pointer[0], from[1] + y - pointer[1]];
    if (!lifts) return this.sight.slide(from, to, points[index], this.normal);
    const off = this.sight.lift(from, to, points[index], this.normal);
    return off === null ? null : ([0, 0, 0].with(this.normal, off) as Vec3);
  }

  /** Moves points; if they leave the slice, the slice moves with them. */
  private carry(index: number, all: number[], from: Vec3[], way: Vec3 | null, gesture: string): void {
    if (!way) return;
    const change = shifted(this.state, all, from, way);
    const plane = () => following(this.state.plane, change.points![index]);
    this.context.studio.change(way[this.normal] === 0 ? change : { ...change, plane: plane() }, gesture);
  }

  /** Returns the points that move with one: all selected ones, if it is one of them. */
  private group(index: number): number[] {
    return this.selected.has(index) ? [...this.selected] : [index];
  }

  /** Selects these points instead of the old selection; with `beside`, adds points to it and removes those already in it. */
  private select(which: number[], beside = false): void {
    const { announce, say } = this.context;
    if (!beside) this.selected.clear();
    for (const index of which) if (!this.selected.delete(index)) this.selected.add(index);
    if (which.length) announce(say("selected", { count: this.selected.size }));
    this.update();
  }

  private label(index: number): string {
    const points = this.context.studio.view.frame?.points ?? this.state.points;
    const [x, y, z] = points[index].map(millimetres);
    return this.context.say("point", { n: index + 1, x, y, z });
  }

  private nearest([x, y]: Spot): number {
    const { sight } = this;
    const distances = this.state.points.map((point) => {
      const [left, top] = sight.project(point);
      return Math.hypot(left - x, top - y);
    });
    return distances.indexOf(Math.min(...distances));
  }

  private press(event: KeyboardEvent, index: number): void {
    const way = stepOf(event);
    if (way) {
      this.carry(index, this.group(index), this.state.points, way, `key ${index}`);
      this.context.announce(this.label(index));
    } else if (event.key === "Delete" || event.key === "Backspace") {
      this.remove(this.group(index), index);
    } else if (event.key === "Escape") {
      this.select([]);
    } else return;
    event.preventDefault();
  }

  private remove(all: number[], index: number): void {
    const { studio, alarm, announce, say } = this.context;
    if (this.state.points.length === all.length) return alarm(say("lastPoint"));
    studio.change(removed(this.state, ...all));
    this.select([]);
    this.buttons[Math.min(index, this.buttons.length - 1)]?.focus();
    announce(all.map((each) => say("removed", { n: each + 1 })).join(", "));
  }

  /** Adds a point on the slice. */
  private add(spot: Spot): void {
    const { studio, alarm, announce, say } = this.context;
    const { plane, points } = this.state;
    const origin = middleOf(plane);
    const place = this.sight.meet(spot, origin, this.normal);
    if (points.length >= MOST_POINTS) return alarm(say("tooMany", { count: MOST_POINTS + 1 }));
    if (!place) return;
    studio.change(added(this.state, place));
    announce(say("added", { n: points.length + 1 }));
  }

  /** Shows a rectangle between two corners; selects the points inside when it is done. */
  private readonly box = (from: Spot, to: Spot, done: boolean): void => {
    const [left, top] = [0, 1].map((k) => Math.min(from[k], to[k]));
    const [wide, high] = [0, 1].map((k) => Math.abs(from[k] - to[k]));
    this.lasso.hidden = done;
    Object.assign(this.lasso.style, { left: `${left}px`, top: `${top}px`, width: `${wide}px`, height: `${high}px` });
    if (!done) return;
    const { sight } = this;
    const inside = (point: Vec3) => {
      const [x, y] = sight.project(point);
      return x >= left && x <= left + wide && y >= top && y <= top + high;
    };
    this.select(this.state.points.flatMap((point, k) => (inside(point) ? [k] : [])));
  };

  /** Shows the field values at the pointer on the slice. */
  private probe(event: PointerEvent): void {
    const { plane, view, slot } = this.state;
    const spot = this.local(event);
    const points = event.target === this.view && !event.buttons && event.pointerType !== "touch" && view !== "volume";
    const place = points && this.sight.meet(spot, middleOf(plane), this.normal);
    const [right, up] = place ? onPlane(plane, place) : [NaN, NaN];
    if (!place || !(Math.abs(right - 0.5) <= 0.5 && Math.abs(up - 0.5) <= 0.5)) return this.readout.hide();
    Object.assign(this.readout.root.style, { left: `${spot[0]}px`, top: `${spot[1]}px` });
    this.readout.root.classList.toggle("left", spot[0] > this.view.clientWidth - 260);
    this.readout.show(slot, place);
  }
}
