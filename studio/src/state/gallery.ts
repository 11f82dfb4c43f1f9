/** Gallery: example scenes, each of which demonstrates a difference between its two methods. */

import ball from "../../../docs/scenes/gallery/ball.json";
import ear from "../../../docs/scenes/gallery/ear.json";
import letters from "../../../docs/scenes/gallery/letters.json";
import pair from "../../../docs/scenes/gallery/pair.json";
import ring from "../../../docs/scenes/gallery/ring.json";
import smiley from "../../../docs/scenes/gallery/smiley.json";
import traps from "../../../docs/scenes/gallery/traps.json";
import weak from "../../../docs/scenes/gallery/weak.json";
import { initial } from "./initial.ts";
import { type SceneFile, stateOf } from "./scene_file.ts";
import type { State } from "./types.ts";

/** A text in English and in Japanese. */
export type Texts = [string, string];

/** An example: its name, one line about it, and its state. */
export interface Example {
  name: Texts;
  line: Texts;
  state: State;
}

/** Returns the state of a scene file. The file has method A only; `b` is method B, and `more` has the view. */
function shown(file: object, b: string, more: Partial<State> = {}): State {
  const state = stateOf(file as SceneFile, initial);
  return { ...state, methods: [state.methods[0], b], ...more };
}

/** The eight examples. Examples of the Python package use the same scene files. */
export const gallery: Example[] = [
  {
    name: ["Smiley", "スマイリー"],
    line: [
      "A face that a palm can feel: B's foci are uneven, A's are all alike.",
      "手のひらで感じられる顔。B では焦点の強さにむらがあり、A ではすべて同じです。",
    ],
    state: shown(smiley, "naive", { view: "slice" }),
  },
  {
    name: ["Letters", "文字"],
    line: [
      "Strokes of foci 5 mm apart: A keeps all alike, B leaves some weak.",
      "5 mm 間隔の焦点で書いた文字。A ではすべて同じ強さになり、B では弱い点が残ります。",
    ],
    state: shown(letters, "gspat", { view: "slice" }),
  },
  {
    name: ["Ring in motion", "動く輪"],
    line: [
      "Six foci go around once in two seconds: glide turns every phase gently from frame to frame.",
      "六つの焦点が 2 秒で 1 周します。glide は、位相をフレームごとに少しずつ変えます。",
    ],
    state: shown(ring, "naive", { path: { kind: "circle", radius: 0.015, frequency: 0.5 } }),
  },
  {
    name: ["Quiet ear", "静かな耳"],
    line: [
      "Nine points of 0 Pa keep the marked ear quiet, 20 mm above four loud foci; B knows nothing of them.",
      "四つの強い焦点の 20 mm 上にある耳 (印) を、0 Pa の 9 点 (破線) で静かに保ちます。B はこの 9 点を考慮しません。",
    ],
    state: shown(ear, "naive", { ear: [0.06, 0.06, 0.22], scale: "decibel" }),
  },
  {
    name: ["Traps", "音響トラップ"],
    line: [
      "Three beads could hang between two boards: the slices cross in the dark node of one, with loud shells around.",
      "2 枚のボードの間に、粒を三つ浮かせられる場です。三断面は一つの暗い節で交わり、そのまわりを強い音が囲みます。",
    ],
    state: shown(traps, "naive", { view: "planes" }),
  },
  {
    name: ["Face to face", "向かい合う 2 枚"],
    line: [
      "Two boards share the work: foci between them stand in waves from both sides.",
      "向かい合う 2 枚のボードが両側から波を送り、間に焦点を作ります。",
    ],
    state: shown(pair, "greedy"),
  },
  {
    name: ["Behind a ball", "球のうしろ"],
    line: [
      "A hard ball stands in the way, and the waves bend around it to the foci in its shadow.",
      "硬い球に遮られても、波は回り込み、球の影に焦点を作ります。",
    ],
    state: shown(ball, "naive"),
  },
  {
    name: ["A weak focus", "弱い焦点"],
    line: [
      "Fig. 7 of the paper: greedy (B) leaves artefacts around a weak focus; balancing (A) cures that.",
      "論文の図 7。greedy (B) では弱い焦点のまわりが乱れますが、音圧の均衡をとる A では乱れません。",
    ],
    state: shown(weak, "greedy", { view: "slice" }),
  },
];
