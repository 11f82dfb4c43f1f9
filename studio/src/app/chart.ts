/** Chart: curves over the frames of a turn, one below the other, with a mark at the shown frame. */

import { element } from "./dom.ts";

/** A curve: its values of all frames, 0 or more, and the largest value as text with its unit. */
export interface Curve {
  name: string;
  values: number[];
  most: string;
}

/** Makes a chart of curves over this many ms, and a function that moves the mark to a frame. Screen readers read `label`. */
export function createChart(curves: Curve[], milliseconds: number, label: string) {
  const marks: HTMLElement[] = [];
  const rows = curves.map(({ name, values, most }) => {
    const top = Math.max(...values) || 1;
    const points = values.map((value, k) => `${k},${(1 - value / top).toFixed(4)}`).join(" ");
    const mark = element("i");
    marks.push(mark);
    const plot = element("div", {
      innerHTML: `<svg viewBox="0 -.02 ${values.length - 1} 1.04" preserveAspectRatio="none"><polyline points="${points}"/></svg>`,
    });
    plot.append(mark);
    return element("div", {}, element("p", {}, element("span", {}, name), `0 – ${most}`), plot);
  });
  const axis = element("p", {}, element("span", {}, "0"), `${Number(milliseconds.toPrecision(3))} ms`);
  return {
    root: element("div", { className: "chart", role: "img", "aria-label": label }, ...rows, axis),
    mark(part: number) {
      for (const mark of marks) mark.style.left = `${100 * part}%`;
    },
  };
}
