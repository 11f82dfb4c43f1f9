/** The page: bar, panels, stage and comparison over one canvas. */

import type { ServedBoard } from "../boards/served.ts";
import { LEVELS, type Level, QUANTITIES, type Quantity, type Theme } from "../state/types.ts";
import type { Engine } from "../solving/engine.ts";
import type { Result, Studio } from "../solving/studio.ts";
import { isTouch, skinPlane } from "../solving/touch.ts";
import { announceChanges } from "./announce.ts";
import { createBar } from "./bar.ts";
import { createCompare } from "./compare.ts";
import { Context } from "./context.ts";
import { element, explained, segments, write } from "./dom.ts";
import { exportFigure, open } from "./exchange.ts";
import type { Eye } from "./eye.ts";
import { figure } from "./figure.ts";
import { haunt } from "./ghost.ts";
import { Painting } from "./painting.ts";
import { Panels } from "./panels.ts";
import { Player } from "./player.ts";
import { createSentence } from "./sentence.ts";
import { Stage } from "./stage.ts";
import { createTips } from "./tips.ts";
import type { Language } from "./words.ts";
import { noticeOf } from "../state/notice.ts";

/** The settings of a page. */
export interface Manner {
  language: Language;
  theme: Theme;
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

/** A shown page. */
export class Page {
  private readonly listening = new AbortController();
  private readonly context: Context;
  private readonly stage: Stage;
  private readonly compare;
  private readonly panels: Panels;
  private readonly painting: Painting;
  private readonly sentence;
  private readonly levels;
  private readonly quantities;
  private readonly bar: ReturnType<Page["makeBar"]>;
  /** The place of the comparison at the level "compare". */
  private readonly bench: HTMLElement;
  /** The results that the page shows. */
  private shown: Result[] = [];
  /** The last announced metrics, and the last reported fault: a scene that neither method can solve is reported once. */
  private announced = "";
  private warned = "";
  /** The quantity before the comparison. */
  private before: Quantity | null = null;

  /** Builds the page in an element. */
  constructor(
    private readonly root: HTMLElement,
    engine: Engine,
    private readonly studio: Studio,
    private readonly manner: Manner,
  ) {
    const { language, theme, board = null } = manner;
    const context = (this.context = new Context(engine, studio, language, theme, board, () => this.painting.repaint()));
    const { say } = context;
    this.stage = new Stage(context, manner.eye);
    manner.eye.repaint = context.repaint;
    this.compare = createCompare(context);
    const player = new Player(context, () => this.painting.paint());
    this.stage.root.append(player.root);
    this.panels = new Panels(context, this.compare, player, Boolean(manner.compact));
    this.painting = new Painting(context, { stage: this.stage, compare: this.compare, panels: this.panels.root });
    this.sentence = createSentence(context);
    this.levels = segments(say("levelOfPage"), LEVELS.map((name) => [name, say(name)]), (level) => this.go(level as Level));
    this.quantities = segments(say("quantity"), QUANTITIES.map((name) => [name, say(name)]), (name) => this.choose(name as Quantity));
    this.quantities.root.classList.add("quantities");
    for (const button of this.quantities.root.children as Iterable<HTMLButtonElement>) explained(button, say(`${button.value as Quantity}Tip`));
    this.bar = this.makeBar();
    this.bench = element("section", { className: "bench", "aria-label": say("slice") });
    this.assemble();
    this.listen();
    this.update();
    if (manner.greets && !matchMedia("(prefers-reduced-motion: reduce)").matches) void haunt(context, this.stage);
    manner.greets = false;
  }

  /** Returns where a place appears, in CSS px of the window. */
  get project() {
    return this.stage.project;
  }

  /** Shows one line about a fault. */
  get alarm() {
    return this.context.alarm;
  }

  dispose(): void {
    this.context.end();
    this.listening.abort();
  }

  private makeBar() {
    const { context, manner } = this;
    return createBar(context, this.levels.root, {
      language: () => manner.again({ language: manner.language === "en" ? "ja" : "en" }),
      theme: () => manner.again({ theme: manner.theme === "dark" ? "light" : "dark" }),
      picture: (ending, plain) => {
        // The canvas is painted with the resolution of the PNG.
        const drawn = figure(context, this.painting.look, this.root, this.painting.paint(2), plain);
        context.repaint();
        exportFigure(drawn, ending).catch((error) => context.alarm(context.say("failed", { line: noticeOf(error) })));
      },
    });
  }

