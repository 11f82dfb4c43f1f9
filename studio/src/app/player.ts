/** Player: animates points on a path frame by frame, A by the solver `glide`, B by its own method; plays, seeks, records. */

import { type BeadFlight, beadsAt, fateOf } from "./beads.ts";
import { createChart } from "./chart.ts";
import type { Context } from "./context.ts";
import { element, explained, write } from "./dom.ts";
import type { Frame } from "../work/door.ts";
import { gridOf } from "../work/lattices.ts";
import { pressure } from "./numbers.ts";
import { framesOf, lengthOf } from "../making/paths.ts";
import { planesOf } from "../state/plane.ts";
import { type Film, FILMS, type Part, record } from "./recording.ts";
import { sceneOf } from "../state/scene_file.ts";
import { isTrap } from "../state/signature.ts";
import { limitsOf, predict, type Skin } from "../work/skin.ts";
import { resultOf, type Shown } from "../work/studio.ts";
import { isTouch, touchOf } from "../work/touch.ts";
import type { Path, State, Vec3 } from "../state/types.ts";

/** Computed frames per second, if a turn then has between FEWEST and MOST frames. */
const RATE = 1000;

/** The most, in m, that a point moves from frame to frame, unless a turn then has more than MOST frames: glide can follow this. */
const STEP = 0.35e-3;

/** The fewest and the most frames of a turn. */
const FEWEST = 80;
const MOST = 1000;

/** The most frames from one picture to the next, and the fewest pictures of a turn, which takes some seconds. */
const STRIDE = 4;
const PICTURES = 40;

/** Samples along a side of a slice that moves. */
const COARSE = 80;

/** Time in ms for a frame of B, above which B is shown at rest. */
const PATIENCE = 300;

/** Changes of phases below this, in rad, count as none. */
const STILL = 1e-6;

/** Time in ms without a change, after which the touch of a skin is predicted. */
const REST = 200;

/** The fewest turns a second whose skin is predicted, and whose beads are simulated: slower turns take too long. */
const SLOWEST = 2;

/** Returns the number of frames from one picture to the next. */
const strideOf = (count: number) => Math.max(1, Math.min(STRIDE, Math.floor(count / PICTURES)));

