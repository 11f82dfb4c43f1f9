/** Motion: the controls for the path of the points and for its player. */

import type { Context } from "./context.ts";
import { choice, element, labelled, write } from "./dom.ts";
import type { Player } from "./player.ts";
import type { Path } from "../state/types.ts";

/** Makes the controls. */
export function createMotion({ studio, say }: Context, player: Player): { root: HTMLElement; update(): void } {
  const state = () => studio.view.state;
  const kind = choice(
    (["none", "circle", "line"] as const).map((name) => [name, say(name)]),
    "none",
    (name) => studio.change({ path: pathOf(name) }),
  );
  const number = (set: (value: number) => Partial<Path>, min: number, max: number) => {
    const input = element("input", { type: "number", min, max });
    input.onchange = () => {
      const { path } = state();
      const value = Number(input.value);
      if (path && value >= min && value <= max) studio.change({ path: { ...path, ...set(value) } as Path });
      update();
    };
    return input;
  };
  const size = number((mm) => (state().path?.kind === "line" ? { length: mm / 1000 } : { radius: mm / 1000 }), 1, 100);
  const turns = number((frequency) => ({ frequency }), 0.1, 200);
  const move = element("button", { className: "small", onclick: player.toggle }, say("move"));
  const more = element("div", { className: "stack" }, labelled(say("radius"), size, null, say("radiusTip")), labelled(say("frequency"), turns, null, say("frequencyTip")), move, player.summary);

  function pathOf(name: string): Path | null {
    if (name === "circle") return { kind: "circle", radius: 0.01, frequency: 4 };
    return name === "line" ? { kind: "line", length: 0.02, frequency: 4 } : null;
  }

  function update() {
    const { path } = state();
    player.update();
    write(move, say(player.moves ? "rest" : "move"));
    kind.value = path?.kind ?? "none";
    more.hidden = path === null;
    if (path) {
      size.value = String(1000 * (path.kind === "line" ? path.length : path.radius));
      turns.value = String(path.frequency);
    }
  }

  return { root: element("div", { className: "stack" }, labelled(say("path"), kind), more), update };
}
