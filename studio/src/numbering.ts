/** Numbering: where the numbers of rings stand, so that they cover no ring and not one another. */

/** From a ring to its number; the first way that is free is taken. */
const WAYS = [[1, -1], [1, 1], [-1, -1], [-1, 1], [1, 0], [-1, 0], [0, -1], [0, 1]];

/** A number's box is so high for its width. */
const HIGH = 0.85;

/** Where a number's middle is beside its ring's, in px, and whether it covers nothing there. */
export interface Spot {
  x: number;
  y: number;
  free: boolean;
}

/** Spots of the numbers of rings at places [x, y] with that radius, in boxes of that width; all in px. */
export function number(rings: readonly (readonly number[])[], radius: number, width: number): Spot[] {
  const [wide, high] = [width / 2, (HIGH * width) / 2];
  const kept: number[][] = [];
  return rings.map(([x, y]) => {
    const ways = WAYS.map(([right, down]) => {
      const way = radius * (right && down ? Math.SQRT1_2 : 1) + 1;
      return [right * (way + wide), down * (way + high)];
    });
    const free = ways.find(
      ([dx, dy]) =>
        rings.every(
          ([u, v]) =>
            Math.hypot(Math.max(Math.abs(x + dx - u) - wide, 0), Math.max(Math.abs(y + dy - v) - high, 0)) >= radius,
        ) && kept.every(([u, v]) => Math.abs(x + dx - u) >= width || Math.abs(y + dy - v) >= HIGH * width),
    );
    if (free) kept.push([x + free[0], y + free[1]]);
    const [dx, dy] = free ?? ways[0];
    return { x: dx, y: dy, free: Boolean(free) };
  });
}