/** Returns the number of frames of a turn. */
function countOf(path: Path): number {
  const fine = 4 * Math.ceil(lengthOf(path) / STEP / 4);
  return Math.max(FEWEST, Math.min(MOST, Math.max(fine, Math.round(RATE / path.frequency))));
}

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
  /** The touch of a skin, once it is predicted. */
  skin: Skin | null;
  /** Frames per second, and the simulated motion of the beads so far. */
  rate: number;
  flights: BeadFlight[];
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
  /** The number of laps since the animation began. */
  let lap = 0;
  /** The number of the newest run; older runs end. */
  let run_ = 0;
  let slowB = false;
  /** The state that plays, as JSON. */
  let begun = "";
  /** The touch that was last predicted without a request to play, and whether the shown frame is there only for it. */
  let touched = "";
  let aside = false;
  let soon = 0;
  context.ending(halt);
  context.ending(() => clearTimeout(soon));

  const requested = () => JSON.stringify({ ...state(), quantity: 0, scale: 0, slot: 0 });

  function halt() {
    run_ += 1;
    if (mode !== "rest") studio.show(null);
    [mode, touched, aside] = ["rest", "", false];
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
    followed = null;
    const now = state();
    const path = now.path!;
    const count = countOf(path);
    const rate = count * path.frequency;
    const places = framesOf(now.points, path, rate, count / rate);
    const frames = await engine.slow.follow(JSON.stringify({ ...sceneOf(now, 0), solver: { name: "glide", rate } }), places, count);
    const { summary, chart } = curvesOf(frames, count / rate);
    const fate = element("div");
    found.replaceChildren(element("p", { className: "summary" }, summary), chart.root, fate);
    context.announce(summary);
    [slowB, at] = [false, 0];
    followed = { requested: requested(), state: now, places, frames, chart, rate, flights: [], skin: null };
    if (now.signature) void fly(followed, fate);
    return followed;
  }

  /** Simulates a bead in each trap, one after another, as long as the state stays the same. */
  async function fly(path: Followed, fate: HTMLElement) {
    const tell = (lines: string[]) => fate.replaceChildren(...lines.map((line) => explained(element("p", { className: "summary" }, line), say("beadsTip"))));
    const { points, signature } = path.state;
    if (path.state.path!.frequency < SLOWEST) return tell([say("beadsSlow", { turns: SLOWEST })]);
    const traps = [...points.keys()].filter((point) => isTrap(signature, point));
    try {
      for (const [n, point] of traps.entries()) {
        tell([say("flying", { n: n + 1, count: traps.length })]);
        const flight = { point, ...(await engine.slow.fly(point, path.rate)) };
        if (followed !== path || requested() !== path.requested) return;
        path.flights.push(flight);
      }
      const lines = fateOf(path.flights, say);
      tell(lines);
      context.announce(lines.join(". "));
    } catch (error) {
      tell([say("failed", { line: (error as Error).message })]);
    }
  }

  /** Predicts the touch of a skin on the slice, unless that was done for these frames. */
  async function feel(all: Followed): Promise<Skin> {
    if (all.skin) return all.skin;
    const { state: now, rate } = all;
    const transducers = studio.view.positions.length / 3;
    const { size } = limitsOf(transducers);
    if (now.path!.frequency < SLOWEST) throw new Error(say("skinSlow", { turns: SLOWEST }));
    if (now.plane.size > size) throw new Error(say("skinWide", { size: Math.floor(1000 * size) }));
    return (all.skin = await predict(engine.slow, now, transducers, rate));
  }

  /** Shows a frame of both methods; returns false if the state has changed meanwhile. */
  async function show(all: Followed, t: number, still: () => boolean): Promise<boolean> {
    const { state: now, places, frames, chart, flights, requested: theirs } = all;
    const quantity = touchOf(state());
    const count = now.points.length;
    const points = now.points.map((_, j) => [...places.subarray(3 * (t * count + j), 3 * (t * count + j) + 3)] as Vec3);
    const there = { ...now, points };
    const grids = quantity ? [] : planesOf(now).map((plane) => gridOf(now, COARSE, plane));
    const before = performance.now();
    const [a, b] = await Promise.all([
      engine.slow.frame(t, JSON.stringify(sceneOf(there, 0)), grids, now.ear),
      slowB ? null : engine.slots[1].update(JSON.stringify(sceneOf(there, 1)), grids, now.ear, true).then((b) => ((slowB = performance.now() - before > PATIENCE), b)),
    ]);
    if (!still() || requested() !== theirs) return false;
    const skin = quantity && (await feel(all));
    const lattice = skin && (quantity === "felt" ? skin.felt : await skin.moved(t));
    if (!still() || requested() !== theirs) return false;
    at = t;
    chart.mark(t / (frames.length - 1));
    const results: Shown["results"] = [resultOf(a), b && resultOf(b)];
    // The skin is predicted for A's frames only.
    const shown = skin ? (results.map((result, slot) => result && { ...result, lattice: slot ? null : lattice }) as Shown["results"]) : results;
    const touch = skin && { ...skin, quantity };
    const beads = beadsAt(flights, lap * frames.length + t, frames.length);
    studio.show({ points, results: shown, names: ["glide", b ? "" : say("atRest")], change: frames[t].change, touch, beads });
    place();
    return true;
  }

  async function run(from: number) {
    if (!state().path) return;
    const mine = ++run_;
    const still = () => run_ === mine;
    if (mode === "rest") lap = 0;
    [mode, begun, aside] = ["play", requested(), false];
    place();
    try {
      const all = await follow();
      const count = all.frames.length;
      const stride = strideOf(count);
      for (let t = from % count; still(); t = (t + stride) % count) {
        if (!(await show(all, t, still))) break;
        if (t + stride >= count) lap += 1;
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      fail(error, still());
    }
    if (still()) halt();
  }

  /** Reports why frames cannot be shown; then no skin is. */
  function fail(error: unknown, current: boolean) {
    if (!current) return;
    context.alarm(say("failed", { line: (error as Error).message }));
    if (isTouch(state().quantity)) studio.change({ quantity: "modulus" });
  }

  /** Pauses at a frame; `touches`: only the touch of a skin was requested. */
  async function seek(t: number, touches = false) {
    const mine = ++run_;
    aside = touches && (aside || mode === "rest");
    [mode, begun] = ["pause", requested()];
    at = t;
    try {
      const all = await follow();
      await show(all, Math.min(t, all.frames.length - 1), () => run_ === mine);
    } catch (error) {
      fail(error, run_ === mine);
    }
  }

  /** Makes the shown frame have the touch of the state, a moment after the last change, and no frame after a touch. */
  function follows() {
    const now = state();
    clearTimeout(soon);
    if (isTouch(now.quantity) && !now.path) {
      // `fail` changes the state, which places the page again. So it waits until the page has been placed for this state.
      return queueMicrotask(() => fail(new Error(say("skinNeedsPath")), isTouch(state().quantity) && !state().path));
    }
    const quantity = touchOf(now);
    if (mode === "play" || studio.view.moving || (studio.view.frame?.touch?.quantity ?? null) === quantity) return;
    if (!quantity && aside) return halt();
    const key = `${quantity} ${requested()}`;
    if (touched === key) return;
    soon = window.setTimeout(() => {
      touched = key;
      void seek(at, true);
    }, quantity ? REST : 0);
  }

  /** Saves one turn, frame by frame, as a film. */
  async function save(kind: Film) {
    const mine = ++run_;
    [mode, begun, lap] = ["play", requested(), 0];
    place();
    films.forEach((each) => (each.disabled = true));
    try {
      const all = await follow();
      await record(kind, canvas, async (shoot) => {
        for (let t = 0; run_ === mine && t < all.frames.length; t += strideOf(all.frames.length)) {
          if (!(await show(all, t, () => run_ === mine))) break;
          await new Promise(requestAnimationFrame);
          shoot();
        }
      });
    } catch (error) {
      fail(error, run_ === mine);
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
    follows();
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
