/** Numbering: places the numbers of points so that they cover neither a ring nor each other. */

/** Directions from a ring to its number, right and down; the first free one is used. */
const WAYS = [[0.7, -0.7], [0.7, 0.7], [-0.7, -0.7], [-0.7, 0.7], [1, 0], [-1, 0], [0, -1], [0, 1]];

/** Height of a number's box, relative to its width. */
const HIGH = 0.85;

/**
 * Returns the offset of each number's middle from its ring, for rings at [x, y] of this radius and boxes of this width, all in
 * px; undefined if there is no free place.
 */
export function number(rings: readonly (readonly number[])[], radius: number, width: number): (number[] | undefined)[] {
  const [wide, high] = [width / 2, (HIGH * width) / 2];
  // The covered rectangles: middle, half the width and half the height of each.
  const taken = rings.map(([x, y]) => [x, y, radius, radius]);
  return rings.map(([x, y], index) => {
    const free = WAYS.map(([right, down]) => [
      right * (radius + 1) + Math.sign(right) * wide,
      down * (radius + 1) + Math.sign(down) * high,
    ]).find(([dx, dy]) =>
      taken.every(([u, v, a, b], k) => k === index || Math.abs(x + dx - u) >= wide + a || Math.abs(y + dy - v) >= high + b),
    );
    if (free) taken.push([x + free[0], y + free[1], wide, high]);
    return free;
  });
}
