/** Error messages of the core and of the page about scenes, files and boards, shortened and in the page's language. */

import { type Language, type Word, say } from "./words.ts";

/** The most common messages in Japanese; others stay in English. */
const JAPANESE: [RegExp, string][] = [
  // Messages of the core about a scene.
  [/point (\d+) is reached by no.*/, "点 $1 に音が届きません: アレイの前に移すか、0 Pa にしてください"],
  [/point (\d+) is .* from transducer .*/, "点 $1 が振動子に近すぎます: 離してください"],
  [/point (\d+)\.position is .*where no sound is.*/, "点 $1 は障害物の中か裏です: 動かしてください"],
  [/point (\d+)\.position is .*behind every transducer.*/, "点 $1 はアレイの裏側です: 前に移してください"],
  [/point (\d+)\.position is .*in the plane of the transducers.*/, "点 $1 はアレイと同じ平面にあります: 前に移してください"],
  [/point (\d+)\.position is .*(far beyond an array|bring it within).*/, "点 $1 はアレイから遠すぎます: 近づけてください"],
  [/point (\d+)\.pressure is .*at most (.*) there.*/, "点 $1 の音圧には届きません: アレイの最大は $2 です"],
  [/point (\d+)\.pressure is .* from point (\d+) with.*/, "点 $1 と点 $2 は近すぎて、音圧に差をつけられません: 同じ音圧にするか、離してください"],
  [/pressures is all 0.*/, "すべての点が 0 Pa です: 1 点以上に音圧を与えてください"],
  [/the pressures are beyond reach: .* than (\S+) of all.*/, "すべての目標音圧には届きません: 同時に出せるのは、目標の $1 倍までです"],
  [/the pressures are missed by (\S+) %.*/, "目標音圧からのずれが $1 % (二乗平均平方根) あります: 音圧を下げるか、点を減らしてください"],
  [/targets are (\S+) of the balanced level.*/, "目標音圧が均衡レベルの $1 倍しかありません: 焦点がぼやけるか、強くなりすぎます"],
  [/at (\S+) kPa the second harmonic.* at (\S+) of \|p\|.*/, "$1 kPa では、モデルにない第2高調波が |p| の $2 倍になると見積もられます: 実際の焦点はこれより弱くなります"],
  [/.*scale all drives by (\S+).*/, "この振幅は出せません: 電源電圧か変調で、全体の出力を $1 倍にしてください"],
  [/obstacles\[\d+\] is .*crosses the array.*/, "障害物がアレイに重なっています: 動かしてください"],
  [/obstacles\[\d+\] is a sphere among others.*/, "球はほかの障害物と一緒に使えません: 障害物を一つにしてください"],
  [/obstacles\[\d+\]\.radius is .*at most (\S+ m),.*/, "球が大きすぎます: 半径は $1 以下にしてください"],
  // Messages of the page about files and texts.
  [/give \.toml, .*/, "開けるファイルは .toml、.json、.csv、.svg、.png、.jpg です"],
  [/points is (\d+): the page has at most (\d+).*/, "点が $1 個あります: このページで扱えるのは $2 個までです"],
  [/(\S+) is (.*): the page has .*/, "$1 ($2) はこのページでは扱えません: Python パッケージをお使いください"],
  [/(\d+) rows: give at most (\d+)/, "振動子が $1 個あります: $2 個以下にしてください"],
  [/the drawing is larger than ([^:]*):.*/, "図形が大きすぎます: $1 以下の SVG にしてください"],
  [/the drawing has more than (\d+) elements:.*/, "図形の要素が多すぎます: $1 個以下にしてください"],
  [/the drawing cannot be read:.*/, "SVG として読めません: パスか基本図形のある SVG にしてください"],
  [/the drawing has a script .*/, "SVG にスクリプトかページが入っています: 取り除いてください"],
  [/the drawing has no (lines|size):.*/, "図形に線がありません: パスか基本図形のある SVG にしてください"],
  [/it cannot be read as a picture: .*/, "画像として読めません: PNG か JPEG にしてください"],
  [/it is dark everywhere .*/, "画像に明るいところがありません: 黒地に白で描いてください"],
  [/the text has "(.*?)".*/, "「$1」は描けません: ほかの文字にしてください"],
  [/the text is empty: .*/, "文字がありません: 1 文字以上入力してください"],
  [/the link has a broken "%": .*/, "リンクが壊れています: もう一度コピーしてください"],
  // Messages of the page about browsers and boards.
  [/this browser records no WebM: .*/, "このブラウザでは WebM に記録できません: GIF を選ぶか、Chrome、Edge、Firefox をご利用ください"],
  [/this browser cannot run midair .*/, "このブラウザでは midair を使えません: SIMD に対応した WebAssembly が必要です"],
  [/the port of (\S+) cannot be opened \((.*)\): .*/, "$1 のポートを開けません ($2): ボードをつなぎ、ポートを使っているほかのプログラムを終了してください"],
  [/the port of (\S+) is gone \((.*)\): the board was turned off.*/, "$1 との接続が切れました ($2): ボードは停止しました。接続し直してください"],
  [/the port of (\S+) is gone \((.*)\): the board may still play.*/, "$1 との接続が切れました ($2): 出力が続いているかもしれません。電源を切り、接続し直してください"],
  [/(\S+) cannot play this \((.*)\): it is off/, "$1 では出力できません ($2): ボードを停止しました"],
  [/it was unplugged/, "取り外されました"],
  [/it takes nothing/, "応答がありません"],
];

/** Returns a message in the page's language, if its translation is known. */
function translated(language: Language, line: string): string {
  if (language === "en") return line;
  return JAPANESE.reduce((text, [pattern, japanese]) => text.replace(pattern, japanese), line);
}

/** Returns a text of the page with its values; a value `line`, which is an error message, is translated, too. */
export function report(language: Language, word: Word, put: Record<string, string | number> = {}): string {
  return say(language, word, "line" in put ? { ...put, line: translated(language, `${put.line}`) } : put);
}

/**
 * Returns a message without the file's position and examples, with points counted from 1, in the page's language if its
 * translation is known.
 */
export function plain(language: Language, line: string): string {
  const short = line
    .replace(/^scene file[^:]*: |; for example .*/g, "")
    .replace(/[,:;]? *balance=True cures it/, "")
    .replace(/points\[(\d+)\]/g, (_, k) => `point ${+k + 1}`);
  return translated(language, short);
}
