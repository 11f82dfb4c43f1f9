/** The interface for scripts: `window.midair`, with plain data as arguments and results. */

import { checked } from "../state/check.ts";
import type { Engine } from "../solving/engine.ts";
import { writeLink } from "../state/link.ts";
import { lookOf } from "./look.ts";
import { metricsOf, strengthLevel } from "./numbers.ts";
import type { Page } from "./page.ts";
import { onPlane } from "../state/plane.ts";
import { sample } from "../painter/lattice.ts";
import type { Studio } from "../solving/studio.ts";
import type { Slot, State, Vec3 } from "../state/types.ts";
import { Refusal } from "../state/notice.ts";

/** The functions that scripts may call; complex numbers are [re, im], lengths metres, pressures Pa. */
export type Hook = ReturnType<typeof createHook>;

const pairs = (values: Float32Array) =>
  Array.from({ length: values.length / 2 }, (_, k): [number, number] => [values[2 * k], values[2 * k + 1]]);

/** Makes the interface; `page` returns the page that is shown. */
export function createHook(engine: Engine, studio: Studio, page: () => Page) {
  const result = (slot: Slot) => {
    const { answer, lattice, refused } = studio.view.results[slot] ?? {};
    if (!answer || !lattice) throw refused ? new Refusal(refused) : new Error(`slot is ${slot}: give 0 or 1, once settled`);
    return { answer, lattice };
  };
  return {
    version: engine.catalogue.version,
    /** Returns a copy of the state and the results. */
    state(): Record<string, unknown> {
      const { state, results, bound, frame } = studio.view;
      const touch = frame?.touch ? { level: strengthLevel(frame.touch.most), width: frame.touch.width, peak: frame.touch.peak } : null;
      const metrics = results.map((each) => {
        const { answer, milliseconds, atEar } = each;
        return answer && { ...metricsOf(each), scale: answer.scale, status: answer.status, milliseconds, atEar: state.ear && atEar };
      });
      const refused = results.map((each) => each.refused?.text ?? "");
      const warnings = results.map((each) => each.warnings.map(({ text }) => text));
      const ready = results.some((each) => each.answer !== null || each.refused !== null);
      return structuredClone({ ready, ...state, top: lookOf(studio.view, "dark").top, metrics, bound, touch, refused, warnings });
    },
    /** Changes parts of the state; throws a message of one line if they are not valid. */
    set(partial: Partial<Omit<State, "plane">> & { plane?: Partial<State["plane"]> | null }): void {
      const now = studio.view.state;
      const plane = partial?.plane === null ? (null as never) : { ...now.plane, ...partial?.plane };
      const next = structuredClone({ ...now, ...("pressures" in partial && { filled: [] }), ...partial, plane });
      studio.change(checked(next, engine.catalogue));
    },
    /** Resolves when solutions and pictures match the state; the bound follows later. */
    settled: () => studio.settled(),
    /** Computes the field of a slot at places. */
    async field(slot: Slot, places: Vec3[]) {
      await studio.settled();
      result(slot);
      return pairs(await engine.slots[slot].field(Float64Array.from(places.flat())));
    },
    /** Returns the field as the slice's picture shows it, interpolated; null for places that are not on the slice. */
    shown(slot: Slot, places: Vec3[]) {
      const { lattice } = result(slot);
      return places.map((place) => {
        const [right, up, off] = onPlane(studio.view.state.plane, place);
        return Math.abs(off) > 1e-6 || Math.abs(right - 0.5) > 0.5 || Math.abs(up - 0.5) > 0.5 ? null : sample(lattice, place);
      });
    },
    /** Returns the drive of a slot. */
    drive: (slot: Slot) => pairs(result(slot).answer.drive),
    permalink: () => new URL(`#${writeLink(studio.view.state)}`, location.href).href,
    /** Returns where a place appears in the 3-D view, in CSS px of the window. */
    project: (place: Vec3) => page().project(place),
  };
}
