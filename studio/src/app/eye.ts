/** Eye: the camera of the 3-D view. It is fitted to the scene until a user turns it. */

import { along, between, type Camera, fit, FOCAL, frame, Sight, type Spot } from "../painter/camera.ts";
import { placeOn, planesOf } from "../state/plane.ts";
import type { Studio } from "../solving/studio.ts";
import { isTouch } from "../solving/touch.ts";
import type { State, Vec3 } from "../state/types.ts";

/** Rotation per pixel, in rad. */
const TURN = 0.008;

/** The allowed elevation of the camera, in rad: from below the ground to the zenith. */
const PITCH = [-0.3, 1.57];

/** The allowed distance of the camera, in m. */
const DISTANCE = [0.05, 5];

/** Height in m of the glow above a point. */
const GLOW = 0.04;

/** The view is fitted again if the camera's distance is above this multiple of the distance that shows everything. */
const LOOSE = 1.5;

/** The least part of the view that points and slices fill at the level "play" and for a skin, and the part that a fit gives them. */
const SHARE = 0.36;
const FILLED = 0.38;

/** Time in ms of the camera's way to another view. */
const WAY = 400;

const within = (value: number, [least, most]: number[]) => Math.min(Math.max(value, least), most);

/** A camera that stays when the page is rebuilt in another theme or language. */
export class Eye {
  /** Requests a picture while the camera moves by itself. */
  repaint: () => void = () => undefined;
  private now: Camera = { target: [0, 0, 0], yaw: 0, pitch: 0, distance: 1 };
  /** The camera from which it moves to `now`, and when it began. */
  private from: Camera | null = null;
  private begun = 0;
  private last: Spot = [1, 1];
  /** The array and the view's size at the last fit; the size counts only until a user turns the view. */
  private fitted = "";
  private turned = false;
  /** The state at the last check whether everything is in sight. */
  private seen: State | null = null;

  constructor(private readonly studio: Studio) {}

  /** Returns the camera for a view of this size in CSS px. */
  camera(size: Spot): Camera {
    const { state, moving } = this.studio.view;
    const fresh = this.fitted !== this.key(size);
    if (fresh || (state !== this.seen && !this.turned && !moving)) {
      const best = this.fit(size);
      // Fits again only if a part is out of sight or everything appears too small, so that the view does not jump.
      const sight = new Sight(this.now, size);
      const cut = this.all().some((place) => {
        const at = sight.project(place);
        return size.some((side, k) => Math.abs(2 * at[k] - side) > side);
      });
      const small = this.near() && this.share(this.now, size) < Math.min(SHARE, this.share(best, size) - 0.02);
      if (fresh || cut || small || this.now.distance > LOOSE * best.distance) {
        // It moves slowly, unless the view is new or has another size, or the user prefers less motion.
        const slow = this.fitted && state.level === "play" && `${size}` === `${this.last}` && !matchMedia("(prefers-reduced-motion: reduce)").matches;
        [this.from, this.begun, this.now] = [slow ? this.now : null, performance.now(), best];
      }
      if (fresh) this.turned = false;
      this.fitted = this.key(size);
      this.seen = state;
    }
    this.last = size;
    const part = within((performance.now() - this.begun) / WAY, [0, 1]);
    if (!this.from || part === 1) return this.now;
    requestAnimationFrame(this.repaint);
    return between(this.from, this.now, part ** 2 * (3 - 2 * part));
  }

  /** Whether the camera is so near that the slice fills the view, even if parts of the array are out of sight. */
  private near = () => this.studio.view.state.level === "play" || isTouch(this.studio.view.state.quantity);

  /** Returns the part of a view of this size that the box around points and slices fills. */
  private share(camera: Camera, size: Spot): number {
    const sight = new Sight(camera, size);
    const spots = this.all(0).map((place) => sight.project(place));
    const sides = size.map((side, k) => spots.map((spot) => within(spot[k], [0, side]) / side));
    return sides.reduce((part, all) => part * (Math.max(...all) - Math.min(...all)), 1);
  }

  /** Turns the view by a pointer's movement in px. */
  turn(dx: number, dy: number): void {
    this.hold({ yaw: this.now.yaw - TURN * dx, pitch: within(this.now.pitch + TURN * dy, PITCH) });
  }

  /** Moves the camera nearer (factor below 1) or further away. */
  zoom(factor: number): void {
    this.hold({ distance: within(this.now.distance * factor, DISTANCE) });
  }

  /** Shifts the view by a pointer's movement in px. */
  pan(dx: number, dy: number): void {
    const { right, up } = frame(this.now);
    const metres = this.now.distance / FOCAL / this.last[1];
    this.hold({ target: along(along(this.now.target, -dx * metres, right), dy * metres, up) });
  }

  /** Looks from above, along the slice's normal, or from where the camera was at the start. */
  look(from: "fromAbove" | "fromAhead" | "asFirst"): void {
    this.turned = false;
    this.fitted = "";
    if (from === "asFirst") return;
    const yaw = this.studio.view.state.plane.axis === "x" && from === "fromAhead" ? Math.PI / 2 : 0;
    this.hold(this.fit(this.last, [yaw, from === "fromAbove" ? PITCH[1] : 0]));
  }

  private key(size: number[]): string {
    const { state, array } = this.studio.view;
    return JSON.stringify([state.array, array.length, this.turned ? [] : [size, state.plane.axis, state.level, state.view === "slice"]]);
  }

  private fit(size: Spot, way?: [number, number]): Camera {
    const { positions, state } = this.studio.view;
    const above = state.level === "play" && state.view === "slice";
    const whole = fit(positions, this.all(), size, state.plane.axis, way, above);
    if (!this.near() || this.share(whole, size) >= FILLED) return whole;
    const close = fit(new Float32Array(), this.all(), size, state.plane.axis, [whole.yaw, whole.pitch]);
    // The nearest camera to that of the whole array which fills the view enough.
    let [least, most] = [0, 1];
    for (let k = 0; k < 8; k += 1) {
      const part = (least + most) / 2;
      [least, most] = this.share(between(whole, close, part), size) < FILLED ? [part, most] : [least, part];
    }
    return between(whole, close, most);
  }

  /** Returns the corners of everything to be shown: points with the glow above them, and slices. */
  private all(glow = GLOW): Vec3[] {
    const { state } = this.studio.view;
    const corners = planesOf(state).flatMap((plane) => [0, 1].flatMap((a) => [0, 1].map((b) => placeOn(plane, a, b))));
    return [...state.points.map(([x, y, z]): Vec3 => [x, y, z + glow]), ...corners];
  }

  private hold(changes: Partial<Camera>): void {
    this.from = null;
    this.now = { ...this.now, ...changes };
    this.turned = true;
    this.fitted = this.key([]);
  }
}
