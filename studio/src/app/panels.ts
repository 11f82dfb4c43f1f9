/** Panels: groups of controls, of which each level of the page shows some; on a phone the groups are in tabs. */

import { soundSpeed } from "../state/air.ts";
import { middleOf, SIDES } from "../state/plane.ts";
import { TRAPS } from "../state/signature.ts";
import { AXES, type Level, type Obstacle, SCALES, type State, type Vec3, VIEWS } from "../state/types.ts";
import { bring, createArrayPicker } from "./arraypicker.ts";
import type { Compare } from "./compare.ts";
import { type Context, millimetres } from "./context.ts";
import { choice, element, explained, group, labelled, offer, segments, write } from "./dom.ts";
import { createMotion } from "./motion.ts";
import type { Player } from "./player.ts";
import { createShapes } from "./shaping.ts";
import { createPointTable } from "./table.ts";
import type { Word } from "./words.ts";

/** The tabs on a phone; each shows some of the groups. */
const TABS = ["methods", "points", "array", "slice", "motion"] as const;
type Tab = (typeof TABS)[number];

/** A control: its element, and a function that shows the value of a state. */
interface Control {
  root: HTMLElement;
  update?(state: State): void;
}

/** A group: the levels of the page that show it, whether it is open, and the summary of its content in its title. */
interface Group {
  word: Word;
  tab: Tab;
  levels: Level[];
  open: boolean;
  controls: Control[];
  summary?(state: State): string;
}

/** The numbers of boards that the menu offers, columns x rows. */
const TILES = ["1x1", "2x1", "2x2", "3x2", "3x3"] as const;

const VIEW_WORDS = { slice: "viewSlice", planes: "viewPlanes", volume: "viewVolume", both: "viewBoth" } as const;

/** The obstacles that the menu offers. */
const OBSTACLES: Record<string, Obstacle[]> = {
  none: [],
  wall: [{ point: [0.03, 0, 0], normal: [-1, 0, 0], kind: "rigid" }],
  ball: [{ center: [0, 0, 0.1], radius: 0.02, kind: "rigid" }],
};

/** Returns whether the boards of an array face each other, around z = 0. */
const isFacing = (array: State["array"]) => "preset" in array && /pair|lev/.test(array.preset);

const nameOf = ({ array }: State) => ("preset" in array ? array.preset : array.name);

/** Returns the name of a slice, such as "x–z, y 0 mm". */
function sliceName(plane: State["plane"]): string {
  const [right, up, normal] = SIDES[plane.axis];
  return `${AXES[right]}–${AXES[up]}, ${AXES[normal]} ${millimetres(middleOf(plane)[normal])} mm`;
}

/** The panels of the page. */
export class Panels {
  readonly root: HTMLElement;
  private readonly groups: (Group & ReturnType<typeof group>)[];
  private readonly tabs;
  private tab: Tab = "methods";
  private level = "";

  /** With `compact`, for a notebook's cell, only the methods are shown. */
  constructor(
    private readonly context: Context,
    compare: Compare,
    player: Player,
    private readonly compact: boolean,
  ) {
    const { say } = context;
    const groups: Group[] = [
      { word: "methods", tab: "methods", levels: ["engineer"], open: true, controls: [], summary: ({ methods }) => methods.join(" · ") },
      { word: "points", tab: "points", levels: ["engineer"], open: false, controls: [createPointTable(context), this.traps()], summary: ({ points }) => String(points.length) },
      { word: "array", tab: "array", levels: ["play", "engineer"], open: false, controls: this.array(), summary: (state) => `${nameOf(state)} · ${context.studio.view.positions.length / 3}` },
      { word: "shapes", tab: "points", levels: ["play", "engineer"], open: false, controls: [createShapes(context)] },
      { word: "slice", tab: "slice", levels: ["engineer"], open: false, controls: this.slice(), summary: ({ plane }) => sliceName(plane) },
      { word: "air", tab: "array", levels: ["engineer"], open: false, controls: this.air(), summary: ({ temperature }) => `${temperature} °C` },
      { word: "motion", tab: "motion", levels: ["engineer"], open: false, controls: [createMotion(context, player)], summary: ({ path }) => say(path?.kind ?? "none") },
      { word: "listen", tab: "motion", levels: ["engineer"], open: false, controls: this.ear(), summary: ({ ear }) => ear?.map(millimetres).join(", ") ?? say("none") },
      { word: "numbers", tab: "methods", levels: ["compare", "engineer"], open: true, controls: compare.numbers.map((root) => ({ root })) },
    ];
    this.groups = groups.map((each) => ({ ...each, ...group(say(each.word), ...each.controls.map(({ root }) => root)) }));
    this.tabs = segments(say("settings"), TABS.map((tab) => [tab, say(tab === "points" ? "pointsTab" : tab)]), (tab) => this.choose(tab as Tab));
    this.tabs.root.classList.add("tabs");
    this.root = element("aside", { className: "panels", id: "panels", "aria-label": say("settings") }, this.tabs.root, ...this.groups.map(({ root }) => root));
  }

