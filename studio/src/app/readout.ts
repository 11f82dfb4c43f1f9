/** Readout: |p|, level, phase and radiation pressure at the pointer's place, computed for this place. */

import { type Context, millimetres } from "./context.ts";
import { element } from "./dom.ts";
import { pressure, strengthLevel } from "./numbers.ts";
import { sample } from "../painter/lattice.ts";
import { playedOf, shownOf } from "../solving/studio.ts";
import type { Slot, Vec3 } from "../state/types.ts";

/** Makes a readout, with functions that show it for a place in a slot's field and hide it; `shown` is called with its text. */
export function createReadout({ studio, engine, say }: Context, shown: (line: string) => void = () => undefined) {
  const root = element("div", { className: "readout", hidden: true, role: "status", "aria-live": "off" });
  let wanted: [Slot, Vec3] | null = null;
  let busy = false;

  function write(lines: string[]) {
    root.replaceChildren(...lines.map((line) => element("div", {}, line)));
    shown(lines.join(", "));
  }

  /** Computes one place at a time; then continues with the newest requested place. */
  async function ask() {
    if (busy) return;
    busy = true;
    while (wanted) {
      const [slot, place] = wanted;
      wanted = null;
      const { answer, lattice } = shownOf(studio.view)[slot];
      const where = `${"AB"[slot]}  ${place.map((x, axis) => `${"xyz"[axis]} ${millimetres(x)}`).join("  ")} mm`;
      const touch = studio.view.frame?.touch;
      if (touch && lattice) {
        const [value] = sample(lattice, place);
        const text = { felt: `${strengthLevel(value).toFixed(1)} dB`, push: pressure(value), skin: `${(1e6 * value).toFixed(1)} µm` }[touch.quantity];
        write([where, `${say(touch.quantity)} ${text}`]);
        continue;
      }
      if (!answer) continue;
      const probe = await engine.slots[slot].probe(studio.scene(slot), playedOf(answer), place).catch(() => null);
      if (!probe || root.hidden) continue;
      const [re, im] = probe.pressure;
      write([
        where,
        `|p| ${pressure(Math.hypot(re, im))}  ·  ${probe.level.toFixed(1)} dB SPL`,
        `${say("phase")} ${Math.atan2(im, re).toFixed(2)} rad  ·  ${say("radiation")} ${pressure(probe.radiation)}`,
      ]);
    }
    busy = false;
  }

  return {
    root,
    show(slot: Slot, place: Vec3) {
      root.hidden = false;
      wanted = [slot, place.map((x) => Math.round(x * 1e5) / 1e5) as Vec3];
      void ask();
    },
    hide() {
      root.hidden = true;
      wanted = null;
    },
  };
}
