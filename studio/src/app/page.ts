/** The page: bar, panels, stage and comparison over one canvas. */

import { announceChanges, announcer } from "./announce.ts";
import { createBar } from "./bar.ts";
import { balls } from "./beads.ts";
import { createCompare } from "./compare.ts";
import type { Context } from "./context.ts";
import { element, segments, write } from "./dom.ts";
import type { Engine } from "../work/engine.ts";
import type { Eye } from "./eye.ts";
import { exportSheet, open } from "./exchange.ts";
import { haunt } from "./ghost.ts";
import { wavelength } from "../work/lattices.ts";
import { discsOf, lookOf, turnAt } from "./look.ts";
import { FOCAL } from "../painter/camera.ts";
import { createFlat } from "../painter/canvas2d.ts";
import { createPainter } from "../painter/painter.ts";
import type { Painter } from "../painter/picture.ts";
import { createPanels } from "./panels.ts";
import { createPlayer } from "./player.ts";
import { plain, report } from "./refusals.ts";
import { createSentence } from "./sentence.ts";
import type { ServedBoard } from "../boards/served.ts";
import { sheet } from "./sheet.ts";
import { createStage } from "./stage.ts";
import { shownOf, type Studio } from "../work/studio.ts";
import { createTips } from "./tips.ts";
import { isTouch, skinPlane } from "../work/touch.ts";
import { type Lattice, LEVELS, type Level, QUANTITIES, type Quantity, type Vec3 } from "../state/types.ts";
import type { Language } from "./words.ts";

/** The functions of a shown page. */
export interface Page {
  /** Returns where a place appears, in CSS px of the window. */
  project(place: Vec3): [number, number];
  alarm(text: string): void;
  dispose(): void;
}

/** The settings of a page. */
export interface Manner {
  language: Language;
  theme: "dark" | "light";
  eye: Eye;
  /** The board of `midair studio --on`. */
  board?: ServedBoard | null;
  /** Whether bar and panels are left out, for a notebook's cell. */
  compact?: boolean;
  /** Whether an animated hand shows once that points can be dragged. */
  greets?: boolean;
  /** Builds the page again, in another language or theme. */
  again(manner: Partial<Manner>): void;
}

const BACKGROUNDS: Record<Manner["theme"], [number, number, number]> = {
  dark: [12, 15, 20],
  light: [246, 248, 250],
};

/** Pixels per CSS px of the canvas while something moves, if software renders the canvas. */
const COARSE = 0.5;

