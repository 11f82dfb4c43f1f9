// Numbers of points: a number that has space covers no ring and no other number, wherever the rings are.
import { expect, test } from "vitest";

import { number } from "../src/app/numbering.ts";
import { generator } from "./random.ts";

test("a single ring's number is free, to its right and above", () => {
  expect(number([[50, 40]], 10, 20)).toEqual([[expect.closeTo(17.7, 5), expect.closeTo(-16.2, 5)]]);
});

test.each([3, 8, 16])("of %i rings", (count) => {
  const random = generator(count);
  let free = 0;
  for (let trial = 0; trial < 50; trial += 1) {
    const rings = Array.from({ length: count }, () => [120 * random(), 90 * random()]);
    const spots = number(rings, 7, 16);
    const boxes = spots.flatMap((spot, k) => (spot ? [[rings[k][0] + spot[0], rings[k][1] + spot[1]]] : []));
    free += boxes.length;
    boxes.forEach(([x, y], k) => {
      for (const [u, v] of rings) {
        expect(Math.hypot(Math.max(Math.abs(x - u) - 8, 0), Math.max(Math.abs(y - v) - 6.8, 0))).toBeGreaterThan(6.999);
      }
      for (const [u, v] of boxes.slice(0, k)) {
        expect(Math.abs(x - u) > 15.999 || Math.abs(y - v) > 13.599).toBe(true);
      }
    });
  }
  expect(free).toBeGreaterThan(25 * count);
});
