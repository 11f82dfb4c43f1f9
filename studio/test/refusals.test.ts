// Lines of the core as the page tells them: no file's places and examples; what is said most is Japanese on the Japanese page.
import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { compile, openDoor } from "../src/door.ts";
import { plain } from "../src/refusals.ts";

const door = openDoor(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));

/** The core's messages about points over an array. */
function said(points: object[], more: object = {}): string {
  try {
    door.open(JSON.stringify({ array: { preset: "sonicsurface" }, points, solver: { name: "uniform" }, ...more }));
    return door.solve().said.join("\n");
  } catch (error) {
    return (error as Error).message;
  }
}

const here = { position: [0.03, 0, 0.15] };
const obstacles = (each: object) => ({ obstacles: [{ ...each, kind: "rigid" }] });

test.each([
  [[{ position: [0, 0, -0.05] }], {}, /^point 1 is reached by no transducer/, /^点 1 に音が届き/],
  [[here, { position: [0, 0, 0.15] }], obstacles({ center: [0, 0, 0.15], radius: 0.02 }), /^point 2\.position is .*: inside the sphere/, /^点 2 は障害物の中/],
  [[here], obstacles({ center: [0, 0, 0.01], radius: 0.02 }), /^obstacles\[0\] is a sphere/, /^障害物がアレイに/],
  [[here], obstacles({ point: [0, 0, 0.1], normal: [0, 0, 1] }), /^point 1\.position is .*: behind the wall/, /^点 1 は障害物の中か裏/],
  [[here], obstacles({ point: [0.02, 0, 0.1], normal: [1, 0, 0] }), /^obstacles\[0\] is a wall/, /^障害物がアレイに/],
  [[{ ...here, pressure: 0 }], {}, /^pressures is all 0/, /^すべての点が 0 Pa/],
  [[{ ...here, pressure: 1e6 }], {}, /^point 1\.pressure is 1000000 Pa, beyond reach/, /^点 1 の音圧.*\d Pa です$/],
  [[{ ...here, pressure: 100 }], {}, /scale all drives by 0\.\d+/, /全駆動を 0\.\d+ 倍/],
])("%j %j", (points, more, english, japanese) => {
  const line = said(points, more);
  expect(plain("en", line)).toMatch(english);
  expect(plain("en", line)).not.toMatch(/scene file|for example|points\[/);
  expect(plain("ja", line)).toMatch(japanese);
  expect(plain("ja", line)).not.toMatch(/[a-z]{4}/);
});

test("other lines stay as they are", () => {
  expect(plain("ja", "steps is 0: give at least 1")).toBe("steps is 0: give at least 1");
});
