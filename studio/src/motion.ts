/** Motion: points on a path, followed by glide frame by frame and shown slowly. */

import { createChart } from "./chart.ts";
import type { Context } from "./context.ts";
import { choice, element, labelled, write } from "./dom.ts";
import type { Frame } from "./door.ts";
import { sceneOf } from "./scene_file.ts";
import { gridOf } from "./lattices.ts";
import { pressure } from "./numbers.ts";
import { framesOf } from "./paths.ts";
import type { Path, Vec3 } from "./types.ts";

/** Frames a second that are computed, where that makes neither too few nor too many of a turn. */
const RATE = 1000;

/** Frames of a turn. */
const FEWEST = 20;
const MOST = 1000;

/** Frames that a picture goes on by: a turn takes some seconds. */
const STRIDE = 4;

/** Places along a side of a slice that moves. */
const COARSE = 80;

/** Phases that change by less than this, in rad, do not. */
const STILL = 1e-6;

/** Makes the controls. */
export function createMotion(context: Context): { root: HTMLElement; place(): void } {
  const { studio, engine, say } = context;
  const state = () => studio.view.state;
  const kind = choice(
    (["none", "circle", "line"] as const).map((name) => [name, say(name)]),
    "none",
    (name) => studio.change({ path: pathOf(name) }),
  );
  const number = (set: (value: number) => Partial<Path>, min: number, max: number) => {
    const input = element("input", { type: "number", min, max });
    input.onchange = () => {
      const { path } = state();
      const value = Number(input.value);
      if (path && value >= min && value <= max) studio.change({ path: { ...path, ...set(value) } as Path });
      place();
    };
    return input;
  };
  const size = number((mm) => (state().path?.kind === "line" ? { length: mm / 1000 } : { radius: mm / 1000 }), 1, 100);
  const turns = number((frequency) => ({ frequency }), 0.1, 50);
  const move = element("button", { className: "small", onclick: toggle }, say("move"));
  const found = element("div");
  const more = element("div", {}, labelled(say("radius"), size), labelled(say("frequency"), turns), move, found);
  let running = 0;
  /** The state that `found` tells of. */
  let asked = "";

  context.ending(() => {
    if (running) halt();
  });

  function pathOf(name: string): Path | null {
    if (name === "circle") return { kind: "circle", radius: 0.01, frequency: 4 };
    return name === "line" ? { kind: "line", length: 0.02, frequency: 4 } : null;
  }

  function toggle() {
    if (running) halt();
    else void run();
  }

  function halt() {
    running = 0;
    studio.show(null);
    write(move, say("move"));
  }

  async function run() {
    const { path, points, plane } = state();
    if (!path) return;
    running += 1;
    const mine = running;
    const begun = JSON.stringify(state());
    const still = () => running === mine && JSON.stringify(state()) === begun;
    write(move, say("rest"));
    try {
      const count = Math.max(FEWEST, Math.min(MOST, Math.round(RATE / path.frequency)));
      const rate = count * path.frequency;
      const frames = framesOf(points, path, rate, count / rate);
      const scene = { ...sceneOf(state(), 0), solver: { name: "glide", rate } };
      const answers = await engine.slow.follow(JSON.stringify(scene), frames, count);
      const { told, chart } = curvesOf(answers, count / rate);
      found.replaceChildren(element("p", { className: "told" }, told), chart.root);
      asked = begun;
      place();
      if (still()) context.announce(told);
      const grid = gridOf({ ...state(), plane }, COARSE);
      for (let t = 0; still(); t = (t + STRIDE) % count) {
        const { drive, lattice } = await engine.slow.frame(t, grid);
        if (!still()) break;
        chart.mark(t / (count - 1));
        const at = (j: number): Vec3 => [...frames.slice(3 * (t * points.length + j)).slice(0, 3)] as Vec3;
        studio.show({ drive, lattice, points: points.map((_, j) => at(j)), found: answers[t] });
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      context.alarm(say("failed", { line: (error as Error).message }));
    }
    if (running === mine) halt();
  }

  /** What is to be seen of all frames: in words, and as curves. */
  function curvesOf(frames: Frame[], seconds: number) {
    // The first frame has none before it.
    const changes = frames.map(({ change }, t) => (t ? change : frames[1].change));
    const weakest = frames.map(({ least }) => least);
    const change = Math.max(...changes).toFixed(2);
    const dip = ((100 * Math.min(...weakest)) / Math.max(...frames.map(({ most }) => most))).toFixed(0);
    const told = Math.max(...changes) < STILL ? say("stands") : say("moved", { change, dip });
    const curves = [
      { name: say("changes"), values: changes, most: `${change} rad` },
      { name: say("weakest"), values: weakest, most: pressure(Math.max(...weakest)) },
    ];
    return { told, chart: createChart(curves, 1000 * seconds, `${say("motion")}: ${told}`) };
  }

  function place() {
    const { path } = state();
    found.hidden = JSON.stringify(state()) !== asked;
    kind.value = path?.kind ?? "none";
    more.hidden = path === null;
    if (path) {
      size.value = String(1000 * (path.kind === "line" ? path.length : path.radius));
      turns.value = String(path.frequency);
    }
  }

  return { root: element("div", {}, labelled(say("path"), kind), more), place };
}
