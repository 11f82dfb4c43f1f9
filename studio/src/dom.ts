/** Elements, made short. */

type Child = Node | string | null | undefined | false;
type Given = Record<string, unknown>;

/** An element with properties (`onclick`), attributes (`aria-label`), and children. */
export function element<Name extends keyof HTMLElementTagNameMap>(
  name: Name,
  given: Given = {},
  ...children: Child[]
): HTMLElementTagNameMap[Name] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(given)) {
    if (key.includes("-") || key === "role" || key === "for") made.setAttribute(key, String(value));
    else Object.assign(made, { [key]: value });
  }
  made.append(...children.filter((child): child is Node | string => Boolean(child)));
  return made;
}

/** Writes a text only where it has changed: screen readers and the caret are left in peace. */
export function write(place: HTMLElement, text: string): void {
  if (place.textContent !== text) place.textContent = text;
}

/** A titled group of controls. */
export function group(title: string, ...children: (Node | null)[]): HTMLElement {
  return element("section", { className: "group" }, element("h2", {}, title), ...children);
}

/** A control with its name, and what it says beside. */
export function labelled(name: string, control: HTMLElement, aside?: HTMLElement): HTMLElement {
  return element("label", { className: aside ? "field wide" : "field" }, element("span", {}, name), aside, control);
}

/** A select of [value, text] pairs. */
export function choice(
  pairs: readonly (readonly [string, string])[],
  value: string,
  change: (value: string) => void,
  given: Given = {},
): HTMLSelectElement {
  const select = element("select", { onchange: () => change(select.value), ...given });
  offer(select, pairs, value);
  return select;
}

/** Gives a select its pairs, if they are others, and its value. */
export function offer(select: HTMLSelectElement, pairs: readonly (readonly [string, string])[], value: string): void {
  const same =
    select.options.length === pairs.length &&
    pairs.every(([key, text], k) => select.options[k].value === key && select.options[k].text === text);
  if (!same) select.replaceChildren(...pairs.map(([key, text]) => new Option(text, key)));
  if (select.value !== value) select.value = value;
}
