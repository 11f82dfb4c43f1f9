/** Gallery: scenes to begin with, each of which makes a point about its two methods. */

import ball from "../../docs/scenes/gallery/ball.json";
import ear from "../../docs/scenes/gallery/ear.json";
import letters from "../../docs/scenes/gallery/letters.json";
import pair from "../../docs/scenes/gallery/pair.json";
import ring from "../../docs/scenes/gallery/ring.json";
import smiley from "../../docs/scenes/gallery/smiley.json";
import traps from "../../docs/scenes/gallery/traps.json";
import weak from "../../docs/scenes/gallery/weak.json";
import { initial } from "./initial.ts";
import { type SceneFile, stateOf } from "./scene_file.ts";
import type { State } from "./types.ts";

/** English and Japanese. */
export type Texts = [string, string];

/** A scene: its state, its name, and one line of what there is to see. */
export interface Example {
  name: Texts;
  line: Texts;
  state: State;
}

/** The state of a scene file, which names method A, and what such a file has no place for: method B, the view. */
function shown(file: object, b: string, more: Partial<State> = {}): State {
  const state = stateOf(file as SceneFile, initial);
  return { ...state, methods: [state.methods[0], b], ...more };
}

/** Eight scenes, the states that they begin with; the examples of the package begin with the same files. */
export const gallery: Example[] = [
  {
    name: ["Smiley", "スマイリー"],
    line: [
      "A face that a palm can feel: B's foci are uneven, A's are all alike.",
      "手のひらで感じる顔。Bは焦点の強さにむらがあり、Aはすべて同じです。",
    ],
    state: shown(smiley, "naive", { view: "slice" }),
  },
  {
    name: ["Letters", "文字"],
    line: [
      "Strokes of foci 5 mm apart: A keeps all alike, B leaves some weak.",
      "5 mm間隔の焦点で書いた文字。Aはすべて同じ強さ、Bは弱い点が残ります。",
    ],
    state: shown(letters, "gspat", { view: "slice" }),
  },
  {
    name: ["Ring in motion", "動く輪"],
    line: [
      "Six foci go around once in two seconds: glide turns every phase gently from frame to frame.",
      "六つの焦点が2秒で一周。glideは位相をフレームごとに少しずつ変えます。",
    ],
    state: shown(ring, "naive", { path: { kind: "circle", radius: 0.015, frequency: 0.5 } }),
  },
  {
    name: ["Quiet ear", "静かな耳"],
    line: [
      "Nine points of 0 Pa keep the marked ear quiet, 20 mm above four loud foci; B knows nothing of them.",
      "0 Paの9点 (破線) で、四つの強い焦点の20 mm上、印のある耳を静かに保ちます。Bはこれを考慮しません。",
    ],
    state: shown(ear, "naive", { ear: [0.06, 0.06, 0.22], scale: "decibel" }),
  },
  {
    name: ["Traps", "音響トラップ"],
    line: [
      "Three beads could hang between two boards: the slices cross in the dark node of one, with loud shells around.",
      "二枚のボードの間に粒を三つ浮かせます。三断面は一つの暗い節で交わり、音の強い殻が囲みます。",
    ],
    state: shown(traps, "naive", { view: "planes" }),
  },
  {
    name: ["Face to face", "向かい合う二枚"],
    line: [
      "Two boards share the work: foci between them stand in waves from both sides.",
      "二枚のボードが向かい合い、両側からの波で間に焦点を作ります。",
    ],
    state: shown(pair, "greedy"),
  },
  {
    name: ["Behind a ball", "球のうしろ"],
    line: [
      "A hard ball stands in the way, and the waves bend around it to the foci in its shadow.",
      "硬い球がじゃまをしても、波は回り込んで影の中に焦点を作ります。",
    ],
    state: shown(ball, "naive"),
  },
  {
    name: ["A weak focus", "弱い焦点"],
    line: [
      "Fig. 7 of the paper: greedy (B) leaves artefacts around a weak focus; balancing (A) cures that.",
      "論文の図7。弱い目標ではgreedy (B)に乱れが残り、バランスをとると (A) 消えます。",
    ],
    state: shown(weak, "greedy", { view: "slice" }),
  },
];
