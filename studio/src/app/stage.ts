/** Stage: the 3-D view, its camera, and the points as buttons on it, which can be moved one by one or several together. */

import { type Context, millimetres } from "./context.ts";
import { element } from "./dom.ts";
import type { Eye } from "./eye.ts";
import { along, type Camera, lift, meetPlane, project, slide } from "../painter/camera.ts";
import { MOST_POINTS } from "../state/initial.ts";
import { number } from "./numbering.ts";
import { following, middleOf, onPlane, SIDES } from "../state/plane.ts";
import { createHandles } from "./handles.ts";
import { createPhaseKey } from "./phasekey.ts";
import { added, removed, shifted } from "../state/points.ts";
import { createReadout } from "./readout.ts";
import { createSliceChoice } from "./slicechoice.ts";
import type { Vec3 } from "../state/types.ts";
import { createViewing, type Spot } from "./viewing.ts";

/** The 3-D view. */
export interface Stage {
  root: HTMLElement;
  view: HTMLElement;
  camera(): Camera;
  /** Moves the buttons to their points. */
  place(): void;
  /**
   * `seen` returns where a place is, in CSS px of the view, and its depth in m; `project` returns it in CSS px of the
   * window.
   */
  seen(place: Vec3): Vec3;
  project(place: Vec3): [number, number];
}

/** Steps of the arrow keys in m: without and with Shift. */
const STEPS = [1e-3, 1e-2];

const KEYS: Record<string, Vec3> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** Above this number of points, rings are smaller, so that they do not hide the field. */
export const MANY = 16;

/**
 * A drag: the point under the pointer and all dragged points; where points and pointer were at its start; and whether it moves
 * the points off the slice.
 */
interface Grip {
  index: number;
  all: number[];
  points: Vec3[];
  at: Spot;
  from: Spot;
  lifts: boolean;
  /** Whether the pointer has moved. */
  gone: boolean;
}

/** A pointer that moves less than this, in px, is a click. */
const CLICK = 3;

