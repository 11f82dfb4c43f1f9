/** Stage: the 3-D view, its camera, and the points as buttons over it. */

import { type Context, millimetres } from "./context.ts";
import { element } from "./dom.ts";
import type { Eye } from "./eye.ts";
import { along, type Camera, lift, project, slide } from "./painter/camera.ts";
import { MOST_POINTS } from "./initial.ts";
import { number } from "./numbering.ts";
import { following, middleOf, SIDES } from "./plane.ts";
import { added, moved, removed } from "./points.ts";
import type { Vec3 } from "./types.ts";

/** The 3-D view. */
export interface Stage {
  root: HTMLElement;
  view: HTMLElement;
  camera(): Camera;
  /** Puts the buttons where the points are. */
  place(): void;
  /** Where a place is, in CSS px of the window. */
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

/** More rings than these would hide the field: they are smaller then. */
export const MANY = 16;

/** A point that is held: where it and the pointer were, and whether it is lifted. */
interface Grip {
  index: number;
  point: Vec3;
  at: [number, number];
  from: [number, number];
  lifts: boolean;
}

/** Makes the stage. */
export function createStage(context: Context, eye: Eye): Stage {
  const { studio, say } = context;
  const handles: HTMLButtonElement[] = [];
  const hint = element("p", { className: "hint" }, say(matchMedia("(hover: none)").matches ? "hintTouch" : "hint"));
  const view = element("div", { className: "view3d", role: "group", "aria-label": say("view3d") });
  const listener = element("div", { className: "listener", "aria-hidden": "true" }, say("ear"));
  view.append(listener);
  const root = element("section", { className: "stage" }, view, hint);
  let gesture = 0;
  let grip: Grip | null = null;

  const size = (): [number, number] => [view.clientWidth || 1, view.clientHeight || 1];
  const current = (): Camera => eye.camera(size());
  const seen = (place: Vec3) => project(current(), place, ...size());
  const state = () => studio.view.state;
  /** The axis that the slice is normal to: points are dragged along the slice, and lifted off it. */
  const normal = () => SIDES[state().plane.axis][2];

  function handle(index: number): HTMLButtonElement {
    const button = element("button", { className: "point" }, element("span", {}, String(index + 1)));
    button.onpointerdown = (event) => {
      // Where handles overlap, the nearest point is meant.
      const nearest = nearestTo(local(event));
      handles[nearest].focus();
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      grip = grasp(event, nearest);
      gesture += 1;
      studio.moving(true);
    };
    button.onpointermove = (event) => grip && drag(event);
    button.onpointerup = button.onpointercancel = () => {
      if (!grip) return;
      context.announce(label(grip.index));
      grip = null;
      studio.moving(false);
    };
    button.onkeydown = (event) => press(event, index);
    return button;
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

  const grasp = (event: PointerEvent, index: number): Grip => {
    const point = state().points[index];
    const [x, y] = seen(point);
    return { index, point, at: local(event), from: [x, y], lifts: event.shiftKey };
  };

  function drag(event: PointerEvent) {
    if (grip!.lifts !== event.shiftKey) grip = grasp(event, grip!.index);
    const { index, from, at, point, lifts } = grip!;
    const [x, y] = local(event);
    const to: [number, number] = [from[0] + x - at[0], from[1] + y - at[1]];
    const name = `drag ${gesture}`;
    if (lifts) {
      const rise = lift(current(), from, to, point, size(), normal());
      if (rise !== null) carry(index, point.with(normal(), point[normal()] + rise) as Vec3, name);
    } else {
      const way = slide(current(), from, to, point, size(), normal());
      if (way) carry(index, along(point, 1, way), name);
    }
  }

  /** A point that leaves the slice takes it along. */
  function carry(index: number, to: Vec3, name: string) {
    const { plane, points } = state();
    const change = moved(state(), index, to);
    const there = change.points![index];
    studio.change(there[normal()] === points[index][normal()] ? change : { ...change, plane: following(plane, there) }, name);
  }

  function press(event: KeyboardEvent, index: number) {
    const way = KEYS[event.key];
    if (way) {
      const step = STEPS[Number(event.shiftKey)];
      const to = state().points[index].map((x, axis) => x + step * way[axis]) as Vec3;
      carry(index, to, `key ${index}`);
      context.announce(label(index));
    } else if (event.key === "Delete" || event.key === "Backspace") {
      if (state().points.length === 1) return context.alarm(say("lastPoint"));
      studio.change(removed(state(), index));
      handles[Math.min(index, handles.length - 1)]?.focus();
      context.announce(say("removed", { n: index + 1 }));
    } else return;
    event.preventDefault();
  }

  function local(event: MouseEvent): [number, number] {
    const box = view.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // The view itself: one finger or the left button turns, two fingers and the wheel zoom, the right button shifts.
  const fingers = new Map<number, [number, number]>();
  view.onpointerdown = (event) => {
    if (event.target !== view) return;
    view.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, local(event));
  };
  view.onpointermove = (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = local(event);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    const apart = (at: [number, number]) => Math.hypot(at[0] - other![0], at[1] - other![1]);
    if (other) eye.zoom(apart(before) / Math.max(apart(now), 1));
    else eye.turn(now[0] - before[0], now[1] - before[1]);
    fingers.set(event.pointerId, now);
    context.repaint();
  };
  view.onpointerup = view.onpointercancel = (event) => void fingers.delete(event.pointerId);
  view.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      eye.zoom(Math.exp(event.deltaY * 1e-3));
      context.repaint();
    },
    { passive: false },
  );
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

  return {
    root,
    view,
    camera: current,
    place() {
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
        button.classList.toggle("quiet", state().pressures?.[index] === 0);
      });
    },
    project(place) {
      const box = view.getBoundingClientRect();
      const [x, y] = seen(place);
      return [box.left + x, box.top + y];
    },
  };
}
