/** Player: animates points on a path frame by frame, A by the solver `glide`, B by its own method; plays, seeks, records. */

import { pressure } from "./numbers.ts";
import { fateOf } from "../solving/beads.ts";
import { isTouch, limitsOf, touchOf } from "../solving/touch.ts";
import { countOf, requestOf, SLOWEST, Turn } from "../solving/turn.ts";
import { createChart } from "./chart.ts";
import { type Context, millimetres } from "./context.ts";
import { element, explained, icon, write } from "./dom.ts";
import { type Film, FILMS, type Part, record } from "./recording.ts";
import { type Notice, noticeOf } from "../state/notice.ts";

/** Changes of phases below this, in rad, count as none. */
const STILL = 1e-6;

/** Time in ms without a change, after which the touch of a skin is predicted. */
const REST = 200;

/**
 * Rest: the scene as it is. Following: one frame of the path; `aside`: only because the touch of a skin was requested. Playing:
 * frame after frame. Each begins as a new object, so work that began before sees that it is late. `request` is the state at the
 * beginning.
 */
type Phase = { name: "rest" } | { name: "following"; request: string; aside: boolean } | { name: "playing"; request: string };

/** The player and its time line. */
export class Player {
  /** The time line, which is hidden if there is no path. */
  readonly root: HTMLElement;
  /** The summary of all frames, as text and as curves. */
  readonly summary = element("div");
  private readonly go: HTMLButtonElement;
  private readonly line: HTMLInputElement;
  private readonly time = element("output");
  private readonly films: HTMLButtonElement[];
  private phase: Phase = { name: "rest" };
  private turn: Turn | null = null;
  private chart: ReturnType<typeof createChart> | null = null;
  /** The shown frame, and the number of turns since the animation began. */
  private at = 0;
  private lap = 0;
  /** The touch that was last predicted without a request to play. */
  private touched = "";
  private timer = 0;
  /** The request whose points began to move by themselves. */
  private begun = "";

  /** `canvas` returns the part of the canvas that is recorded. */
  constructor(
    private readonly context: Context,
    private readonly canvas: () => Part,
  ) {
    const { say } = context;
    this.go = element("button", { className: "icon", onclick: () => (this.phase.name === "playing" ? this.pause() : void this.play(this.at)) });
    this.line = element("input", { type: "range", min: 0, max: 1, value: 0, "aria-label": say("frameShown"), "data-tip": say("frameTip"), oninput: () => void this.seek(+this.line.value) });
    this.films = FILMS.map((film) => {
      const name = say("recordHint", { film });
      return element("button", { title: name, "aria-label": name, onclick: () => void this.save(film) }, film);
    });
    const label = explained(element("label", {}, this.line, explained(this.time, say("frameTip"))), say("frameTip"));
    this.root = element("div", { className: "timeline", hidden: true, role: "group", "aria-label": say("motion") }, this.go, label, ...this.films);
    context.ending(() => {
      this.rest();
      clearTimeout(this.timer);
    });
  }

  get moves(): boolean {
    return this.phase.name !== "rest";
  }

  /** Starts to play, or stops and shows the scene at rest. */
  readonly toggle = () => (this.moves ? this.rest() : void this.play(0));

  update(): void {
    const { state, frame } = this.context.studio.view;
    const { say } = this.context;
    // If the state has changed, the old path stops.
    if (this.phase.name !== "rest" && this.phase.request !== requestOf(state)) this.phase = { name: "rest" };
    this.touch();
    this.begins();
    this.root.hidden = state.path === null;
    this.summary.hidden = this.turn?.request !== requestOf(state);
    if (!state.path) return;
    if (frame === null && !this.moves) this.at = 0;
    const plays = this.phase.name === "playing";
    const name = say(plays ? "pause" : "playPath");
    if (this.go.ariaLabel !== name) {
      this.go.ariaLabel = name;
      this.go.innerHTML = icon(plays ? "M8 5V19M16 5V19" : "M7 4L19 12L7 20Z");
    }
    const count = countOf(state.path);
    this.line.max = String(count - 1);
    this.line.value = String(this.at);
    const duration = 1000 / state.path.frequency;
    write(this.time, `${((duration * this.at) / count).toFixed(0)} / ${duration.toFixed(0)} ms`);
  }

