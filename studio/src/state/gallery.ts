/** Gallery: example scenes, each of which demonstrates a difference between its two methods. */

import ball from "../../../docs/scenes/gallery/ball.json";
import ear from "../../../docs/scenes/gallery/ear.json";
import letters from "../../../docs/scenes/gallery/letters.json";
import pair from "../../../docs/scenes/gallery/pair.json";
import ring from "../../../docs/scenes/gallery/ring.json";
import smiley from "../../../docs/scenes/gallery/smiley.json";
import traps from "../../../docs/scenes/gallery/traps.json";
import weak from "../../../docs/scenes/gallery/weak.json";
import texts from "./gallery.json";
import { initial } from "./initial.ts";
import { type SceneFile, stateOf } from "./scene_file.ts";
import type { State } from "./types.ts";

const SCENES: Record<string, object> = { ball, ear, letters, pair, ring, smiley, traps, weak };

/**
 * The examples: the name and a line, in English and in Japanese, and the state. Each has a scene with method A, or the name of
 * its file, which an example of the Python package uses, too; method B; and what else its state has.
 */
export const gallery = texts.map(({ scene, b, name, line, more }) => {
  const state = stateOf((typeof scene === "string" ? SCENES[scene] : scene) as SceneFile, initial);
  return { name, line, state: { ...state, methods: [state.methods[0], b], ...more } as State };
});
