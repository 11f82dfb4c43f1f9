/** Compare: two methods A and B, one slice that a movable line divides between them, and their metrics. */

import { changes } from "../state/changes.ts";
import { type Context } from "./context.ts";
import { choice, draggable, element, explained, resize, write } from "./dom.ts";
import { MANY, MOST_POINTS } from "../state/initial.ts";
import { createInstrument } from "./instrument.ts";
import { numberRows, percent, pressure, type Row, sentenceOf, weakest } from "./numbers.ts";
import { drawPixels, entry, type MapName, mapOf, type Tick, ticks } from "../painter/maps.ts";
import { onPlane, placeOn } from "../state/plane.ts";
import { added, moved } from "../state/points.ts";
import { shownOf } from "../solving/studio.ts";
import { touchOf } from "../solving/touch.ts";
import type { Look, Slot, Vec3 } from "../state/types.ts";

/** The page's elements for the comparison. */
export type Compare = ReturnType<typeof createCompare>;

const SLOTS: Slot[] = [0, 1];

/** Makes the elements of the comparison. */
export function createCompare(context: Context) {
  const { studio, say, plain, engine } = context;
  const state = () => studio.view.state;
  const solvers = engine.catalogue.solvers.map(({ name }) => [name, name] as const);
  const parts = SLOTS.map((slot) => {
    const letter = "AB"[slot];
    const method = choice(
      solvers,
      state().methods[slot],
      (name) => studio.change({ methods: state().methods.map((old, k) => (k === slot ? name : old)) as [string, string] }),
      { "aria-label": say("method", { slot: letter }) },
    );
    const badge = element("span", { className: `badge ${letter.toLowerCase()}` }, letter);
    const summary = explained(element("p", { className: "summary" }), say("summaryTip"));
    const refusal = element("p", { className: "refusal" });
    const root = element("section", { className: "method", "aria-label": say("method", { slot: letter }) }, badge, method, summary, refusal);
    // Over the slice: its letter with the weakest |p|; beside it: |p| of each point, as dots.
    const caption = element("b", { className: `caption ${letter.toLowerCase()}`, "aria-hidden": "true" });
    const strip = element("div", { className: "strip", "aria-hidden": "true" });
    root.append(strip);
    return { root, method, summary, refusal, caption, strip, dots: [] as HTMLElement[] };
  });
  const picture = element("div", { className: "slice", role: "img", "aria-label": say("slices") });
  const wiper = element("input", { className: "wiper", type: "range", min: 0, max: 1, step: 0.01, value: 0.5, "aria-label": say("wiper"), oninput: context.repaint });
  const bar = element("canvas", { className: "bar", width: 1, height: 256, "aria-hidden": "true" });
  const labels = element("div", { className: "ticks", "aria-hidden": "true" });
  const scale = explained(element("div", { className: "scale", role: "img", "aria-label": say("scaleOf") }, bar, labels), say("scaleTip"));
  const root = element(
    "section",
    { className: "pane", "aria-label": say("methods") },
    element("div", { className: "methods" }, ...parts.map((part) => part.root)),
    element("div", { className: "row" }, element("div", { className: "wipe" }, picture, ...parts.map(({ caption }) => caption), wiper), scale),
  );
  const rings: HTMLElement[] = [];
  const order = createInstrument(context, picture, (right) => (wiper.hidden ? (shownOf(studio.view)[0].lattice ? 0 : 1) : right < +wiper.value ? 0 : 1));
  // The role is set, because the CSS shows the rows as a grid and browsers then forget that this is a table.
  const table = element("table", { className: "numbers", role: "table" });
  const warnings = element("ul", { className: "warnings" });

  const metres = (event: MouseEvent): Vec3 => {
    const box = picture.getBoundingClientRect();
    return placeOn(state().plane, (event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
  };
  draggable(picture, studio, {
    begin(event) {
      const index = rings.indexOf(event.target as HTMLElement);
      return index < 0 ? null : { index, from: metres(event), point: state().points[index] };
    },
    move({ index, from, point }, event, gesture) {
      const to = metres(event).map((x, axis) => point[axis] + x - from[axis]) as Vec3;
      studio.change(moved(state(), index, to), gesture);
    },
  });
  picture.ondblclick = (event) => {
    if (state().points.length >= MOST_POINTS) return context.alarm(say("tooMany", { count: MOST_POINTS + 1 }));
    studio.change(added(state(), metres(event)));
    context.announce(say("added", { n: state().points.length }));
  };

  function ring() {
    const points = studio.view.frame?.points ?? state().points;
    picture.classList.toggle("many", points.length > MANY);
    resize(picture, rings, points.length, () => element("i", { className: "ring" }));
    rings.forEach((each, index) => {
      const [right, up, off] = onPlane(state().plane, points[index]);
      each.style.left = `${100 * right}%`;
      each.style.top = `${100 - 100 * up}%`;
      each.classList.toggle("off", Math.abs(off) > 0.002);
    });
  }

  /** Writes the table only if it has changed, because that costs a layout. */
  const writeRows = changes((text: string) => {
    const rows = (JSON.parse(text) as Row[]).map(({ word, values, better }) =>
      element(
        "tr",
        { role: "row" },
        explained(element("th", { scope: "row", role: "rowheader" }, say(word)), say(`${word}Tip`)),
        ...values.map((value, slot) =>
          element("td", { role: "cell", className: better === slot ? "better" : "", colSpan: values.length === 1 ? 2 : 1 }, value),
        ),
      ),
    );
    const head = element("tr", { role: "row" }, element("td", { role: "cell" }), ...["A", "B"].map((name) => element("th", { scope: "col", role: "columnheader" }, name)));
    table.replaceChildren(element("caption", { className: "hidden" }, say("numbers")), head, ...rows);
  });
  const writeWarnings = changes((text: string) => {
    const lines = JSON.parse(text) as string[];
    const items = lines.map((line) => element("li", {}, line));
    warnings.replaceChildren(...(lines.length ? [element("li", {}, `${say("notes")}:`)] : []), ...items);
  });

  const writeBar = changes((map: MapName) => drawPixels(bar, (_, up) => entry(map, up)));
  const writeTicks = changes((text: string) => {
    const spans = (JSON.parse(text) as Tick[]).map(({ at, label }) => {
      const tick = element("span", {}, label);
      tick.style.bottom = `${100 * at}%`;
      return tick;
    });
    labels.replaceChildren(...spans);
  });

  return {
    /** Both methods above one slice. A movable line (the wiper) divides it: A's field to its left, B's to its right. */
    root,
    /** The element over which the painter paints the slice. */
    slice: picture,
    /** Returns the part of the slice's width that shows A, 0 to 1. */
    share: () => +wiper.value,
    /** The table of metrics, and the warnings. */
    numbers: [table, warnings],
    update(look: Look) {
      const { frame } = studio.view;
      const results = shownOf(studio.view);
      for (const slot of SLOTS) {
        const { method, summary, refusal } = parts[slot];
        const { answer, refused } = results[slot];
        if (method.value !== state().methods[slot]) method.value = state().methods[slot];
        const still = frame !== null && !frame.results[slot];
        const felt = slot === 0 && touchOf(state()) ? sentenceOf(studio.view) : null;
        const shown = felt ? say(felt.word, felt.put) : answer && !still ? say("summary", { pressure: pressure(weakest(results[slot])), evenness: percent(answer.metrics.uniformity) }) : "";
        write(summary, [frame?.names[slot], shown].filter(Boolean).join(felt ? ": " : "  "));
        parts[slot].root.classList.toggle("still", still);
        write(refusal, refused ? say("unsolved", { line: plain(refused) }) : "");
        refusal.hidden = !refused;
        const loud = answer && !still ? answer.pressures.map(([re, im]) => Math.hypot(re, im)) : [];
        write(parts[slot].caption, `${"AB"[slot]} ${loud.length ? pressure(weakest(results[slot])) : ""}`);
        resize(parts[slot].strip, parts[slot].dots, loud.length, () => element("i"));
        parts[slot].dots.forEach((dot, k) => {
          dot.style.left = `${(100 * (k + 0.5)) / loud.length}%`;
          dot.style.bottom = `${Math.min(100, (100 * loud[k]) / look.top)}%`;
        });
      }
      wiper.hidden = results.some(({ lattice }) => !lattice);
      ring();
      order();
      writeBar(mapOf(look));
      writeTicks(JSON.stringify(ticks(look)));
      writeRows(JSON.stringify(numberRows(studio.view)));
      writeWarnings(JSON.stringify([...new Set(results.flatMap((result) => result.warnings.map(plain)))]));
    },
  };
}
