/** Gallery: scenes to begin with, each of which makes a point about its two methods. */

import { letters } from "./lettering.ts";
import { circle, fitting } from "./shapes.ts";
import type { State, Vec3 } from "./types.ts";

/** English and Japanese. */
export type Told = [string, string];

/** A scene: what of the first state it changes, its name, and one line of what there is to see. */
export interface Example {
  name: Told;
  line: Told;
  state: Partial<State>;
}

const FACE_HEIGHT = 0.2;

/** A face, two eyes and a mouth, m. */
function smiley(): Vec3[] {
  const mouth = Array.from({ length: 7 }, (_, k): Vec3 => {
    const angle = ((-150 + 20 * k) * Math.PI) / 180;
    return [0.03 * Math.cos(angle), 0.03 * Math.sin(angle), FACE_HEIGHT];
  });
  const eyes: Vec3[] = [[-0.02, 0.02, FACE_HEIGHT], [0.02, 0.02, FACE_HEIGHT]];
  return [...circle([0, 0, FACE_HEIGHT], 0.055, 0.0125), ...eyes, ...mouth];
}

const EAR: Vec3 = [0.06, 0.06, 0.22];

/** Corners of a box around the ear and its middle, half a wavelength wide, m. */
function earBox(): Vec3[] {
  const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z): Vec3 => [x, y, z])));
  return [EAR, ...corners.map((side) => EAR.map((x, axis) => x + 0.002 * side[axis]) as Vec3)];
}

const AROUND: Vec3[] = [[-0.05, 0, 0.2], [0, -0.05, 0.2], [0.05, -0.05, 0.2], [-0.05, -0.05, 0.2]];

/** Eight scenes, each to be laid over the first state. */
export const gallery: Example[] = [
  {
    name: ["Smiley", "スマイリー"],
    line: [
      "A face that a palm can feel: B's foci are uneven, A's are all alike.",
      "手のひらで感じる顔。Bは焦点の強さにむらがあり、Aはすべて同じです。",
    ],
    state: {
      points: smiley(),
      methods: ["uniform", "naive"],
      plane: { z: FACE_HEIGHT, size: 0.16, center: [0, 0] },
      view: "slice",
    },
  },
  {
    name: ["Letters", "文字"],
    line: [
      "Strokes of foci 5 mm apart: A keeps all alike, B leaves some weak.",
      "5 mm間隔の焦点で書いた文字。Aはすべて同じ強さ、Bは弱い点が残ります。",
    ],
    state: {
      points: fitting((step) => letters("OK", 0.05, 0.2, step), 52),
      methods: ["uniform", "gspat"],
      plane: { z: 0.2, size: 0.14, center: [0, 0] },
      view: "slice",
    },
  },
  {
    name: ["Ring in motion", "動く輪"],
    line: [
      "Six foci go around once in two seconds: glide turns every phase gently from frame to frame.",
      "六つの焦点が2秒で一周。glideは位相をフレームごとに少しずつ変えます。",
    ],
    state: {
      points: circle([0, 0, 0.18], 0.03, 0.0314),
      methods: ["glide", "naive"],
      plane: { z: 0.18, size: 0.14, center: [0, 0] },
      path: { kind: "circle", radius: 0.015, frequency: 0.5 },
    },
  },
  {
    name: ["Quiet ear", "静かな耳"],
    line: [
      "Nine points of 0 Pa keep an ear quiet beside four loud foci; B knows nothing of them.",
      "0 Paの9点で、四つの強い焦点のそばの耳を静かに保ちます。Bはこれを考慮しません。",
    ],
    state: {
      points: [...AROUND, ...earBox()],
      pressures: [...AROUND.map(() => 3000), ...earBox().map(() => 0)],
      methods: ["uniform", "naive"],
      ear: EAR,
      plane: { z: 0.22, size: 0.2, center: [0, 0] },
      scale: "decibel",
    },
  },
  {
    name: ["Traps", "音響トラップ"],
    line: [
      "Three beads could hang between two boards: dark nodes inside of bright shells.",
      "二枚のボードの間に粒を三つ浮かせます。明るい殻の中の暗い節が粒を捕まえます。",
    ],
    state: {
      array: { preset: "openmpd_pair", tiles: [1, 1] },
      points: [[-0.02, 0, 0], [0.02, 0.01, 0], [0, -0.03, 0]],
      signature: "trap",
      methods: ["uniform", "naive"],
      plane: { z: 0.0022, size: 0.1, center: [0, 0] },
    },
  },
  {
    name: ["Face to face", "向かい合う二枚"],
    line: [
      "Two boards share the work: foci between them stand in waves from both sides.",
      "二枚のボードが向かい合い、両側からの波で間に焦点を作ります。",
    ],
    state: {
      array: { preset: "sonicsurface_pair", tiles: [1, 1] },
      points: circle([0, 0, 0], 0.025, 0.0314),
      methods: ["uniform", "greedy"],
      plane: { z: 0, size: 0.1, center: [0, 0] },
    },
  },
  {
    name: ["Behind a ball", "球のうしろ"],
    line: [
      "A hard ball stands in the way, and the waves bend around it to the foci in its shadow.",
      "硬い球がじゃまをしても、波は回り込んで影の中に焦点を作ります。",
    ],
    state: {
      points: [[0, 0, 0.2], [-0.03, 0, 0.2], [0.03, 0, 0.2]],
      obstacles: [{ center: [0, 0, 0.12], radius: 0.03, kind: "rigid" }],
      methods: ["uniform", "naive"],
      plane: { z: 0.2, size: 0.16, center: [0, 0] },
    },
  },
  {
    name: ["A weak focus", "弱い焦点"],
    line: [
      "Fig. 7 of the paper: greedy (B) leaves artefacts around a weak focus; balancing (A) cures that.",
      "論文の図7。弱い目標ではgreedy (B)に乱れが残り、バランスをとると (A) 消えます。",
    ],
    state: {
      array: { preset: "paper36", tiles: [1, 1] },
      quantization: "none",
      points: [[0, 0, 0.15]],
      pressures: [1],
      methods: ["fast", "greedy"],
      plane: { z: 0.15, size: 0.12, center: [0, 0] },
      view: "slice",
    },
  },
];
