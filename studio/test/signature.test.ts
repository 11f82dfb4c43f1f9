// Signature: one name, or one for each point, in scene files, in links and as points are added and removed.
import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { compile, Door } from "../src/solving/door.ts";
import { initial } from "../src/state/initial.ts";
import { readLink, writeLink } from "../src/state/link.ts";
import { added, removed } from "../src/state/points.ts";
import { sceneOf, stateOf } from "../src/state/scene_file.ts";
import { isTrap, signatureOf } from "../src/state/signature.ts";
import type { State } from "../src/state/types.ts";

const state: State = { ...initial, array: { preset: "openmpd_pair", tiles: [1, 1] }, points: [[-0.02, 0, 0], [0.02, 0, 0], [0, 0.02, 0]], pressures: null, filled: [], signature: "trap.focus.vortex" };

test("a list goes to the core and comes back", async () => {
  const door = new Door(await compile(readFileSync(`${import.meta.dirname}/../built/midair.wasm`)));
  expect(sceneOf(state, 0).signature).toEqual(["trap", "focus", "vortex"]);
  door.open(JSON.stringify(sceneOf(state, 0)));
  door.solve();
  expect(stateOf(JSON.parse(door.save(false)), state).signature).toBe("trap.focus.vortex");
  expect(readLink(writeLink(state)).signature).toBe("trap.focus.vortex");
});

test("a list follows its points; a single focus is no trap", () => {
  expect(added(state, [0, 0, 0]).signature).toBe("trap.focus.vortex.vortex");
  expect(removed(state, 0).signature).toBe("focus.vortex");
  expect(removed(state, 0, 2).signature).toBe("");
  expect(removed(state, 1, 2).signature).toBe("trap");
  expect(signatureOf({ ...state, signature: "twin" }, [0], 2)).toBe("twin");
  expect([0, 1, 2].map((point) => isTrap(state.signature, point))).toEqual([true, false, true]);
  expect([isTrap("trap", 5), isTrap("", 0)]).toEqual([true, false]);
});
