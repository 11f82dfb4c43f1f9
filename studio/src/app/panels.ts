/** Panels: groups of controls, of which each level of the page shows some; on a phone a sheet with tabs. */

import { createArrayPicker } from "./arraypicker.ts";
import type { Compare } from "./compare.ts";
import { type Context, millimetres } from "./context.ts";
import { choice, element, explained, group, labelled, offer, segments, write } from "./dom.ts";
import { soundSpeed } from "../state/air.ts";
import { createMotion } from "./motion.ts";
import type { Player } from "./player.ts";
import { createPointTable } from "./table.ts";
import { createShapes } from "./shaping.ts";
import { TRAPS } from "../state/signature.ts";
import { HEIGHT } from "../state/initial.ts";
import { type Level, SCALES, type Obstacle, type State, VIEWS } from "../state/types.ts";
import type { Word } from "./words.ts";

/** The panels of the page. */
export interface Panels {
  root: HTMLElement;
  /** The group that contains the compared slice. */
  dock: HTMLElement;
  update(): void;
}

/** The tabs on a phone; each shows some of the groups. */
const TABS = ["methods", "points", "array", "slice", "motion"] as const;
type Tab = (typeof TABS)[number];

/** The numbers of boards that the menu offers, columns x rows. */
const TILES = ["1x1", "2x1", "2x2", "3x2", "3x3"] as const;

/** Returns whether the boards of an array face each other, around z = 0. */
const isFacing = (array: State["array"]) => "preset" in array && /pair|lev/.test(array.preset);

/** The obstacles that the menu offers. */
const OBSTACLES: Record<string, Obstacle[]> = {
  none: [],
  wall: [{ point: [0.03, 0, 0], normal: [-1, 0, 0], kind: "rigid" }],
  ball: [{ center: [0, 0, 0.1], radius: 0.02, kind: "rigid" }],
};

