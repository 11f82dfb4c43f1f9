/** Short functions that make DOM elements, and let pointers and keys move them. */

import type { Vec3 } from "../state/types.ts";

type Child = Node | string | null | undefined | false;
type Properties = Record<string, unknown>;

/** Makes an element with properties (`onclick`), attributes (`aria-label`) and children. */
export function element<Name extends keyof HTMLElementTagNameMap>(
  name: Name,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[Name] {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes("-") || key === "role" || key === "for") node.setAttribute(key, String(value));
    else Object.assign(node, { [key]: value });
  }
  node.append(...children.filter((child): child is Node | string => Boolean(child)));
  return node;
}

/** Returns a small drawing as SVG, from the path on a square of 24. */
export const icon = (path: string) =>
  `<svg viewBox="0 0 24 24" width="20" height="20" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="2" stroke-linejoin="round" stroke-linecap="round"><path d="${path}"/></svg>`;

/** Writes a text only if it has changed, so that screen readers do not repeat it and the caret does not move. */
export function write(label: HTMLElement, text: string): void {
  if (label.textContent !== text) label.textContent = text;
}

/** Makes or removes elements at the end of a list, which are children of `root`, until there are `count`. */
export function resize<Each extends Element>(root: Element, list: Each[], count: number, make: (index: number) => Each): void {
  while (list.length > count) list.pop()!.remove();
  while (list.length < count) root.append((list[list.length] = make(list.length)));
}

/** Marks an element to be explained in one line by `createTips`, while the pointer or the focus is in it. */
export function explained<Each extends HTMLElement>(each: Each, line: string): Each {
  each.dataset.tip = line;
  if (!each.querySelector("input, select") && !each.matches("input, select, button")) each.tabIndex = 0;
  return each;
}

/** Makes a titled group of controls that folds. `holds` is an element in its title for a summary of its content. */
export function group(title: string, ...children: (Node | null)[]): { root: HTMLDetailsElement; holds: HTMLElement } {
  const holds = element("span");
  const summary = element("summary", {}, element("h2", {}, title), holds);
  return { root: element("details", { className: "group" }, summary, ...children), holds };
}

/** Makes a label for a control, with a value beside its name; `tip` explains the value. */
export function labelled(name: string, control: HTMLElement, aside?: HTMLElement | null, tip?: string): HTMLElement {
  const label = element("label", { className: aside ? "field wide" : "field" }, element("span", {}, name), aside, control);
  return tip ? explained(label, tip) : label;
}

/** Makes a row of buttons of which one is chosen. */
export function segments(name: string, pairs: readonly (readonly string[])[], choose: (value: string) => void) {
  const buttons = pairs.map(([value, text]) => element("button", { value, onclick: () => choose(value) }, text));
  return {
    root: element("div", { className: "joined", role: "group", "aria-label": name }, ...buttons),
    choose: (value: string) => buttons.forEach((each) => each.setAttribute("aria-pressed", String(each.value === value))),
  };
}

/** Makes a select of [value, text] pairs. */
export function choice(
  pairs: readonly (readonly [string, string])[],
  value: string,
  change: (value: string) => void,
  properties: Properties = {},
): HTMLSelectElement {
  const select = element("select", { onchange: () => change(select.value), ...properties });
  offer(select, pairs, value);
  return select;
}

/** Sets the [value, text] pairs of a select, if they have changed, and its value. */
export function offer(select: HTMLSelectElement, pairs: readonly (readonly [string, string])[], value: string): void {
  const same =
    select.options.length === pairs.length &&
    pairs.every(([key, text], k) => select.options[k].value === key && select.options[k].text === text);
  if (!same) select.replaceChildren(...pairs.map(([key, text]) => new Option(text, key)));
  if (select.value !== value) select.value = value;
}

/** Steps of the keys in m: without and with Shift. */
const STEPS = [1e-3, 1e-2];

const WAYS: Record<string, Vec3> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** Returns the shift in m of a key that moves something; null for other keys. */
export const stepOf = ({ key, shiftKey }: KeyboardEvent) => (WAYS[key]?.map((x) => STEPS[Number(shiftKey)] * x) ?? null) as Vec3 | null;

/** A drag: `begin` returns the dragged thing, or null; `move` is called with it and with the gesture's name. */
interface Drag<Grip> {
  begin(event: PointerEvent): Grip | null;
  move(grip: Grip, event: PointerEvent, gesture: string): void;
  end?(grip: Grip, event: PointerEvent): void;
}

let gestures = 0;

/** Lets a pointer drag something by a handle. Meanwhile something moves in the studio. */
export function draggable<Grip>(handle: HTMLElement, studio: { setMoving(moving: boolean): void }, { begin, move, end }: Drag<Grip>): void {
  let grip: Grip | null = null;
  handle.onpointerdown = (event) => {
    grip = begin(event);
    if (grip === null) return;
    handle.setPointerCapture(event.pointerId);
    gestures += 1;
    studio.setMoving(true);
  };
  handle.onpointermove = (event) => grip !== null && move(grip, event, `drag ${gestures}`);
  handle.onpointerup = handle.onpointercancel = (event) => {
    if (grip === null) return;
    const ended = grip;
    grip = null;
    studio.setMoving(false);
    end?.(ended, event);
  };
}
