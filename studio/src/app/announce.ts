/** Announcements: tells users of screen readers about changes. */

import { type Context, millimetres } from "./context.ts";
import { middleOf, SIDES } from "../state/plane.ts";
import type { State } from "../state/types.ts";
import type { Word } from "./words.ts";

/** For each part of the state, the word and the value that are announced when it changes. */
const SAID: { [Key in keyof State]?: [Word, (state: State) => string] } = {
  array: ["array", ({ array }) => ("preset" in array ? `${array.preset} ${array.tiles.join(" × ")}` : array.name)],
  quantization: ["levels", ({ quantization }) => quantization],
  temperature: ["temperature", ({ temperature }) => `${temperature} °C`],
  points: ["points", ({ points }) => String(points.length)],
  pressures: ["target", ({ pressures }) => pressures?.join(", ") ?? "max"],
  methods: ["methods", ({ methods }) => methods.join(", ")],
  signature: ["signature", ({ signature }) => signature || "–"],
  obstacles: ["obstacle", ({ obstacles }) => String(obstacles.length)],
  ear: ["ear", ({ ear }) => ear?.map(millimetres).join(", ") ?? "–"],
  plane: ["slice", ({ plane }) => `${plane.axis} ${millimetres(middleOf(plane)[SIDES[plane.axis][2]])} mm, ${millimetres(plane.size)} mm`],
  level: ["levelOfPage", ({ level }) => level],
  view: ["view", ({ view }) => view],
  slot: ["shownSlot", ({ slot }) => "AB"[slot]],
  scale: ["scale", ({ scale }) => scale],
  path: ["path", ({ path }) => path?.kind ?? "–"],
};

/** Announces each part of the state that has changed. */
export function announceChanges({ studio, listen, announce, say }: Context): void {
  let before = studio.view.state;
  listen(() => {
    const { state, moving } = studio.view;
    if (moving || state === before) return;
    for (const [key, [word, text]] of Object.entries(SAID)) {
      const part = (of: State) => JSON.stringify(of[key as keyof State]);
      const moved = key === "points" && before.points.length === state.points.length;
      if (!moved && part(state) !== part(before)) announce(`${say(word)}: ${key === "level" ? say(state.level) : text(state)}`);
    }
    before = state;
  });
}