  /** At the level "play", points on a path move by themselves, once, unless the user prefers less motion. */
  private begins(): void {
    const { state, moving } = this.context.studio.view;
    if (state.level !== "play" || !state.path || moving || this.moves || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const key = `${isTouch(state.quantity)} ${requestOf(state)}`;
    if (isTouch(state.quantity) || this.begun === key) return void (this.begun = key);
    this.begun = key;
    queueMicrotask(() => void this.play(this.at));
  }

  /** Begins a phase; returns a function that tells whether another one has begun. */
  private begin(phase: Phase): () => boolean {
    this.phase = phase;
    return () => this.phase !== phase;
  }

  private rest(): void {
    const moved = this.moves;
    this.begin({ name: "rest" });
    this.touched = "";
    if (moved) this.context.studio.show(null);
    this.update();
  }

  private pause(): void {
    this.begin({ name: "following", request: requestOf(this.context.studio.view.state), aside: false });
    this.update();
  }

  private async play(from: number): Promise<void> {
    const { state } = this.context.studio.view;
    if (!state.path) return;
    if (!this.moves) this.lap = 0;
    const late = this.begin({ name: "playing", request: requestOf(state) });
    this.update();
    await this.attempt(late, async () => {
      const turn = await this.solved();
      for (let t = from % turn.count; !late(); t = (t + turn.stride) % turn.count) {
        if (!(await this.show(turn, t, late))) break;
        if (t + turn.stride >= turn.count) this.lap += 1;
        await new Promise(requestAnimationFrame);
      }
    });
    if (!late()) this.rest();
  }

  /** Pauses at a frame; `touches`: only the touch of a skin was requested. */
  private async seek(t: number, touches = false): Promise<void> {
    const aside = touches && (this.phase.name === "rest" || (this.phase.name === "following" && this.phase.aside));
    const late = this.begin({ name: "following", request: requestOf(this.context.studio.view.state), aside });
    this.at = t;
    await this.attempt(late, async () => {
      const turn = await this.solved();
      await this.show(turn, Math.min(t, turn.count - 1), late);
    });
  }

  /** Saves one turn, frame by frame, as a film. */
  private async save(kind: Film): Promise<void> {
    const late = this.begin({ name: "playing", request: requestOf(this.context.studio.view.state) });
    this.lap = 0;
    this.update();
    this.films.forEach((each) => (each.disabled = true));
    await this.attempt(late, async () => {
      const turn = await this.solved();
      await record(kind, this.canvas, async (shoot) => {
        for (let t = 0; !late() && t < turn.count; t += turn.stride) {
          if (!(await this.show(turn, t, late))) break;
          await new Promise(requestAnimationFrame);
          shoot();
        }
      });
    });
    this.films.forEach((each) => (each.disabled = false));
    if (!late()) this.pause();
  }

  /** Runs `act`. If it fails, reports why frames cannot be shown, and shows no skin. */
  private async attempt(late: () => boolean, act: () => Promise<void>): Promise<void> {
    try {
      await act();
    } catch (error) {
      if (!late()) this.fail(noticeOf(error));
    }
  }

  private fail(line: Notice): void {
    const { studio, say, alarm } = this.context;
    alarm(say("failed", { line }));
    if (isTouch(studio.view.state.quantity)) studio.change({ quantity: "modulus" });
  }

  /** Returns the solved turn of the state; solves it unless that was done. */
  private async solved(): Promise<Turn> {
    const { studio, engine } = this.context;
    const { state } = studio.view;
    if (this.turn?.request === requestOf(state)) return this.turn;
    this.turn = null;
    const turn = await Turn.solve(engine, state);
    this.at = 0;
    this.turn = turn;
    this.summarize(turn);
    return turn;
  }

  /** Shows the changes and the weakest points of all frames as text and curves, and the beads of traps. */
  private summarize(turn: Turn): void {
    const { say, announce } = this.context;
    const { changes, frames } = turn;
    const weakest = frames.map(({ least }) => least);
    const change = Math.max(...changes).toFixed(2);
    const dip = ((100 * Math.min(...weakest)) / Math.max(...frames.map(({ most }) => most))).toFixed(0);
    const summary = Math.max(...changes) < STILL ? say("stands") : say("moved", { change, dip });
    const curves = [
      { name: say("changes"), values: changes, most: `${change} rad` },
      { name: say("weakest"), values: weakest, most: pressure(Math.max(...weakest)) },
    ];
    this.chart = createChart(curves, (1000 * turn.count) / turn.rate, `${say("motion")}: ${summary}`);
    const fate = element("div");
    this.summary.replaceChildren(element("p", { className: "summary" }, summary), this.chart.root, fate);
    announce(summary);
    if (turn.state.signature) void this.fly(turn, fate);
  }

  /** Simulates a bead in each trap, one after another, as long as the state stays the same. */
  private async fly(turn: Turn, fate: HTMLElement): Promise<void> {
    const { say, announce, studio } = this.context;
    const { bead } = turn.state;
    const tip = bead ? say("ownBeadTip", { across: 2 * Number(millimetres(bead.radius)), density: bead.density }) : say("beadsTip");
    const tell = (lines: string[]) => fate.replaceChildren(...lines.map((line) => explained(element("p", { className: "summary" }, line), tip)));
    const late = () => this.turn !== turn || requestOf(studio.view.state) !== turn.request;
    if (turn.state.path!.frequency < SLOWEST) return tell([say("beadsSlow", { turns: SLOWEST })]);
    try {
      for (const [n, point] of turn.traps.entries()) {
        tell([say("flying", { n: n + 1, count: turn.traps.length })]);
        if (!(await turn.fly(point, late))) return;
      }
      const lines = fateOf(turn.flights, say);
      tell(lines);
      announce(lines.join(". "));
    } catch (error) {
      tell([say("failed", { line: noticeOf(error) })]);
    }
  }

  /** Shows a frame of both methods; returns false if the state has changed meanwhile. */
  private async show(turn: Turn, t: number, late: () => boolean): Promise<boolean> {
    const { studio, say } = this.context;
    const { state, positions } = studio.view;
    const quantity = touchOf(state);
    const transducers = positions.length / 3;
    if (quantity) this.check(turn, transducers);
    const stopped = () => late() || requestOf(studio.view.state) !== turn.request;
    const shown = await turn.show(t, this.lap, quantity, transducers, stopped);
    if (!shown) return false;
    this.at = t;
    this.chart?.mark(t / (turn.count - 1));
    const [, b] = shown.results;
    studio.show({ ...shown, names: [shown.names[0], b ? "" : say("atRest")] });
    this.update();
    return true;
  }

  /** Throws if the touch of a skin would take too long, or if its slice is too wide. */
  private check({ state }: Turn, transducers: number): void {
    const { say } = this.context;
    const { size } = limitsOf(transducers);
    if (state.path!.frequency < SLOWEST) throw new Error(say("skinSlow", { turns: SLOWEST }));
    if (state.plane.size > size) throw new Error(say("skinWide", { size: Math.floor(1000 * size) }));
  }

  /** Makes the shown frame have the touch of the state, a moment after the last change, and no frame after a touch. */
  private touch(): void {
    const { studio, say } = this.context;
    const { state, moving, frame } = studio.view;
    const quantity = touchOf(state);
    clearTimeout(this.timer);
    if (isTouch(state.quantity) && !state.path) {
      // `fail` changes the state, which updates the page again. So it waits until the page shows this state.
      return queueMicrotask(() => {
        const now = studio.view.state;
        if (isTouch(now.quantity) && !now.path) this.fail(noticeOf(say("skinNeedsPath")));
      });
    }
    if (this.phase.name === "playing" || moving || (frame?.touch?.quantity ?? null) === quantity) return;
    if (!quantity && this.phase.name === "following" && this.phase.aside) return this.rest();
    const request = `${quantity} ${requestOf(state)}`;
    if (this.touched === request) return;
    const seek = () => {
      this.touched = request;
      void this.seek(this.at, true);
    };
    this.timer = window.setTimeout(seek, quantity ? REST : 0);
  }
}
