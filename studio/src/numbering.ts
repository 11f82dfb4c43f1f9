/** Numbering: the places of the rings' numbers, so that they cover neither a ring nor one another. */

/** The shift from a ring to its number, right and down; the first free one is taken. */
const WAYS = [[0.7, -0.7], [0.7, 0.7], [-0.7, -0.7], [-0.7, 0.7], [1, 0], [-1, 0], [0, -1], [0, 1]];

/** A number's box is so high for its width. */
const HIGH = 0.85;

/**
 * Where the numbers' middles are beside those of rings at [x, y] with that radius, in boxes of that width, all in px;
 * undefined where there is no free place.
 */
export function number(rings: readonly (readonly number[])[], radius: number, width: number): (number[] | undefined)[] {
  const [wide, high] = [width / 2, (HIGH * width) / 2];
  // The covered rectangles: the middle of each, and half its width and height.
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
