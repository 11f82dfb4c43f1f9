/** Tips: one line of explanation for a number, beside the pointer or the focus. */

import { element } from "./dom.ts";

/** The distance of a tip from its number and from the window's edge, in px. */
const GAP = 6;

/** Makes the tip of a page: one element that explains any element with `data-tip` in `root`, until `signal` aborts. */
export function createTips(root: HTMLElement, signal: AbortSignal): HTMLElement {
  const tip = element("div", { className: "tip", id: "tip", role: "tooltip", hidden: true });
  let target: HTMLElement | null = null;
  let described: Element | null = null;

  function hide() {
    tip.hidden = true;
    described?.removeAttribute("aria-describedby");
    target = described = null;
  }

  /** Places the tip below its number, or above if there is no space below. */
  function put() {
    if (!target) return;
    const [box, size] = [target.getBoundingClientRect(), tip.getBoundingClientRect()];
    const below = box.bottom + GAP + size.height < innerHeight;
    tip.style.left = `${Math.min(Math.max(box.left, GAP), innerWidth - size.width - GAP)}px`;
    tip.style.top = `${below ? box.bottom + GAP : box.top - GAP - size.height}px`;
  }

  /** Shows the explanation of the number around `target`, if there is one. */
  function show(pointed: Element) {
    if (tip.contains(pointed)) return;
    hide();
    target = pointed.closest<HTMLElement>("[data-tip]");
    if (!target) return;
    described = pointed.matches("input, select") ? pointed : target;
    described.setAttribute("aria-describedby", tip.id);
    tip.textContent = target.dataset.tip!;
    tip.hidden = false;
    put();
  }

  root.addEventListener("pointerover", ({ target }) => show(target as Element), { signal });
  root.addEventListener("pointerleave", hide, { signal });
  root.addEventListener("focusin", ({ target }) => (target as Element).matches(":focus-visible") && show(target as Element), { signal });
  for (const event of ["focusout", "pointerdown"]) root.addEventListener(event, hide, { signal });
  root.addEventListener("scroll", put, { signal, capture: true });
  root.addEventListener("keydown", ({ key }) => key === "Escape" && hide(), { signal });
  return tip;
}
