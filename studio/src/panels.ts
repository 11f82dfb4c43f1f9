/** Panels: the left column, where array, air, slice, points and all else are chosen. */

import { type Context, millimetres } from "./context.ts";
import { choice, element, group, labelled, offer, write } from "./dom.ts";
import { soundSpeed } from "./lattices.ts";
import { createMotion } from "./motion.ts";
import { createPointTable } from "./table.ts";
import { createShapes } from "./shaping.ts";
import { HEIGHT } from "./initial.ts";
import { SCALES, type Obstacle, type State } from "./types.ts";

/** The left column. */
export interface Panels {
  root: HTMLElement;
  place(): void;
}

/** Boards a side that are offered. */
const TILES = ["1x1", "2x1", "2x2", "3x2", "3x3"] as const;

/** Presets whose boards face one another, around z = 0. */
const isFacing = (array: State["array"]) => "preset" in array && /pair|lev/.test(array.preset);

/** What is offered to stand in the way. */
const OBSTACLES: Record<string, Obstacle[]> = {
  none: [],
  wall: [{ point: [0.03, 0, 0], normal: [-1, 0, 0], kind: "rigid" }],
  ball: [{ center: [0, 0, 0.1], radius: 0.02, kind: "rigid" }],
};

/** Makes the column. */
export function createPanels(context: Context): Panels {
  const { studio, say, engine } = context;
  const state = () => studio.view.state;
  const change = (partial: Partial<State>, gesture?: string) => studio.change(partial, gesture);
  const { presets } = engine.catalogue;

  const array = choice([], "", (preset) => change(standing({ preset, tiles: [1, 1] })));
  const tiles = choice(TILES.map((text) => [text, text.replace("x", " × ")]), "", (text) => {
    const [across, up] = text.split("x").map(Number);
    const { array: now } = state();
    if ("preset" in now) change(standing({ ...now, tiles: [across, up] }));
  });
  const levels = choice(
    [
      ["board", say("levelsBoard")],
      ["none", say("levelsNone")],
    ],
    "board",
    (quantization) => change({ quantization: quantization as State["quantization"] }),
  );
  const slider = (min: number, max: number, step: number, set: (value: number) => void) => {
    const input = element("input", { type: "range", min, max, step, oninput: () => (studio.moving(true), set(+input.value)) });
    input.onchange = () => studio.moving(false);
    return input;
  };
  const temperature = slider(-10, 45, 0.5, (value) => change({ temperature: value }, "drag temperature"));
  const air = element("output");
  const height = slider(20, 400, 1, (value) => change({ plane: { ...state().plane, z: value / 1000 } }, "drag height"));
  const heightText = element("output");
  const width = slider(40, 400, 5, (value) => change({ plane: { ...state().plane, size: value / 1000 } }, "drag width"));
  const widthText = element("output");
  const scale = choice(SCALES.map((name) => [name, say(name)]), "", (name) => change({ scale: name as State["scale"] }));
  const traps = choice(
    (["", "trap", "twin", "vortex"] as const).map((name) => [name, say(name || "none")]),
    "",
    (signature) => change({ signature: signature as State["signature"] }),
  );
  const obstacle = choice(
    (["none", "wall", "ball"] as const).map((name) => [name, say(name)]),
    "none",
    (name) => change({ obstacles: around(OBSTACLES[name]) }),
  );
  const ear = element("input", {
    type: "checkbox",
    onchange: () => change({ ear: ear.checked ? [state().plane.center[0], state().plane.center[1] + 0.15, 0.3] : null }),
  });
  const axes = ["x", "y", "z"].map((axis, k) =>
    element("input", {
      type: "number",
      step: 5,
      "aria-label": `${say("ear")} ${axis} mm`,
      onchange: () => {
        const to = axes.map((input) => +input.value / 1000) as [number, number, number];
        if (to.every(Number.isFinite)) change({ ear: to }, `ear ${k}`);
      },
    }),
  );
  const ears = element("div", { className: "triple" }, ...axes.map((input, k) => element("label", {}, "xyz"[k], input)));
  const table = createPointTable(context);
  const shapes = createShapes(context);
  const motion = createMotion(context);
  const boards = labelled(say("boards"), tiles);

  /** Another array: where boards face one another the points go between them, else above. */
  function standing(array: State["array"]): Partial<State> {
    const { plane, points, array: before } = state();
    const rise = isFacing(array) === isFacing(before) ? 0 : isFacing(array) ? -plane.z : HEIGHT - plane.z;
    return {
      array,
      obstacles: [],
      plane: { ...plane, z: plane.z + rise },
      points: points.map(([x, y, z]) => [x, y, z + rise]),
    };
  }

  /** A ball at the slice's middle; a wall beyond all transducers and points. */
  function around(obstacles: Obstacle[]): Obstacle[] {
    const [x, y] = state().plane.center;
    const places = [...studio.view.positions].filter((_, k) => k % 3 === 0);
    const beyond = [...places, ...state().points.map((point) => point[0])].reduce((a, b) => Math.max(a, b), x);
    return obstacles.map((each) =>
      "center" in each
        ? { ...each, center: [each.center[0] + x, each.center[1] + y, each.center[2]] }
        : { ...each, point: [each.point[0] + beyond, each.point[1] + y, each.point[2]] },
    );
  }

  const root = element(
    "aside",
    { className: "panels", "aria-label": say("settings") },
    group(say("array"), labelled(say("preset"), array), boards, labelled(say("levels"), levels)),
    group(say("points"), table.root, shapes.root),
    group(say("slice"), labelled(say("height"), height, heightText), labelled(say("width"), width, widthText), labelled(say("scale"), scale)),
    group(say("air"), labelled(say("temperature"), temperature, air), labelled(say("signature"), traps), labelled(say("obstacle"), obstacle)),
    group(say("motion"), motion.root),
    group(say("listen"), labelled(say("ear"), ear), ears),
  );
  return {
    root,
    place() {
      const now = state();
      const own = "preset" in now.array ? [] : [[now.array.name, now.array.name] as const];
      const chosen = "preset" in now.array ? now.array.preset : now.array.name;
      offer(array, [...own, ...presets.map(({ name, count }) => [name, `${name} · ${count}`] as const)], chosen);
      const tiled = presets.find(({ name }) => name === chosen)?.tiles ?? false;
      boards.hidden = !tiled || own.length > 0;
      if ("preset" in now.array) {
        const text = now.array.tiles.join("x");
        const known = (TILES as readonly string[]).includes(text) ? TILES : [...TILES, text];
        offer(tiles, known.map((each) => [each, each.replace("x", " × ")] as const), text);
      }
      levels.value = now.quantization;
      temperature.value = String(now.temperature);
      write(air, `${now.temperature.toFixed(1)} °C · ${soundSpeed(now.temperature).toFixed(1)} m/s`);
      height.min = isFacing(now.array) ? "-100" : "20";
      height.value = String(now.plane.z * 1000);
      write(heightText, `${millimetres(now.plane.z)} mm`);
      width.value = String(now.plane.size * 1000);
      write(widthText, `${millimetres(now.plane.size)} mm`);
      [scale.value, traps.value] = [now.scale, now.signature];
      obstacle.value = now.obstacles.length === 0 ? "none" : "center" in now.obstacles[0] ? "ball" : "wall";
      ear.checked = now.ear !== null;
      ears.hidden = now.ear === null;
      now.ear?.forEach((x, k) => document.activeElement === axes[k] || (axes[k].value = millimetres(x)));
      table.place();
      motion.place();
    },
  };
}
