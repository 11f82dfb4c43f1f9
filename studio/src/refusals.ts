/** Refusals: the core's messages about scenes that the page has written, for users who have never seen their files. */

import type { Language } from "./words.ts";

/** The most common messages in Japanese; other lines stay as they are. */
const JAPANESE: [RegExp, string][] = [
  [/(\d+) is reached by no/, "点 $1 に音が届きません: アレイの前に移すか、0 Pa にしてください"],
  [/(\d+)\.position is .*where no sound is/, "点 $1 は障害物の中か裏です: 動かしてください"],
  [/crosses the array/, "障害物がアレイに重なっています: 動かしてください"],
  [/pressures is all 0/, "すべての点が 0 Pa です: 一点以上に音圧を与えてください"],
  [/(\d+)\.pressure is .*at most (.*) there/, "点 $1 の音圧には届きません: アレイの最大は $2 です"],
  [/scale all drives by (\S+)/, "この振幅は出せません: 電源か変調で全駆動を $1 倍にしてください"],
];

/** A line without the file's places and examples, its points counted from 1, in the page's language where it is known. */
export function plain(language: Language, line: string): string {
  const short = line
    .replace(/^scene file[^:]*: |; for example .*/g, "")
    .replace(/[,:;]? *balance=True cures it/, "")
    .replace(/points\[(\d+)\]/g, (_, k) => `point ${+k + 1}`);
  const known = language === "ja" && JAPANESE.find(([pattern]) => pattern.test(short));
  return known ? known[0].exec(short)![0].replace(...known) : short;
}
