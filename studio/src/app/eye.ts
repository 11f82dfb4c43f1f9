/** Eye: the camera of the 3-D view. It is fitted to the scene until a user turns it. */

import { along, type Camera, fit, FOCAL, frame, Sight, type Spot } from "../painter/camera.ts";
import { placeOn, planesOf } from "../state/plane.ts";
import type { Studio } from "../work/studio.ts";
import type { State, Vec3 } from "../state/types.ts";

/** A camera that stays when the page is rebuilt in another theme or language. */
export interface Eye {
  /** Returns the camera for a view of this size in CSS px. */
  camera(size: Spot): Camera;
  /** Turns the view by a pointer's movement in px. */
  turn(dx: number, dy: number): void;
  /** Moves the camera nearer (factor below 1) or further away. */
  zoom(factor: number): void;
  /** Shifts the view by a pointer's movement in px. */
  pan(dx: number, dy: number): void;
  /** Looks from above, along the slice's normal, or from where the camera was at the start. */
  look(from: "fromAbove" | "fromAhead" | "asFirst"): void;
}

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

const within = (value: number, [least, most]: number[]) => Math.min(Math.max(value, least), most);

/** Makes the camera of a studio. */
export function createEye({ view }: Studio): Eye {
  let camera: Camera = { target: [0, 0, 0], yaw: 0, pitch: 0, distance: 1 };
  let last: Spot = [1, 1];
  /** The array and the view's size at the last fit; the size counts only until a user turns the view. */
  let fitted = "";
  let turned = false;
  /** The state at the last check whether everything is in sight. */
  let seen: State;
  const key = (size: number[]) => JSON.stringify([view.state.array, view.array.length, turned ? [] : [size, view.state.plane.axis]]);

  function corners(): Vec3[] {
    return planesOf(view.state).flatMap((plane) => [0, 1].flatMap((a) => [0, 1].map((b) => placeOn(plane, a, b))));
  }

  /** The corners of everything to be shown: points with the glow above them, and slices. */
  const all = () => [...view.state.points.map(([x, y, z]): Vec3 => [x, y, z + GLOW]), ...corners()];

  function hold(changes: Partial<Camera>) {
    camera = { ...camera, ...changes };
    turned = true;
    fitted = key([]);
  }

  return {
    camera(size) {
      const { state } = view;
      const fresh = fitted !== key(size);
      if (fresh || (state !== seen && !turned && !view.moving)) {
        const best = fit(view.positions, all(), size, state.plane.axis);
        // Fits again only if a part is out of sight or everything appears too small, so that the view does not jump.
        const sight = new Sight(camera, size);
        const cut = all().some((place) => {
          const at = sight.project(place);
          return size.some((side, k) => Math.abs(2 * at[k] - side) > side);
        });
        if (fresh || cut || camera.distance > LOOSE * best.distance) camera = best;
        if (fresh) turned = false;
        fitted = key(size);
        seen = state;
      }
      last = size;
      return camera;
    },
    turn: (dx, dy) => hold({ yaw: camera.yaw - TURN * dx, pitch: within(camera.pitch + TURN * dy, PITCH) }),
    pan(dx, dy) {
      const { right, up } = frame(camera);
      const metres = camera.distance / FOCAL / last[1];
      hold({ target: along(along(camera.target, -dx * metres, right), dy * metres, up) });
    },
    look(from) {
      turned = false;
      fitted = "";
      if (from === "asFirst") return;
      const yaw = view.state.plane.axis === "x" && from === "fromAhead" ? Math.PI / 2 : 0;
      hold(fit(view.positions, all(), last, view.state.plane.axis, [yaw, from === "fromAbove" ? PITCH[1] : 0]));
    },
    zoom: (factor) => hold({ distance: within(camera.distance * factor, DISTANCE) }),
  };
}
