/** Touch: which quantities are those of a skin, and the slice on which a skin lies. */

import type { Quantity, State, TouchQuantity } from "../state/types.ts";

/** Margin of the skin around the points and their path, in m. */
const MARGIN = 0.02;

/** The size of a skin is a multiple of this, in m. */
const STEP = 0.005;

/** The smallest size of a slice, in m. */
const LEAST = 0.04;

export const isTouch = (quantity: Quantity): quantity is TouchQuantity => quantity === "felt" || quantity === "skin";

/** Returns the quantity of a skin that a state shows, if its points move on a path; otherwise null. */
export const touchOf = ({ quantity, path }: State): TouchQuantity | null => (path && isTouch(quantity) ? quantity : null);

/** Returns a slice normal to z through the middle of the points, with their paths and a margin. */
export function skinPlane({ points, path }: State): State["plane"] {
  const [x, y, z] = [0, 1, 2].map((axis) => {
    const all = points.map((point) => point[axis]);
    return { least: Math.min(...all), most: Math.max(...all) };
  });
  const middle = ({ least, most }: typeof x) => Math.round(5e5 * (least + most)) / 1e6;
  const turn = path?.kind === "circle" ? 2 * path.radius : (path?.length ?? 0);
  const wide = Math.max(x.most - x.least, y.most - y.least) + turn + 2 * MARGIN;
  const size = Math.max(LEAST, Math.ceil(wide / STEP - 1e-6) * STEP);
  return { axis: "z", z: middle(z), size: Math.round(1e6 * size) / 1e6, center: [middle(x), middle(y)] };
}
