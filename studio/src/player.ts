/** Player: animates points on a path frame by frame, A by the solver `glide`, B by its own method; plays, seeks, records. */

import { createChart } from "./chart.ts";
import type { Context } from "./context.ts";
import { element, explained, write } from "./dom.ts";
import type { Frame } from "./door.ts";
import { gridOf } from "./lattices.ts";
import { pressure } from "./numbers.ts";
import { framesOf } from "./paths.ts";
import { planesOf } from "./plane.ts";
import { type Film, FILMS, type Part, record } from "./recording.ts";
import { sceneOf } from "./scene_file.ts";
import { resultOf } from "./studio.ts";
import type { Path, State, Vec3 } from "./types.ts";

/** Computed frames per second, if a turn then has between FEWEST and MOST frames. */
const RATE = 1000;

/** The fewest and the most frames of a turn. */
const FEWEST = 20;
const MOST = 1000;

/** Number of frames from one picture to the next, so that a turn takes some seconds. */
const STRIDE = 4;

/** Samples along a side of a slice that moves. */
const COARSE = 80;

/** Time in ms for a frame of B, above which B is shown at rest. */
const PATIENCE = 300;

/** Changes of phases below this, in rad, count as none. */
const STILL = 1e-6;

/** Returns the number of frames of a turn. */
const countOf = (path: Path) => Math.max(FEWEST, Math.min(MOST, Math.round(RATE / path.frequency)));

/**
 * A solved path: the request (a state as JSON) and the state, the points (T, M, 3) of all frames, the frames' metrics and their
 * chart.
 */
interface Followed {
  requested: string;
  state: State;
  places: Float64Array;
  frames: Frame[];
  chart: ReturnType<typeof createChart>;
}

/** The player and its time line. */
export interface Player {
  /** The time line, which is hidden if there is no path. */
  root: HTMLElement;
  /** The summary of all frames, as text and as curves. */
  found: HTMLElement;
  playing(): boolean;
  /** Starts to play, or stops and shows the scene at rest. */
  toggle(): void;
  place(): void;
}