  /** Puts the parts into the page. */
  private assemble(): void {
    const { root, context, stage, panels, manner } = this;
    const { say } = context;
    const drawer = element("button", { className: "drawer icon", "aria-label": say("settings"), "aria-controls": "panels", "aria-expanded": "true" }, "⇥");
    const main = element("main", {}, stage.root, this.bench, this.quantities.root, this.sentence.root, drawer, panels.root);
    drawer.onclick = () => {
      const open = main.classList.toggle("shut");
      drawer.setAttribute("aria-expanded", String(!open));
      write(drawer, open ? "⇤" : "⇥");
    };
    const skip = element("a", { className: "skip", href: "#points" }, say("skip"));
    skip.onclick = (event) => {
      event.preventDefault();
      main.querySelector<HTMLElement>(this.studio.view.state.level === "compare" ? ".wiper" : ".point")?.focus();
    };
    const tip = createTips(root, this.listening.signal);
    root.classList.add("studio");
    root.classList.toggle("compact", Boolean(manner.compact));
    root.dataset.theme = manner.theme;
    (manner.compact ? root : document.documentElement).lang = manner.language;
    root.replaceChildren(this.painting.canvas, ...(manner.compact ? [] : [skip, this.bar.root]), main, context.alert, context.status, tip);
  }

  private listen(): void {
    const { root, context, manner } = this;
    const { signal } = this.listening;
    announceChanges(context);
    context.listen(() => {
      this.update();
      this.announce();
      this.warn();
    });
    window.addEventListener("scroll", context.repaint, { passive: true, capture: true, signal });
    (manner.compact ? root : window).addEventListener("keydown", (event) => this.press(event as KeyboardEvent), { signal });
    root.addEventListener("dragover", (event) => event.preventDefault(), { signal });
    root.addEventListener("drop", (event) => this.drop(event), { signal });
  }

  private update(): void {
    const { state, results, moving } = this.studio.view;
    // While something moves and software renders, the page waits for both solutions. A picture with only the first solution
    // would be replaced soon, and cost time.
    if (moving && this.painting.slow && results.every((result, slot) => result === this.shown[slot])) return;
    this.shown = [...results];
    this.bar.update();
    const level = this.manner.compact ? "engineer" : state.level;
    this.root.dataset.level = level;
    const home = level === "compare" ? this.bench : this.panels.dock;
    if (this.compare.root.parentElement !== home) home.append(this.compare.root);
    this.panels.update();
    this.compare.update(this.painting.look);
    this.sentence.update();
    this.levels.choose(level);
    this.quantities.choose(state.quantity);
    // Only points on a path move a skin.
    for (const button of this.quantities.root.children as Iterable<HTMLButtonElement>) button.hidden = isTouch(button.value as Quantity) && !state.path;
    // Points follow the pointer before the solution for them is there.
    if (moving && !this.painting.late) this.stage.update();
    else this.context.repaint();
  }

  /** Announces the evenness of both methods. */
  private announce(): void {
    const { results, state, moving } = this.studio.view;
    const [a, b] = results.map(({ answer }) => answer?.metrics.uniformity.toFixed(3) ?? "–");
    const [methodA, methodB] = state.methods;
    const text = this.context.say("said", { a, b, methodA, methodB });
    if (text !== this.announced && !moving) this.context.announce((this.announced = text));
  }

  private warn(): void {
    const { results, moving } = this.studio.view;
    const [a, b] = results.map(({ refused }) => refused);
    const warning = a && b && !moving ? this.context.say("unsolved", { line: this.context.plain(a) }) : "";
    if (warning === this.warned) return;
    this.warned = warning;
    this.context.alarm(warning);
  }

  /** Changes the level; methods are compared by |p|, and after the comparison the quantity is as before. */
  private go(level: Level): void {
    const { state } = this.studio.view;
    if (level === state.level) return;
    const shown = level === "compare" && !isTouch(state.quantity) ? "modulus" : state.level === "compare" && state.quantity === "modulus" ? this.before : null;
    this.before = level === "compare" ? state.quantity : null;
    this.studio.change({ level, ...(shown && { quantity: shown }) });
  }

  private choose(quantity: Quantity): void {
    const { state } = this.studio.view;
    // A skin lies flat through the points.
    const lays = isTouch(quantity) && !isTouch(state.quantity);
    this.studio.change(lays ? { quantity, plane: skinPlane(state), view: "slice" } : { quantity });
  }

  private press(event: KeyboardEvent): void {
    if (event.key === "Escape") this.context.alarm("");
    if (!(event.ctrlKey || event.metaKey) || !["z", "y", "Z"].includes(event.key)) return;
    if ((event.target as HTMLElement).matches?.("input[type=text], input[type=number]")) return;
    event.preventDefault();
    const back = event.key === "z" && !event.shiftKey;
    if (back ? this.studio.undo() : this.studio.redo()) this.context.announce(this.context.say(back ? "undone" : "redone"));
  }

  private drop(event: DragEvent): void {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void open(this.context, file);
  }
}
