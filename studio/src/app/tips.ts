/** Tips: one line of explanation for a number, beside the pointer or the focus. */

import { element } from "./dom.ts";

/** The distance of a tip from its number and from the window's edge, in px. */
const GAP = 6;

/** Makes the tip of a page: one element that explains any element with `data-tip` in `root`, until `signal` aborts. */
export function createTips(root: HTMLElement, signal: AbortSignal): HTMLElement {
  const tip = element("div", { className: "tip", id: "tip", role: "tooltip", hidden: true });
  let place: HTMLElement | null = null;
  let described: Element | null = null;

  function hide() {
    tip.hidden = true;
    described?.removeAttribute("aria-describedby");
    place = described = null;
  }

  /** Places the tip below its number, or above if there is no space below. */
  function put() {
    if (!place) return;
    const [box, own] = [place.getBoundingClientRect(), tip.getBoundingClientRect()];
    const below = box.bottom + GAP + own.height < innerHeight;
    tip.style.left = `${Math.min(Math.max(box.left, GAP), innerWidth - own.width - GAP)}px`;
    tip.style.top = `${below ? box.bottom + GAP : box.top - GAP - own.height}px`;
  }

  /** Shows the explanation of the number around `target`, if there is one. */
  function show(target: Element) {
    if (tip.contains(target)) return;
    hide();
    place = target.closest<HTMLElement>("[data-tip]");
    if (!place) return;
    described = target.matches("input, select") ? target : place;
    described.setAttribute("aria-describedby", tip.id);
    tip.textContent = place.dataset.tip!;
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
