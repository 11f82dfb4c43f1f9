import { expect, test } from "vitest";
import { gallery } from "../src/state/gallery.ts";
import { MOST_POINTS } from "../src/state/initial.ts";
import { readLink, writeLink } from "../src/state/link.ts";
import { sceneOf, stateOf } from "../src/state/scene_file.ts";

test("there are ten scenes of different names", () => {
  expect(gallery).toHaveLength(10);
  for (const language of [0, 1]) {
    expect(new Set(gallery.map(({ name }) => name[language])).size).toBe(10);
    expect(gallery.every(({ line }) => /^.{10,110}$/.test(line[language]))).toBe(true);
  }
});

test.each(gallery)("$name.0 is a link and a scene", ({ state }) => {
  expect(state.points.length).toBeGreaterThan(0);
  expect(state.points.length).toBeLessThanOrEqual(MOST_POINTS);
  expect(state.pressures?.length ?? state.points.length).toBe(state.points.length);
  const link = writeLink(state);
  expect(link.length).toBeLessThan(1300);
  const again = readLink(link);
  expect(writeLink(again)).toBe(link);
  expect({ ...stateOf(sceneOf(again, 0), state), path: again.path }).toEqual({ ...again, path: again.path });
});
