/** Stage: the axes with their marks, the vertical lines below points, and a bar of one wavelength. */

import { MANY } from "../state/initial.ts";
import type { Vec3 } from "../state/types.ts";
import { along, type Camera, dot, frame, placeIn } from "./camera.ts";
import type { Label } from "./labels.ts";
import { type Ink, type Line, outline, ring } from "./lines.ts";
import { roundStep } from "./maps.ts";
import type { Picture } from "./picture.ts";

/** A box in space, m. */
export interface Bounds {
  least: Vec3;
  most: Vec3;
}

/** Returns the box that contains the array and the points, at least 5 cm high. */
export function boundsOf(positions: Float32Array, points: Vec3[]): Bounds {
  const least: Vec3 = [Infinity, Infinity, Infinity];
  const most: Vec3 = [-Infinity, -Infinity, -Infinity];
  const take = (k: number, value: number) => {
    least[k] = Math.min(least[k], value);
    most[k] = Math.max(most[k], value);
  };
  positions.forEach((value, i) => take(i % 3, value));
  points.forEach((point) => point.forEach((value, k) => take(k, value)));
  take(2, least[2] + 0.05);
  return { least, most };
}

const INKS = {
  dark: { faint: [0.62, 0.68, 0.78, 0.55], strong: [0.93, 0.95, 1, 0.75], text: [0.62, 0.67, 0.75, 1] },
  light: { faint: [0.3, 0.35, 0.44, 0.6], strong: [0.1, 0.13, 0.2, 0.75], text: [0.32, 0.36, 0.44, 1] },
} satisfies Record<string, Record<string, Ink>>;

/** Returns the axes along the edges of `bounds` that face the camera, with marks in mm. */
export function axes(camera: Camera, bounds: Bounds, floor: number, theme: Picture["theme"]) {
  const { ahead, right, up } = frame(camera);
  const { faint: ink, text } = INKS[theme];
  const { least, most } = bounds;
  const room = 0.05 * Math.max(most[0] - least[0], most[1] - least[1], 0.1);
  const low: Vec3 = [least[0] - room, least[1] - room, floor];
  const high: Vec3 = [most[0] + room, most[1] + room, most[2]];
  // The two edges of the floor nearest to the camera, and the vertical edge at the left.
  const x = ahead[0] > 0 ? low[0] : high[0];
  const y = ahead[1] > 0 ? low[1] : high[1];
  const other = (value: number, k: 0 | 1) => (value === low[k] ? high[k] : low[k]);
  const leftFirst = right[0] * x + right[1] * other(y, 1) < right[0] * other(x, 0) + right[1] * y;
  const post = leftFirst ? [x, other(y, 1)] : [other(x, 0), y];
  const step = roundStep(Math.max(...[0, 1, 2].map((k) => high[k] - low[k])) / 4.5);
  const out = [Math.sign(x - (low[0] + high[0]) / 2), Math.sign(y - (low[1] + high[1]) / 2)];
  const edges: { axis: 0 | 1 | 2; at: Vec3; tick: Vec3 }[] = [
    { axis: 0, at: [0, y, floor], tick: [0, out[1], 0] },
    { axis: 1, at: [x, 0, floor], tick: [out[0], 0, 0] },
    { axis: 2, at: [post[0], post[1], 0], tick: leftFirst ? [0, -out[1], 0] : [-out[0], 0, 0] },
  ];
  const lines: Line[] = [];
  const labels: Label[] = [];
  for (const { axis, at, tick } of edges) {
    const place = (value: number, away = 0): Vec3 =>
      [0, 1, 2].map((k) => (k === axis ? value : at[k]) + away * tick[k]) as Vec3;
    const seen = [dot(tick, right), dot(tick, up)];
    const away = seen.map((x) => x / Math.hypot(...seen)) as Label["away"];
    lines.push({ a: place(low[axis]), b: place(high[axis]), ink, width: 1.2 });
    for (let i = Math.ceil(low[axis] / step - 1e-6); i * step <= high[axis] + 1e-9; i++) {
      if (axis === 2 && i * step < floor) continue;
      lines.push({ a: place(i * step), b: place(i * step, 0.35 * room), ink, width: 1.2 });
      labels.push({
        place: place(i * step, 0.5 * room),
        away,
        text: `${Math.round(i * step * 1e4) / 10}`,
        ink: text,
      });
    }
    // An axis on the floor has its name between two marks, the vertical axis at its top.
    const between = (Math.floor((low[axis] + high[axis]) / 2 / step) + 0.5) * step;
    const name = axis === 2 ? { place: place(high[2] + 1.2 * room), away: [0, 1] } : { place: place(between, 0.5 * room), away };
    labels.push({ ...(name as Label), text: `${"xyz"[axis]} mm`, ink: text });
  }
  return { lines, labels };
}

/** Returns a bar of one wavelength at the lower edge of the first slice, with its length in mm. */
export function scaleBar({ slices, wavelength, theme }: Picture): { lines: Line[]; labels: Label[] } {
  if (!slices.length) return { lines: [], labels: [] };
  const { u, v } = slices[0].lattice;
  const part = wavelength / Math.hypot(...u);
  const from = placeIn(slices[0].lattice, 0.03, 0.03);
  const { strong, text } = INKS[theme];
  return {
    lines: [{ a: from, b: along(from, part, u), ink: strong, width: 3 }],
    labels: [{ place: along(along(from, part / 2, u), 0.02, v), away: [0, 1], text: `λ ${(1000 * wavelength).toFixed(1)} mm`, ink: text }],
  };
}

/** The outline of a right hand seen from above, in mm from the middle of its palm. */
const HAND = "-28,-80 -31,-45 -45,-25 -62,-2 -76,20 -72,29 -63,28 -44,6 -38,12 -40,40 -46,90 -41,99 -33,97 -22,46 -20,106 -11,114 -2,107 1,47 6,99 15,105 22,98 21,42 32,76 40,80 46,73 40,24 37,-20 30,-80";

/** Returns the outline of a hand whose palm lies in the middle of the first slice, for the touch of a skin. */
function palm({ slices, look, theme }: Picture): Line[] {
  if (!look.touch || !slices.length) return [];
  const middle = placeIn(slices[0].lattice, 0.5, 0.5);
  const places = HAND.split(" ").map((pair) => pair.split(",").map(Number)).map(([x, y]): Vec3 => along(middle, 1e-3, [x, y, 0]));
  return places.slice(1).map((b, k) => ({ a: places[k], b, ink: INKS[theme].faint, width: 1.5 }));
}

/** Returns lines from each point, unless there are many, down to the plane of the array, with a ring at its end; and the slices' borders. */
export function guides(picture: Picture, plane: number): Line[] {
  const { faint, strong } = INKS[picture.theme];
  const foot = (picture.points.length > MANY ? [] : picture.points).flatMap(([x, y, z]): Line[] => [
    { a: [x, y, z], b: [x, y, plane], ink: faint, width: 1 },
    ...ring([x, y, plane], 0.003, strong, 1.2),
  ]);
  return [...foot, ...palm(picture), ...picture.slices.flatMap(({ lattice }) => outline(lattice, faint, 1))];
}
