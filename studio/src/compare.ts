/** Compare: two methods, their slices on one colour scale, and their numbers. */

import { changes } from "./changes.ts";
import { type Context } from "./context.ts";
import { choice, element, write } from "./dom.ts";
import { MOST_POINTS } from "./initial.ts";
import { numberRows, type Row } from "./numbers.ts";
import { entry, mapOf, type Tick, ticks } from "./painter/maps.ts";
import { onPlane, placeOn } from "./plane.ts";
import { added, moved } from "./points.ts";
import { MANY } from "./stage.ts";
import type { Look, Slot, Vec3 } from "./types.ts";
import type { Word } from "./words.ts";

/** The right column. */
export interface Compare {
  root: HTMLElement;
  /** Where the slices are painted. */
  slices: [HTMLElement, HTMLElement];
  place(look: Look): void;
}

const SLOTS: Slot[] = [0, 1];

/** Makes the column. */
export function createCompare(context: Context): Compare {
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
    const summary = element("p", { className: "summary" });
    const picture = element("div", { className: "slice", role: "img", "aria-label": say("sliceOf", { slot: letter }) });
    const bar = element("canvas", { className: "bar", width: 1, height: 256, "aria-hidden": "true" });
    const labels = element("div", { className: "ticks", "aria-hidden": "true" });
    const refusal = element("p", { className: "refusal" });
    const root = element(
      "section",
      { className: "method", "aria-label": say("method", { slot: letter }) },
      element("header", {}, badge, method, summary),
      element("div", { className: "row" }, picture, bar, labels),
      refusal,
    );
    const rings: HTMLElement[] = [];
    listen(picture, rings);
    return { root, method, summary, picture, bar, labels, refusal, rings };
  });
  const table = element("table", { className: "numbers" });
  const warnings = element("ul", { className: "warnings" });
  const root = element("aside", { className: "compare" }, ...parts.map((part) => part.root), table, warnings);

  /** Points are dragged in a slice, too; a double click makes a new one. */
  function listen(picture: HTMLElement, rings: HTMLElement[]) {
    let begin: { index: number; at: Vec3; point: Vec3 } | null = null;
    let gesture = 0;
    const metres = (event: MouseEvent): Vec3 => {
      const box = picture.getBoundingClientRect();
      return placeOn(state().plane, (event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
    };
    picture.onpointerdown = (event) => {
      const index = rings.indexOf(event.target as HTMLElement);
      if (index < 0) return;
      picture.setPointerCapture(event.pointerId);
      begin = { index, at: metres(event), point: state().points[index] };
      gesture += 1;
      studio.moving(true);
    };
    picture.onpointermove = (event) => {
      if (!begin) return;
      const { at, point } = begin;
      const to = metres(event).map((x, axis) => point[axis] + x - at[axis]) as Vec3;
      studio.change(moved(state(), begin.index, to), `drag slice ${gesture}`);
    };
    picture.onpointerup = picture.onpointercancel = () => {
      if (begin) studio.moving(false);
      begin = null;
    };
    picture.ondblclick = (event) => {
      if (state().points.length >= MOST_POINTS) return context.alarm(say("tooMany", { count: MOST_POINTS + 1 }));
      studio.change(added(state(), metres(event)));
      context.announce(say("added", { n: state().points.length }));
    };
  }

  function ring(slot: Slot) {
    const { picture, rings } = parts[slot];
    // What moves is A's.
    const points = (slot === 0 && studio.view.frame?.points) || state().points;
    picture.classList.toggle("many", points.length > MANY);
    while (rings.length > points.length) rings.pop()!.remove();
    while (rings.length < points.length) {
      const made = element("i", { className: "ring" });
      rings.push(made);
      picture.append(made);
    }
    rings.forEach((each, index) => {
      const [right, up, off] = onPlane(state().plane, points[index]);
      each.style.left = `${100 * right}%`;
      each.style.top = `${100 - 100 * up}%`;
      each.classList.toggle("off", Math.abs(off) > 0.002);
    });
  }

  /** Writes the table anew, which costs a layout: only when something in it is. */
  const writeRows = changes((text: string) => {
    const rows = (JSON.parse(text) as Row[]).map(({ word, values, better }) =>
      element(
        "tr",
        {},
        element("th", { scope: "row" }, say(word as Word)),
        ...values.map((value, slot) =>
          element("td", { className: better === slot ? "better" : "", colSpan: values.length === 1 ? 2 : 1 }, value),
        ),
      ),
    );
    const head = element("tr", {}, element("td", {}), ...["A", "B"].map((name) => element("th", { scope: "col" }, name)));
    table.replaceChildren(element("caption", { className: "hidden" }, say("numbers")), head, ...rows);
  });
  const writeWarnings = changes((text: string) => {
    const lines = JSON.parse(text) as string[];
    const items = lines.map((line) => element("li", {}, plain(line)));
    warnings.replaceChildren(...(lines.length ? [element("li", {}, `${say("notes")}:`)] : []), ...items);
  });

  const writeBars = changes((map: ReturnType<typeof mapOf>) => parts.forEach(({ bar }) => paint(bar, map)));
  const writeTicks = changes((text: string) => {
    for (const { labels } of parts) {
      const spans = (JSON.parse(text) as Tick[]).map(({ at, label }) => {
        const tick = element("span", {}, label);
        tick.style.bottom = `${100 * at}%`;
        return tick;
      });
      labels.replaceChildren(...spans);
    }
  });

  return {
    root,
    slices: [parts[0].picture, parts[1].picture],
    place(look) {
      for (const slot of SLOTS) {
        const { method, summary, refusal } = parts[slot];
        const { answer, refused } = studio.view.results[slot];
        if (method.value !== state().methods[slot]) method.value = state().methods[slot];
        const moves = Boolean(studio.view.frame?.found);
        const shown = answer ? `U ${answer.metrics.uniformity.toFixed(3)}` : "";
        write(summary, moves ? (slot ? say("atRest") : "glide") : shown);
        parts[slot].root.classList.toggle("still", moves && slot === 1);
        write(refusal, refused && say("unsolved", { line: plain(refused) }));
        refusal.hidden = refused === "";
        ring(slot);
      }
      writeBars(mapOf(look));
      writeTicks(JSON.stringify(ticks(look)));
      const { results } = studio.view;
      writeRows(JSON.stringify(numberRows(studio.view)));
      writeWarnings(JSON.stringify([...new Set(results.flatMap((result) => result.warnings))]));
    },
  };
}

/** The colour bar: the map from bottom to top. */
function paint(bar: HTMLCanvasElement, map: ReturnType<typeof mapOf>) {
  const context = bar.getContext("2d")!;
  const image = context.createImageData(1, 256);
  for (let k = 0; k < 256; k += 1) {
    image.data.set([...entry(map, 1 - k / 255), 255], 4 * k);
  }
  context.putImageData(image, 0, 0);
}

