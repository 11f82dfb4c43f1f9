/** Table of points: places and targets, which users can type. */

import { type Context, millimetres } from "./context.ts";
import { element, explained, resize } from "./dom.ts";
import { MOST_POINTS } from "../state/initial.ts";
import { added, withTarget, moved, removed } from "../state/points.ts";
import { AXES, type Vec3 } from "../state/types.ts";

/** Makes the table. */
export function createPointTable(context: Context): { root: HTMLElement; update(): void } {
  const { studio, say } = context;
  const state = () => studio.view.state;
  const rows: HTMLTableRowElement[] = [];
  const body = element("tbody");
  const heads = [...AXES.map((axis) => `${axis} mm`), say("target")].map((text, k) =>
    explained(element("th", { scope: "col" }, text), say(k < AXES.length ? "coordinateTip" : "targetHint")),
  );
  const table = element(
    "table",
    { className: "points" },
    element("thead", {}, element("tr", {}, element("td"), ...heads, element("td"))),
    body,
  );
  const add = element("button", { className: "small", onclick: extend }, `+ ${say("add")}`);

  function extend() {
    const { plane, points } = state();
    if (points.length >= MOST_POINTS) return context.alarm(say("tooMany", { count: points.length + 1 }));
    const [x, y] = plane.center;
    const free = Array.from({ length: MOST_POINTS }, (_, k): Vec3 => {
      const [radius, angle] = [0.006 * Math.sqrt(k), 2.4 * k];
      return [x + radius * Math.cos(angle), y + radius * Math.sin(angle), plane.z];
    }).find((place) => points.every((point) => Math.hypot(...place.map((at, k) => at - point[k])) > 0.004));
    studio.change(added(state(), free ?? [x, y, plane.z]));
    context.announce(say("added", { n: points.length + 1 }));
  }

  function row(index: number) {
    const n = index + 1;
    const place = AXES.map((axis, k) =>
      element("input", {
        type: "number",
        step: 1,
        "aria-label": say("coordinate", { axis, n }),
        "data-tip": say("coordinateTip"),
        onchange: (event: Event) => {
          const { value } = event.target as HTMLInputElement;
          const to = [...state().points[index]] as Vec3;
          if (value !== "" && Number.isFinite(+value)) to[k] = +value / 1000;
          studio.change(moved(state(), index, to), `table ${index} ${k}`);
          showAll(true);
        },
      }),
    );
    const target = element("input", {
      type: "number",
      min: 0,
      step: 100,
      placeholder: "max",
      "aria-label": say("pressure", { n }),
      onchange: () => {
        const value = target.value === "" ? null : Number(target.value);
        if (value !== null && value < 0) context.alarm(say("negative", { value, n }));
        else studio.change(withTarget(state(), index, value, studio.view.results[0].answer?.targets ?? []), `target ${index}`);
        showAll(true);
      },
    });
    const remove = element(
      "button",
      {
        className: "plain",
        "aria-label": say("remove", { n }),
        onclick: () => {
          if (state().points.length === 1) return context.alarm(say("lastPoint"));
          studio.change(removed(state(), index));
          context.announce(say("removed", { n }));
        },
      },
      "×",
    );
    const cells = [...place, target, remove].map((control) => element("td", {}, control));
    return element("tr", {}, element("th", { scope: "row" }, String(n)), ...cells);
  }

  /** Writes the values; the field that is being typed in is not overwritten until it is `done`. */
  function showAll(done = false) {
    const { points, pressures, filled } = state();
    resize(body, rows, points.length, row);
    const { activeElement } = body.getRootNode() as Document | ShadowRoot;
    rows.forEach((row, index) => {
      const values = [...points[index].map(millimetres), pressures ? String(pressures[index]) : ""];
      row.querySelectorAll("input").forEach((input, k) => {
        if (k === AXES.length) {
          input.classList.toggle("filled", filled.includes(index));
          input.dataset.tip = say(filled.includes(index) ? "filledHint" : "targetHint");
        }
        if ((done || input !== activeElement) && input.value !== values[k]) input.value = values[k];
      });
    });
  }

  return { root: element("div", { className: "table" }, table, add), update: () => showAll() };
}