/** Builds the page in an element. */
export function createPage(root: HTMLElement, engine: Engine, studio: Studio, manner: Manner): Page {
  const { language, theme } = manner;
  const status = element("div", { className: "hidden", role: "status", "aria-live": "polite" });
  const alert = element("div", { className: "alert", role: "alert" });
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let turn = 0;
  let frame = 0;
  /** Whether something other than the wave has changed since the last picture. */
  let fresh = true;
  let gone = false;
  const endings: (() => void)[] = [];
  const context: Context = {
    engine,
    studio,
    language,
    theme,
    board: manner.board ?? null,
    say: (word, put) => report(language, word, put),
    plain: (line) => plain(language, line),
    announce: announcer(status),
    listen: (listener) => void endings.push(studio.listen(listener)),
    ending: (act) => void endings.push(act),
    alarm(text) {
      const close = element("button", { className: "plain", "aria-label": context.say("close") }, "×");
      close.onclick = () => alert.replaceChildren();
      alert.replaceChildren(...(text ? [element("span", {}, text), close] : []));
    },
    repaint: () => {
      fresh = true;
      next();
    },
  };

  /** Requests a picture; while the wave runs, each picture requests the next. */
  const next = () => {
    frame ||= requestAnimationFrame((now) => {
      if (runs()) turn = turnAt(now);
      paint();
      if (runs()) next();
    });
  };

  const canvas = element("canvas", { className: "canvas", "aria-hidden": "true" });
  const stage = createStage(context, manner.eye);
  const compare = createCompare(context);
  /** Returns the rectangle of the 3-D view in the canvas, in px at this pixel ratio. */
  const within = (ratio: number) => {
    const [outer, inner] = [canvas, stage.view].map((each) => each.getBoundingClientRect());
    const [x, y, width, height] = [inner.left - outer.left, inner.top - outer.top, inner.width, inner.height].map((px) => Math.round(px * ratio));
    return new DOMRect(x, y, width, height);
  };
  const player = createPlayer(context, () => ({ canvas, box: within(paint()) }));
  stage.root.append(player.root);
  const panels = createPanels(context, compare, player, Boolean(manner.compact));
  const sentence = createSentence(context);
  const levels = segments(context.say("levelOfPage"), LEVELS.map((name) => [name, context.say(name)]), (level) =>
    studio.change({ level: level as Level }),
  );
  const bar = createBar(context, levels.root, {
    language: () => manner.again({ language: language === "en" ? "ja" : "en" }),
    theme: () => manner.again({ theme: theme === "dark" ? "light" : "dark" }),
    picture(ending) {
      // The canvas is painted with the resolution of the PNG.
      const ratio = paint(2);
      const drawn = sheet(context, look(), root, canvas, within(ratio));
      context.repaint();
      exportSheet(drawn, ending).catch(({ message }: Error) => context.alarm(context.say("failed", { line: message })));
    },
  });
  const quantities = segments(context.say("quantity"), QUANTITIES.map((name) => [name, context.say(name)]), (name) => {
    const { state } = studio.view;
    const quantity = name as Quantity;
    // A skin lies flat through the points.
    const lays = isTouch(quantity) && !isTouch(state.quantity);
    studio.change(lays ? { quantity, plane: skinPlane(state), view: "slice" } : { quantity });
  });
  quantities.root.classList.add("quantities");
  const bench = element("section", { className: "bench", "aria-label": context.say("slice") });
  const drawer = element("button", { className: "drawer icon", "aria-label": context.say("settings"), "aria-controls": "panels", "aria-expanded": "true" }, "⇥");
  const main = element("main", {}, stage.root, bench, quantities.root, sentence.root, drawer, panels.root);
  drawer.onclick = () => {
    const open = main.classList.toggle("shut");
    drawer.setAttribute("aria-expanded", String(!open));
    write(drawer, open ? "⇤" : "⇥");
  };
  const skip = element("a", { className: "skip", href: "#points" }, context.say("skip"));
  skip.onclick = (event) => {
    event.preventDefault();
    main.querySelector<HTMLElement>(studio.view.state.level === "compare" ? ".wiper" : ".point")?.focus();
  };
  const listening = new AbortController();
  const { signal } = listening;
  const tip = createTips(root, signal);
  root.classList.add("studio");
  root.classList.toggle("compact", Boolean(manner.compact));
  root.dataset.theme = theme;
  root.lang = language;
  root.replaceChildren(canvas, ...(manner.compact ? [] : [skip, bar.root]), main, alert, status, tip);

  let painter: Painter = begin();
  function begin(): Painter {
    const card = createPainter(canvas);
    if (!card) context.alarm(context.say("flat"));
    const made = card ?? createFlat(canvas);
    made.onRestored = context.repaint;
    return made;
  }

  /** Returns whether the wave is animated; it is not if the user prefers less motion. */
  const runs = () => !gone && !painter.lost && painter.runs && studio.view.state.quantity === "wave" && !calm.matches;
  const look = () => lookOf(studio.view, theme, turn);

  let [said, announced] = ["", ""];
  /** The results that the page shows. */
  let shown: unknown[] = [];
  function place() {
    const { state, results, moving } = studio.view;
    // While something moves and software renders, the page waits for both solutions. A picture with only the first solution
    // would be replaced soon, and cost time.
    if (moving && painter.slow && results.every((result, slot) => result === shown[slot])) return;
    shown = [...results];
    bar.place();
    const level = manner.compact ? "engineer" : state.level;
    root.dataset.level = level;
    const home = level === "compare" ? bench : panels.dock;
    if (compare.root.parentElement !== home) home.append(compare.root);
    panels.place();
    compare.place(look());
    sentence.place();
    levels.choose(level);
    quantities.choose(state.quantity);
    // Only points on a path move a skin.
    for (const button of quantities.root.children as Iterable<HTMLButtonElement>) button.hidden = isTouch(button.value as Quantity) && !state.path;
    const [a, b] = studio.view.results.map(({ answer }) => answer?.metrics.uniformity.toFixed(3) ?? "–");
    const [methodA, methodB] = state.methods;
    said = context.say("said", { a, b, methodA, methodB });
    // Points follow the pointer before the solution for them is there.
    const same = results.every(({ lattice }, slot) => lattice === painted[slot]);
    if (moving && same) stage.place();
    else context.repaint();
  }

  let painted: (Lattice | null)[] = [];
  /** Paints at this pixel ratio, or at the screen's; returns the ratio. */
  function paint(given?: number): number {
    frame = 0;
    if (gone || painter.lost) return 1;
    // The canvas ends below the lowest view: a long page on a phone would need more pixels than a canvas may have.
    const bottoms = [stage.view, compare.slice].map((view) => view.getBoundingClientRect().bottom);
    const { top } = canvas.getBoundingClientRect();
    canvas.style.height = `${Math.ceil(Math.max(...bottoms) - top)}px`;
    const outer = canvas.getBoundingClientRect();
    const box = (place: HTMLElement) => {
      const { left, top, width, height } = place.getBoundingClientRect();
      return { x: left - outer.left, y: top - outer.top, width, height };
    };
    const { view } = studio;
    const { state } = view;
    const shades = look();
    const results = shownOf(view);
    const slices = results.map(({ lattice }) => lattice);
    painted = view.results.map(({ lattice }) => lattice);
    const slot = view.frame && (view.frame.touch || !view.frame.results[state.slot]) ? 0 : state.slot;
    const lattice = slices[slot];
    const ratio = given ?? Math.min(devicePixelRatio, 2) * ((view.moving || runs()) && painter.slow ? COARSE : 1);
    painter.begin(outer.width, outer.height, ratio, BACKGROUNDS[theme]);
    const space = box(stage.view);
    if (space.width) painter.scene(space, {
      camera: stage.camera(),
      positions: view.positions,
      normals: view.normals,
      drive: results[slot].answer?.drive ?? null,
      discs: discsOf(state),
      slices: lattice && (state.view !== "volume" || !view.volume || view.frame) ? [lattice, ...results[slot].crossing].map((lattice, k) => ({ lattice, key: "AB"[slot] + (k || "") })) : [],
      wavelength: wavelength(state),
      // The glow of |p| would cover the wave or the phase.
      volume: ["slice", "planes"].includes(state.view) || view.frame || (state.view === "both" && state.quantity !== "modulus") ? null : view.volume,
      points: view.frame?.points ?? state.points,
      obstacles: [...state.obstacles, ...balls(view.frame?.beads ?? [], (place) => stage.seen(place)[2] / (FOCAL * space.height))],
      look: shades,
      theme,
      moving: view.moving,
    });
    const whole = box(compare.slice);
    const sheet = box(panels.root);
    slices.forEach((lattice, slot) => {
      if (!lattice || !whole.width) return;
      const shared = slices[1 - slot] ? compare.share() : 1 - slot;
      const [from, to] = slot ? [whole.x + shared * whole.width, whole.x + whole.width] : [whole.x, whole.x + shared * whole.width];
      // The part of the slice that is scrolled out of its panel is clipped.
      const docked = panels.root.contains(compare.slice);
      const [top, bottom] = [docked ? Math.max(whole.y, sheet.y) : whole.y, whole.y + whole.height];
      painter.slice(whole, lattice, "AB"[slot], shades, { x: from, y: top, width: to - from, height: bottom - top });
    });
    if (fresh) stage.place();
    fresh = false;
    return ratio;
  }

  function press(event: KeyboardEvent) {
    if (!(event.ctrlKey || event.metaKey) || !["z", "y", "Z"].includes(event.key)) return;
    if ((event.target as HTMLElement).matches?.("input[type=text], input[type=number]")) return;
    event.preventDefault();
    const back = event.key === "z" && !event.shiftKey;
    if (back ? studio.undo() : studio.redo()) context.announce(context.say(back ? "undone" : "redone"));
  }
  const dropped = (event: DragEvent) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void open(context, file);
  };
  announceChanges(context);
  context.listen(() => {
    place();
    if (said !== announced && !studio.view.moving) context.announce((announced = said));
    warn();
  });

  /** The last reported fault: a scene that neither method can solve is reported once. */
  let warned = "";
  function warn() {
    const [a, b] = studio.view.results.map(({ refused }) => refused);
    const refused = a && b && !studio.view.moving ? a : "";
    if (refused === warned) return;
    warned = refused;
    context.alarm(refused && context.say("unsolved", { line: plain(language, refused) }));
  }
  const size = new ResizeObserver(context.repaint);
  [canvas, stage.view, compare.slice].forEach((each) => size.observe(each));
  calm.addEventListener("change", context.repaint, { signal });
  window.addEventListener("scroll", context.repaint, { passive: true, capture: true, signal });
  (manner.compact ? root : window).addEventListener("keydown", press as EventListener, { signal });
  root.addEventListener("drop", dropped, { signal });
  root.addEventListener("dragover", (event) => event.preventDefault(), { signal });
  place();
  if (manner.greets && !calm.matches) void haunt(context, stage.view, stage.seen);
  manner.greets = false;

  return {
    project: stage.project,
    alarm: context.alarm,
    dispose() {
      gone = true;
      endings.forEach((act) => act());
      cancelAnimationFrame(frame);
      size.disconnect();
      listening.abort();
      painter.dispose();
    },
  };
}