  /** The group that contains the compared slice. */
  get dock(): HTMLElement {
    return this.groups[0].root;
  }

  update(): void {
    const { state } = this;
    for (const { levels, tab, root } of this.groups) root.hidden = this.compact ? tab !== "methods" : !levels.includes(state.level);
    if (this.level !== state.level) {
      for (const each of this.groups) {
        // On levels other than "engineer" groups do not fold; a group remembers whether it was open.
        if (this.level === "engineer") each.open = each.root.open;
        each.root.open = state.level !== "engineer" || each.open;
      }
      this.level = state.level;
      this.choose(this.tab);
    }
    for (const { controls, summary, holds } of this.groups) {
      controls.forEach((control) => control.update?.(state));
      if (summary) write(holds, summary(state));
    }
  }

  private get state(): State {
    return this.context.studio.view.state;
  }

  /** Shows the groups of a tab on a phone. */
  private choose(tab: Tab): void {
    this.tabs.choose((this.tab = tab));
    for (const each of this.groups) each.root.classList.toggle("away", each.tab !== tab);
    // Groups on a phone's tab do not fold, so they are opened.
    if (matchMedia("(width < 800px)").matches) this.groups.filter((each) => each.tab === tab).forEach(({ root }) => (root.open = true));
  }

  /** Makes a select: its [value, text] pairs and its value for a state, and the change for a chosen value. */
  private select(word: Word, offered: (state: State) => [pairs: (readonly [string, string])[], value: string], change: (value: string) => Partial<State> | void): Control {
    const { say, studio } = this.context;
    const select = choice([], "", (value) => studio.change(change(value) ?? {}));
    return { root: labelled(say(word), select), update: (state) => offer(select, ...offered(state)) };
  }

  /** Makes a slider: its value and text for a state, and the change for a new value. Its tip is that of its word. */
  private slider(word: "temperature" | "height" | "width", step: number, range: (state: State) => [least: number, most: number], shown: (state: State) => [value: number, text: string], change: (value: number) => Partial<State>): Control {
    const { say, studio } = this.context;
    const set = () => {
      studio.setMoving(true);
      studio.change(change(+input.value), `drag ${word}`);
    };
    const input = element("input", { type: "range", step, oninput: set, onchange: () => studio.setMoving(false) });
    const output = element("output");
    const update = (state: State) => {
      const [value, text] = shown(state);
      [input.min, input.max] = range(state).map(String);
      input.value = String(value);
      write(output, text);
    };
    return { root: labelled(say(word), input, output, say(`${word}Tip`)), update };
  }

  private array(): Control[] {
    const { context } = this;
    const { say, engine } = context;
    const { presets } = engine.catalogue;
    const picker = createArrayPicker(context, (preset) => void bring(this.context, { preset, tiles: [1, 1] }));
    const array = {
      root: labelled(say("preset"), picker.root, null, say("arrayTip")),
      update: (state: State) => {
        const file = "preset" in state.array ? [] : [[state.array.name, state.array.name] as const];
        picker.update([...file, ...presets.map(({ name, count }) => [name, `${name} · ${count}`] as const)], nameOf(state));
      },
    };
    const tilesOf = ({ array }: State) => ("preset" in array ? array.tiles.join("x") : "1x1");
    const offered = (state: State) => [...new Set([...TILES, tilesOf(state)])].map((text) => [text, text.replace("x", " × ")] as const);
    const tiles = this.select("boards", (state) => [offered(state), tilesOf(state)], (text) => void bring(this.context, { preset: nameOf(this.state), tiles: text.split("x").map(Number) as [number, number] }));
    const boards = {
      root: tiles.root,
      update: (state: State) => {
        tiles.update!(state);
        tiles.root.hidden = !("preset" in state.array && presets.find(({ name }) => name === nameOf(state))?.tiles);
      },
    };
    const levels = this.select("levels", ({ quantization }) => [[["board", say("levelsBoard")], ["none", say("levelsNone")]], quantization], (value) => ({ quantization: value as State["quantization"] }));
    const grid = {
      root: levels.root,
      update: (state: State) => {
        levels.update!(state);
        levels.root.hidden = state.level === "play";
      },
    };
    return [array, boards, grid];
  }

