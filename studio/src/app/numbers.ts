/** Numbers: the table of both methods' metrics, with the better value of each row marked. */

import { type Result, shownOf, type View } from "../solving/studio.ts";
import { touchOf } from "../solving/touch.ts";
import type { Slot, Touched } from "../state/types.ts";
import type { Word } from "./words.ts";

/** The names of the rows. */
export type Metric = "accuracy" | "sigma" | "uniformity" | "level" | "leak" | "bound" | "weakest" | "loudest" | "changes" | "atEar" | "kept" | "time";

/** A row: its name, a text for each slot or one for both, and the slot with the better value. */
export interface Row {
  word: Metric;
  values: [string, string] | [string];
  better: Slot | null;
}

/** Returns the sound pressure level in dB of a peak pressure in Pa. */
export const decibels = (peak: number) => 20 * Math.log10(peak / Math.SQRT2 / 20e-6);

/** Returns the level of a felt strength in dB above the threshold. */
export const strengthLevel = (strength: number) => 20 * Math.log10(Math.max(strength, 1e-10));

/** Formats a pressure with its unit. */
export const pressure = (pascals: number) =>
  pascals >= 1000 ? `${(pascals / 1000).toFixed(2)} kPa` : `${Number(pascals.toPrecision(3))} Pa`;

/** Formats a ratio in per cent. */
export const percent = (part: number) => `${Math.round(100 * part)} %`;

/** Returns the least |p| of the points that are not quiet, in Pa. */
export function weakest({ answer }: Result): number {
  if (!answer) return 0;
  const loud = answer.pressures.filter((_, j) => answer.targets[j] > 0).map(([re, im]) => Math.hypot(re, im));
  return Math.min(...loud);
}

/** Returns the metrics of a result, with its weakest point. */
export const metricsOf = (result: Result) => result.answer && { ...result.answer.metrics, weakest: weakest(result) };

const NONE = "–";

/** Formats a time in ms with its unit. */
export const duration = (ms: number) => (ms < 1 ? `${Math.round(1000 * ms)} µs` : `${ms.toFixed(1)} ms`);

/** Returns all rows of the table. */
export function numberRows({ results, bound, state, frame }: View): Row[] {
  const shown = frame?.results ?? results;
  const row = (word: Metric, of: (result: Result) => number, text: (value: number) => string, best: number): Row => {
    const numbers = shown.map((result) => (result?.answer ? of(result) : NaN));
    const values = numbers.map((value) => (Number.isNaN(value) ? NONE : text(value))) as [string, string];
    const ahead = best * (numbers[0] - numbers[1]);
    const better = values[0] === values[1] || !ahead ? null : ahead > 0 ? 0 : 1;
    return { word, values, better };
  };
  const fixed = (value: number) => value.toFixed(3);
  const metric = (word: "accuracy" | "sigma" | "uniformity" | "level" | "leak", best: number) =>
    row(word, (result) => result.answer!.metrics[word], word === "leak" ? (x) => x.toPrecision(2) : fixed, best);
  const limit = bound === null ? "…" : Number.isNaN(bound) ? NONE : fixed(bound);
  const rows: Row[] = [
    metric("accuracy", 0),
    metric("sigma", -1),
    metric("uniformity", 1),
    metric("level", 1),
    // Bound and times are known only for points at rest.
    ...(frame ? [] : [{ word: "bound" as const, values: [limit] as [string], better: null }]),
    row("weakest", weakest, pressure, 1),
  ];
  if (state.pressures?.includes(0)) rows.push(metric("leak", -1));
  if (state.ear) rows.push(row("atEar", ({ atEar }) => atEar, (p) => `${decibels(p).toFixed(1)} dB SPL`, -1));
  if (!frame && shown.some((result) => result?.beads.length)) {
    const [first] = shown.map((result) => result?.beads[1] ?? 0).filter(Boolean);
    rows.push(row("kept", ({ beads }) => beads[0] ?? NaN, (count) => `${count} / ${first}`, 1));
  }
  if (frame?.change !== undefined) rows.push({ word: "changes", values: [`${frame.change.toFixed(2)} rad`, NONE], better: null });
  if (!frame) rows.push(row("time", ({ milliseconds }) => milliseconds, duration, 0));
  return rows;
}

/** Returns the sentence about A's result, as the name of its text and the values in it; null if there is no result. */
export function sentenceOf(view: View): { word: Word; put: Record<string, string | number> } | null {
  const { frame, state } = view;
  const [a] = shownOf(view);
  if (!a.answer) return null;
  if (frame?.touch?.quantity === "push") return { word: "pushFelt", put: { push: `${Math.round(1000 * frame.touch.force)} mN` } };
  if (frame?.touch) return touchSentence(frame.touch, state.plane.size);
  if (touchOf(state)) return { word: "skinComing", put: {} };
  const count = a.answer.targets.filter((target) => target > 0).length;
  const least = weakest(a);
  const put = {
    count,
    pressure: pressure(least),
    level: `${decibels(least).toFixed(0)} dB`,
    evenness: percent(a.answer.metrics.uniformity),
    time: Number.isNaN(a.milliseconds) ? "…" : duration(a.milliseconds),
  };
  const kind = state.signature.includes(".") ? "mixed" : state.signature ? (count === 1 ? "oneTrap" : "traps") : count === 1 ? "focus" : "foci";
  const motion = kind === "mixed" ? "mixedInMotion" : state.signature ? "trapsInMotion" : "inMotion";
  return { word: frame ? motion : kind, put };
}

/** Returns the sentence about the touch of a skin of this size in m. */
function touchSentence({ most, width }: Touched, size: number): { word: Word; put: Record<string, string> } {
  const level = Math.round(strengthLevel(most));
  const put = { strength: `${Math.abs(level)} dB`, width: `${width < size ? "" : "> "}${Math.round(1000 * Math.min(width, size))} mm` };
  return { word: level < 0 ? "skinBelow" : "skinFelt", put };
}