/** Makes the stage. */
export function createStage(context: Context, eye: Eye): Stage {
  const { studio, say } = context;
  const handles: HTMLButtonElement[] = [];
  const hint = element("p", { className: "hint" }, say(matchMedia("(hover: none)").matches ? "hintTouch" : "hint"));
  const view = element("div", { className: "view3d", role: "group", "aria-label": say("view3d") });
  const listener = element("div", { className: "listener", "aria-hidden": "true" }, say("ear"));
  view.append(listener);
  const lifter = element("div", { className: "lifter", "aria-hidden": "true", title: say("lift") }, "↕");
  const lasso = element("div", { className: "lasso", hidden: true });
  const readout = createReadout(context);
  view.append(lifter, lasso);
  let gesture = 0;
  let grip: Grip | null = null;
  /** The numbers of the selected points, and of the point selected last. */
  const selected = new Set<number>();
  let latest = -1;

  const size = (): [number, number] => [view.clientWidth || 1, view.clientHeight || 1];
  const current = (): Camera => eye.camera(size());
  const seen = (place: Vec3) => project(current(), place, ...size());
  const state = () => studio.view.state;
  /** Returns the axis normal to the slice: points are dragged along the slice, and lifted off it along this axis. */
  const normal = () => SIDES[state().plane.axis][2];

  function handle(index: number): HTMLButtonElement {
    const button = element("button", { className: "point" }, element("span", {}, String(index + 1)));
    button.onpointerdown = (event) => {
      // Where buttons overlap, the point nearest to the pointer is taken.
      const nearest = nearestTo(local(event));
      handles[nearest].focus();
      event.preventDefault();
      hold(button, event, nearest, event.shiftKey);
    };
    follow(button, () => grip!.lifts);
    button.onfocus = () => {
      latest = index;
      place();
    };
    button.onkeydown = (event) => press(event, index);
    return button;
  }

  /** Begins to drag a point, together with all selected points if it is one of them. */
  function hold(by: HTMLElement, event: PointerEvent, index: number, lifts: boolean) {
    by.setPointerCapture(event.pointerId);
    grip = grasp(event, index, lifts);
    gesture += 1;
    studio.moving(true);
  }

  /** Makes the dragged point follow the pointer; a click selects it. */
  function follow(by: HTMLElement, lifted: (event: PointerEvent) => boolean) {
    by.onpointermove = (event) => grip && drag(event, lifted(event));
    by.onpointerup = by.onpointercancel = (event) => {
      if (!grip) return;
      const { index, gone, lifts } = grip;
      grip = null;
      studio.moving(false);
      if (gone) context.announce(label(index));
      else if (by !== lifter) select(lifts || event.ctrlKey || event.metaKey ? [index] : [], lifts || event.ctrlKey || event.metaKey);
    };
  }

  /** Selects these points instead of the old selection; with `beside`, adds points to it and removes those already in it. */
  function select(which: number[], beside = false) {
    if (!beside) selected.clear();
    for (const index of which) if (!selected.delete(index)) selected.add(index);
    if (which.length) context.announce(say("selected", { count: selected.size }));
    place();
  }

  function label(index: number): string {
    const points = studio.view.frame?.points ?? state().points;
    const [x, y, z] = points[index].map(millimetres);
    return say("point", { n: index + 1, x, y, z });
  }

  function nearestTo([x, y]: [number, number]): number {
    const distances = state().points.map((point) => {
      const [left, top] = seen(point);
      return Math.hypot(left - x, top - y);
    });
    return distances.indexOf(Math.min(...distances));
  }

  const grasp = (event: PointerEvent, index: number, lifts: boolean): Grip => {
    const { points } = state();
    const [x, y] = seen(points[index]);
    return { index, all: selected.has(index) ? [...selected] : [index], points, at: local(event), from: [x, y], lifts, gone: false };
  };

  function drag(event: PointerEvent, lifts: boolean) {
    if (grip!.lifts !== lifts) grip = { ...grasp(event, grip!.index, lifts), gone: grip!.gone };
    const { index, all, points, from, at } = grip!;
    const [x, y] = local(event);
    grip!.gone ||= Math.hypot(x - at[0], y - at[1]) > CLICK;
    if (!grip!.gone) return;
    const to: Spot = [from[0] + x - at[0], from[1] + y - at[1]];
    const point = points[index];
    const off = lifts ? lift(current(), from, to, point, size(), normal()) : null;
    const way = lifts ? off !== null && ([0, 0, 0].with(normal(), off) as Vec3) : slide(current(), from, to, point, size(), normal());
    if (way) carry(index, all, points, way, `drag ${gesture}`);
  }

  /** Moves points; if they leave the slice, the slice moves with them. */
  function carry(index: number, all: number[], from: Vec3[], way: Vec3, name: string) {
    const { plane } = state();
    const change = shifted(state(), all, from, way);
    studio.change(way[normal()] === 0 ? change : { ...change, plane: following(plane, change.points![index]) }, name);
  }

  function press(event: KeyboardEvent, index: number) {
    const way = KEYS[event.key];
    if (way) {
      const step = STEPS[Number(event.shiftKey)];
      carry(index, selected.has(index) ? [...selected] : [index], state().points, way.map((x) => step * x) as Vec3, `key ${index}`);
      context.announce(label(index));
    } else if (event.key === "Delete" || event.key === "Backspace") {
      const all = selected.has(index) ? [...selected] : [index];
      if (state().points.length === all.length) return context.alarm(say("lastPoint"));
      studio.change(removed(state(), ...all));
      select([]);
      handles[Math.min(index, handles.length - 1)]?.focus();
      context.announce(all.map((each) => say("removed", { n: each + 1 })).join(", "));
    } else if (event.key === "Escape") {
      select([]);
    } else return;
    event.preventDefault();
  }

  function local(event: MouseEvent): [number, number] {
    const box = view.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  lifter.onpointerdown = (event) => {
    event.preventDefault();
    event.stopPropagation();
    hold(lifter, event, latest, true);
  };
  follow(lifter, () => true);

  /** Selects the points inside a rectangle. */
  function within(from: Spot, to: Spot, done: boolean) {
    const [left, top] = [0, 1].map((k) => Math.min(from[k], to[k]));
    const [wide, high] = [0, 1].map((k) => Math.abs(from[k] - to[k]));
    lasso.hidden = done;
    Object.assign(lasso.style, { left: `${left}px`, top: `${top}px`, width: `${wide}px`, height: `${high}px` });
    if (!done) return;
    const inside = (point: Vec3) => {
      const [x, y] = seen(point);
      return x >= left && x <= left + wide && y >= top && y <= top + high;
    };
    select(state().points.flatMap((point, k) => (inside(point) ? [k] : [])));
  }

  const looks = createViewing(context, eye, view, local, within);
  const slices = createSliceChoice(context);
  const key = createPhaseKey(context);
  const placeHandles = createHandles(context, view, current, local, seen);
  const root = element("section", { className: "stage" }, view, hint, element("div", { className: "viewing" }, slices.root, looks), key.root, readout.root);

  // Shows the field values at the pointer on the slice.
  view.addEventListener("pointermove", (event) => {
    const { plane, view: shown, slot } = state();
    const spot = local(event);
    const place = event.target === view && !event.buttons && event.pointerType !== "touch" && shown !== "volume" && meetPlane(current(), spot, size(), middleOf(plane), normal());
    const [right, up] = place ? onPlane(plane, place) : [NaN, NaN];
    if (!place || !(Math.abs(right - 0.5) <= 0.5 && Math.abs(up - 0.5) <= 0.5)) return readout.hide();
    Object.assign(readout.root.style, { left: `${spot[0]}px`, top: `${spot[1]}px` });
    readout.root.classList.toggle("left", spot[0] > size()[0] - 260);
    readout.show(slot, place);
  });
  view.addEventListener("pointerleave", readout.hide);

  view.ondblclick = (event) => {
    if (event.target !== view) return;
    const { plane, points } = state();
    const origin = middleOf(plane);
    const [x, y] = seen(origin);
    const way = slide(current(), [x, y], local(event), origin, size(), normal());
    if (points.length >= MOST_POINTS) return context.alarm(say("tooMany", { count: MOST_POINTS + 1 }));
    if (!way) return;
    studio.change(added(state(), along(origin, 1, way)));
    context.announce(say("added", { n: points.length + 1 }));
  };

  function place() {
    const points = studio.view.frame?.points ?? state().points;
    view.classList.toggle("many", points.length > MANY);
    const { ear } = state();
    listener.hidden = !ear;
    if (ear) {
      const [x, y] = seen(ear);
      listener.style.transform = `translate(${x}px, ${y}px) translate(-50%, -64px)`;
    }
    while (handles.length > points.length) handles.pop()!.remove();
    while (handles.length < points.length) {
      handles.push(handle(handles.length));
      view.append(handles.at(-1)!);
    }
    const rings = points.map(seen);
    const style = getComputedStyle(view);
    const [ring, wide] = ["--ring", "--number"].map((name) => parseFloat(style.getPropertyValue(name)));
    const spots = number(points.length > MANY ? [] : rings, ring / 2, wide);
    handles.forEach((button, index) => {
      const name = label(index);
      if (button.ariaLabel !== name) button.ariaLabel = name;
      const [left, top] = rings[index];
      const spot = spots[index];
      (button.firstElementChild as HTMLElement).style.translate = spot ? `${spot[0]}px ${spot[1]}px` : "";
      button.classList.toggle("crowded", !spot);
      button.style.transform = `translate(${left.toFixed(2)}px, ${top.toFixed(2)}px)`;
      button.classList.toggle("selected", selected.has(index));
      button.classList.toggle("quiet", state().pressures?.[index] === 0);
    });
    const active = rings[latest];
    lifter.hidden = !active || studio.view.frame !== null;
    lifter.classList.toggle("under", active?.[1] < 110);
    if (active) lifter.style.transform = `translate(${active[0].toFixed(2)}px, ${active[1].toFixed(2)}px)`;
    placeHandles();
    slices.place();
    key.place();
  }

  return {
    root,
    view,
    camera: current,
    place,
    seen,
    project(place) {
      const box = view.getBoundingClientRect();
      const [x, y] = seen(place);
      return [box.left + x, box.top + y];
    },
  };
}