  private slice(): Control[] {
    const { say } = this.context;
    const plane = (part: Partial<State["plane"]>) => ({ plane: { ...this.state.plane, ...part } });
    return [
      this.slider("height", 1, ({ array }) => [isFacing(array) ? -100 : 20, 400], ({ plane }) => [1000 * plane.z, `${millimetres(plane.z)} mm`], (mm) => plane({ z: mm / 1000 })),
      this.slider("width", 5, () => [40, 400], ({ plane }) => [1000 * plane.size, `${millimetres(plane.size)} mm`], (mm) => plane({ size: mm / 1000 })),
      this.select("scale", ({ scale }) => [SCALES.map((name) => [name, name]), scale], (value) => ({ scale: value as State["scale"] })),
      this.select("view", ({ view }) => [VIEWS.map((name) => [name, say(VIEW_WORDS[name])]), view], (value) => ({ view: value as State["view"] })),
      this.select("shownSlot", ({ slot }) => [[["0", "A"], ["1", "B"]], String(slot)], (value) => ({ slot: Number(value) as State["slot"] })),
    ];
  }

  private traps(): Control {
    const { say } = this.context;
    const traps = ({ signature }: State): [string, string][] => {
      const pairs = ["" as const, ...TRAPS].map((name): [string, string] => [name, say(name || "none")]);
      return signature.includes(".") ? [...pairs, [signature, say("eachPoint")]] : pairs;
    };
    return this.select("signature", (state) => [traps(state), state.signature], (signature) => ({ signature }));
  }

  private air(): Control[] {
    const { say } = this.context;
    const kind = ([first]: Obstacle[]) => (!first ? "none" : "center" in first ? "ball" : "wall");
    return [
      this.slider("temperature", 0.5, () => [-10, 45], ({ temperature }) => [temperature, `${temperature.toFixed(1)} °C · ${soundSpeed(temperature).toFixed(1)} m/s`], (temperature) => ({ temperature })),
      this.select("obstacle", ({ obstacles }) => [(["none", "wall", "ball"] as const).map((name) => [name, say(name)]), kind(obstacles)], (name) => ({ obstacles: this.around(OBSTACLES[name]) })),
    ];
  }

  /** Returns the obstacles at their places: a sphere in the middle of the slice, a wall beyond all transducers and points. */
  private around(obstacles: Obstacle[]): Obstacle[] {
    const [x, y] = this.state.plane.center;
    const places = [...this.context.studio.view.positions].filter((_, k) => k % 3 === 0);
    const beyond = [...places, ...this.state.points.map((point) => point[0])].reduce((a, b) => Math.max(a, b), x);
    return obstacles.map((each) =>
      "center" in each
        ? { ...each, center: [each.center[0] + x, each.center[1] + y, each.center[2]] }
        : { ...each, point: [each.point[0] + beyond, each.point[1] + y, each.point[2]] },
    );
  }

  private ear(): Control[] {
    const { say, studio } = this.context;
    const place = (): Vec3 => [this.state.plane.center[0], this.state.plane.center[1] + 0.15, 0.3];
    const box = element("input", { type: "checkbox", onchange: () => studio.change({ ear: box.checked ? place() : null }) });
    const axes = AXES.map((axis, k) => {
      const move = () => {
        const to = axes.map((input) => +input.value / 1000) as Vec3;
        if (to.every(Number.isFinite)) studio.change({ ear: to }, `ear ${k}`);
      };
      return element("input", { type: "number", step: 5, "aria-label": `${say("ear")} ${axis} mm`, onchange: move });
    });
    const triple = explained(element("div", { className: "triple" }, ...axes.map((input, k) => element("label", {}, AXES[k], input))), say("coordinateTip"));
    const update = ({ ear }: State) => {
      box.checked = ear !== null;
      triple.hidden = ear === null;
      ear?.forEach((x, k) => document.activeElement === axes[k] || (axes[k].value = millimetres(x)));
    };
    return [{ root: labelled(say("ear"), box), update }, { root: triple }];
  }
}