/** Makes a player; `canvas` returns the part of the canvas that is recorded. */
export function createPlayer(context: Context, canvas: () => Part): Player {
  const { studio, engine, say } = context;
  const state = () => studio.view.state;
  const found = element("div");
  const go = element("button", { className: "icon", onclick: () => (mode === "play" ? pause() : void run(at)) }, "▶");
  const line = element("input", { type: "range", min: 0, max: 1, value: 0, "aria-label": say("frameShown"), "data-tip": say("frameTip"), oninput: () => void seek(+line.value) });
  const time = explained(element("output"), say("frameTip"));
  const films = FILMS.map((film) => {
    const name = say("recordHint", { film });
    return element("button", { title: name, "aria-label": name, onclick: () => void save(film) }, film);
  });
  const root = element("div", { className: "timeline", hidden: true, role: "group", "aria-label": say("motion") }, go, explained(element("label", {}, line, time), say("frameTip")), ...films);
  let mode: "rest" | "pause" | "play" = "rest";
  let followed: Followed | null = null;
  let at = 0;
  /** The number of the newest run; older runs end. */
  let run_ = 0;
  let slowB = false;
  /** The state that plays, as JSON. */
  let begun = "";
  context.ending(halt);

  const requested = () => JSON.stringify({ ...state(), quantity: 0, scale: 0, slot: 0 });

  function halt() {
    run_ += 1;
    if (mode !== "rest") studio.show(null);
    mode = "rest";
    place();
  }

  function pause() {
    run_ += 1;
    mode = "pause";
    place();
  }

  /** Solves all frames of the path, unless that was done for this state. */
  async function follow(): Promise<Followed> {
    if (followed?.requested === requested()) return followed;
    const now = state();
    const path = now.path!;
    const count = countOf(path);
    const rate = count * path.frequency;
    const places = framesOf(now.points, path, rate, count / rate);
    const frames = await engine.slow.follow(JSON.stringify({ ...sceneOf(now, 0), solver: { name: "glide", rate } }), places, count);
    const { summary, chart } = curvesOf(frames, count / rate);
    found.replaceChildren(element("p", { className: "summary" }, summary), chart.root);
    context.announce(summary);
    [slowB, at] = [false, 0];
    return (followed = { requested: requested(), state: now, places, frames, chart });
  }

  /** Shows a frame of both methods; returns false if the state has changed meanwhile. */
  async function show({ state: now, places, frames, chart, requested: theirs }: Followed, t: number, still: () => boolean): Promise<boolean> {
    const count = now.points.length;
    const points = now.points.map((_, j) => [...places.subarray(3 * (t * count + j), 3 * (t * count + j) + 3)] as Vec3);
    const there = { ...now, points };
    const grids = planesOf(now).map((plane) => gridOf(now, COARSE, plane));
    const before = performance.now();
    const [a, b] = await Promise.all([
      engine.slow.frame(t, JSON.stringify(sceneOf(there, 0)), grids, now.ear),
      slowB ? null : engine.slots[1].update(JSON.stringify(sceneOf(there, 1)), grids, now.ear, true).then((b) => ((slowB = performance.now() - before > PATIENCE), b)),
    ]);
    if (!still() || requested() !== theirs) return false;
    at = t;
    chart.mark(t / (frames.length - 1));
    studio.show({ points, results: [resultOf(a), b && resultOf(b)], names: ["glide", b ? "" : say("atRest")], change: frames[t].change });
    place();
    return true;
  }

  async function run(from: number) {
    if (!state().path) return;
    const mine = ++run_;
    const still = () => run_ === mine;
    [mode, begun] = ["play", requested()];
    place();
    try {
      const all = await follow();
      for (let t = from % all.frames.length; still(); t = (t + STRIDE) % all.frames.length) {
        if (!(await show(all, t, still))) break;
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
    if (still()) halt();
  }

  /** Pauses at a frame. */
  async function seek(t: number) {
    const mine = ++run_;
    [mode, begun] = ["pause", requested()];
    at = t;
    try {
      const all = await follow();
      await show(all, Math.min(t, all.frames.length - 1), () => run_ === mine);
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
  }

  /** Saves one turn, frame by frame, as a film. */
  async function save(kind: Film) {
    const mine = ++run_;
    [mode, begun] = ["play", requested()];
    place();
    films.forEach((each) => (each.disabled = true));
    try {
      const all = await follow();
      await record(kind, canvas, async (shoot) => {
        for (let t = 0; run_ === mine && t < all.frames.length; t += STRIDE) {
          if (!(await show(all, t, () => run_ === mine))) break;
          await new Promise(requestAnimationFrame);
          shoot();
        }
      });
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
    films.forEach((each) => (each.disabled = false));
    if (run_ === mine) pause();
  }

  function curvesOf(frames: Frame[], seconds: number) {
    // The first frame has no change of its own, because no frame is before it.
    const changes = frames.map(({ change }, t) => (t ? change : frames[1].change));
    const weakest = frames.map(({ least }) => least);
    const change = Math.max(...changes).toFixed(2);
    const dip = ((100 * Math.min(...weakest)) / Math.max(...frames.map(({ most }) => most))).toFixed(0);
    const summary = Math.max(...changes) < STILL ? say("stands") : say("moved", { change, dip });
    const curves = [
      { name: say("changes"), values: changes, most: `${change} rad` },
      { name: say("weakest"), values: weakest, most: pressure(Math.max(...weakest)) },
    ];
    return { summary, chart: createChart(curves, 1000 * seconds, `${say("motion")}: ${summary}`) };
  }

  function place() {
    const now = state();
    const known = followed?.requested === requested() ? followed : null;
    // If the state has changed, the old path stops.
    if (mode !== "rest" && begun !== requested()) [mode, run_] = ["rest", run_ + 1];
    root.hidden = now.path === null;
    found.hidden = !known;
    if (!now.path) return;
    const count = countOf(now.path);
    if (studio.view.frame === null && mode === "rest") at = 0;
    write(go, mode === "play" ? "⏸" : "▶");
    const name = say(mode === "play" ? "pause" : "playPath");
    if (go.ariaLabel !== name) go.ariaLabel = go.title = name;
    line.max = String(count - 1);
    line.value = String(at);
    const turn = 1000 / now.path.frequency;
    write(time, `${((turn * at) / count).toFixed(0)} / ${turn.toFixed(0)} ms`);
  }

  return { root, found, playing: () => mode !== "rest", toggle: () => (mode === "rest" ? void run(0) : halt()), place };
}
