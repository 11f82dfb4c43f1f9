/** Sentence: the page's result in one sentence with one large number. */

import { changes } from "../state/changes.ts";
import type { Context } from "./context.ts";
import { element, explained, write } from "./dom.ts";
import { sentenceOf } from "./numbers.ts";
import { type Word, WORDS } from "./words.ts";

/** For each number in the sentence, the name of the text that explains it. */
const TIPS: Record<string, Word> = {
  count: "countTip",
  pressure: "weakestTip",
  level: "decibelTip",
  evenness: "uniformityTip",
  time: "timeTip",
  strength: "strengthTip",
  push: "forceTip",
  width: "feltWidthTip",
};

/** Makes the sentence. */
export function createSentence({ studio, say, language }: Context): { root: HTMLElement; update(): void } {
  const line = element("p");
  // It says what one sees until something is changed.
  const lead = element("small");
  const root = element("div", { className: "sentence" }, lead, line);
  let time = "…";
  let numbers: [string, HTMLElement][] = [];
  const build = changes((word: Word) => {
    numbers = [];
    const parts = WORDS[word][language === "ja" ? 1 : 0].split(/\{(\w+)\}/);
    const texts = parts.map((part, k) => {
      if (k % 2 === 0) return part;
      const number = explained(element(["pressure", "strength", "push"].includes(part) ? "strong" : "b"), say(TIPS[part]));
      numbers.push([part, number]);
      return number;
    });
    line.replaceChildren(...texts);
  });
  return {
    root,
    update() {
      const sentence = sentenceOf(studio.view);
      root.hidden = !sentence;
      if (!sentence) return;
      build(sentence.word);
      lead.hidden = studio.history.canUndo();
      write(lead, say("lead", { speakers: studio.view.positions.length / 3 }));
      // While something moves there is no new time, and the line must not jump.
      if (sentence.put.time !== "…") time = String(sentence.put.time);
      sentence.put.time = time;
      for (const [part, number] of numbers) write(number, String(sentence.put[part]));
    },
  };
}