/** Makes the panels; with `compact`, for a notebook's cell, only the methods. */
export function createPanels(context: Context, compare: Compare, player: Player, compact: boolean): Panels {
  const { studio, say, engine } = context;
  const state = () => studio.view.state;
  const change = (partial: Partial<State>, gesture?: string) => studio.change(partial, gesture);
  const { presets } = engine.catalogue;

  const array = createArrayPicker(context, (preset) => change(standing({ preset, tiles: [1, 1] })));
  const tiles = choice(TILES.map((text) => [text, text.replace("x", " × ")]), "", (text) => {
    const [across, up] = text.split("x").map(Number);
    const { array: now } = state();
    if ("preset" in now) change(standing({ ...now, tiles: [across, up] }));
  });
  /** Makes a select for a part of the state that has a few allowed values. */
  const pick = <Key extends "quantization" | "scale" | "view">(key: Key, pairs: (readonly [State[Key], Word])[]) => {
    const select = choice(pairs.map(([value, word]) => [value, say(word)]), state()[key], (value) => change({ [key]: value }));
    return { select, show: () => (select.value = state()[key]) };
  };
  const levels = pick("quantization", [["board", "levelsBoard"], ["none", "levelsNone"]]);
  const scale = pick("scale", SCALES.map((name) => [name, name]));
  const views = pick("view", VIEWS.map((name) => [name, VIEW_WORDS[name]]));
  const traps = choice([], "", (signature) => change({ signature }));
  const showTraps = () => {
    const { signature } = state();
    const pairs = ["" as const, ...TRAPS].map((name): [string, string] => [name, say(name || "none")]);
    offer(traps, signature.includes(".") ? [...pairs, [signature, say("eachPoint")]] : pairs, signature);
  };
  const slots = choice(["A", "B"].map((name, k) => [String(k), name]), "0", (slot) => change({ slot: Number(slot) as State["slot"] }));
  const slider = (min: number, max: number, step: number, set: (value: number) => void) => {
    const input = element("input", { type: "range", min, max, step, oninput: () => (studio.setMoving(true), set(+input.value)) });
    input.onchange = () => studio.setMoving(false);
    return input;
  };
  const temperature = slider(-10, 45, 0.5, (value) => change({ temperature: value }, "drag temperature"));
  const air = element("output");
  const height = slider(20, 400, 1, (value) => change({ plane: { ...state().plane, z: value / 1000 } }, "drag height"));
  const heightText = element("output");
  const width = slider(40, 400, 5, (value) => change({ plane: { ...state().plane, size: value / 1000 } }, "drag width"));
  const widthText = element("output");
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
  const ears = explained(element("div", { className: "triple" }, ...axes.map((input, k) => element("label", {}, "xyz"[k], input))), say("coordinateTip"));
  const table = createPointTable(context);
  const shapes = createShapes(context);
  const motion = createMotion(context, player);
  const boards = labelled(say("boards"), tiles);
  const levelsField = labelled(say("levels"), levels.select);

  /** Returns the change to another array. It moves slice and points between boards that face each other, or above others. */
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

  /** Returns the obstacles at their places: a sphere in the middle of the slice, a wall beyond all transducers and points. */
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

  const made = (
    [
      ["methods", "methods", ["engineer"], true, []],
      ["array", "array", ["play", "engineer"], false, [labelled(say("preset"), array.root, null, say("arrayTip")), boards, levelsField]],
      ["shapes", "points", ["play", "engineer"], false, [shapes.root]],
      [
        "slice", "slice", ["engineer"], false,
        [
          labelled(say("height"), height, heightText, say("heightTip")),
          labelled(say("width"), width, widthText, say("widthTip")),
          labelled(say("scale"), scale.select),
          labelled(say("view"), views.select),
          labelled(say("shownSlot"), slots),
        ],
      ],
      ["air", "array", ["engineer"], false, [labelled(say("temperature"), temperature, air, say("temperatureTip")), labelled(say("signature"), traps), labelled(say("obstacle"), obstacle)]],
      ["motion", "motion", ["engineer"], false, [motion.root]],
      ["listen", "motion", ["engineer"], false, [labelled(say("ear"), ear), ears]],
      ["numbers", "methods", ["compare", "engineer"], true, compare.numbers],
      ["points", "points", ["engineer"], false, [table.root]],
    ] as [Word, Tab, Level[], boolean, HTMLElement[]][]
  ).map(([word, tab, levels, open, children]) => {
    const { root, holds } = group(say(word), ...children);
    return { word, tab, levels, root, holds, open };
  });
  const of = (word: Word) => made.find((each) => each.word === word)!;

  const tabs = segments(say("settings"), TABS.map((tab) => [tab, say(tab === "points" ? "pointsTab" : tab)]), (tab) => choose(tab as Tab));
  let tab: Tab = "methods";
  /** Shows the groups of a tab on a phone. */
  function choose(chosen: Tab) {
    tabs.choose((tab = chosen));
    for (const each of made) each.root.classList.toggle("away", each.tab !== tab);
    // Groups on a phone's tab do not fold, so they are opened.
    if (matchMedia("(width < 800px)").matches) made.filter((each) => each.tab === tab).forEach(({ root }) => (root.open = true));
  }
  tabs.root.classList.add("tabs");
  const root = element("aside", { className: "panels", id: "panels", "aria-label": say("settings") }, tabs.root, ...made.map((each) => each.root));

  let shown = "";
  return {
    root,
    dock: of("methods").root,
    update() {
      const now = state();
      for (const { levels, tab, root: each } of made) {
        each.hidden = compact ? tab !== "methods" : !levels.includes(now.level);
      }
      if (shown !== now.level) {
        for (const each of made) {
          // On levels other than "engineer" groups do not fold; a group remembers whether it was open.
          if (shown === "engineer") each.open = each.root.open;
          each.root.open = now.level !== "engineer" || each.open;
        }
        shown = now.level;
        choose(tab);
      }
      levelsField.hidden = now.level === "play";
      const own = "preset" in now.array ? [] : [[now.array.name, now.array.name] as const];
      const chosen = "preset" in now.array ? now.array.preset : now.array.name;
      array.update([...own, ...presets.map(({ name, count }) => [name, `${name} · ${count}`] as const)], chosen);
      const tiled = presets.find(({ name }) => name === chosen)?.tiles ?? false;
      boards.hidden = !tiled || own.length > 0;
      if ("preset" in now.array) {
        const text = now.array.tiles.join("x");
        const known = (TILES as readonly string[]).includes(text) ? TILES : [...TILES, text];
        offer(tiles, known.map((each) => [each, each.replace("x", " × ")] as const), text);
      }
      temperature.value = String(now.temperature);
      write(air, `${now.temperature.toFixed(1)} °C · ${soundSpeed(now.temperature).toFixed(1)} m/s`);
      height.min = isFacing(now.array) ? "-100" : "20";
      height.value = String(now.plane.z * 1000);
      write(heightText, `${millimetres(now.plane.z)} mm`);
      width.value = String(now.plane.size * 1000);
      write(widthText, `${millimetres(now.plane.size)} mm`);
      for (const { show } of [levels, scale, views]) show();
      showTraps();
      slots.value = String(now.slot);
      obstacle.value = now.obstacles.length === 0 ? "none" : "center" in now.obstacles[0] ? "ball" : "wall";
      ear.checked = now.ear !== null;
      ears.hidden = now.ear === null;
      now.ear?.forEach((x, k) => document.activeElement === axes[k] || (axes[k].value = millimetres(x)));
      write(of("methods").holds, now.methods.join(" · "));
      write(of("array").holds, `${chosen} · ${studio.view.positions.length / 3}`);
      write(of("slice").holds, `z ${millimetres(now.plane.z)} mm`);
      write(of("air").holds, `${now.temperature} °C`);
      write(of("motion").holds, say(now.path?.kind ?? "none"));
      write(of("listen").holds, now.ear ? now.ear.map(millimetres).join(", ") : say("none"));
      write(of("points").holds, String(now.points.length));
      table.update();
      motion.update();
    },
  };
}

const VIEW_WORDS = { slice: "viewSlice", planes: "viewPlanes", volume: "viewVolume", both: "viewBoth" } as const;
