/** Signature: the kind of trap of all points, or of each point: names joined by dots, "focus" for a point that stays a focus. */

import type { State } from "./types.ts";

/** Names of traps. */
export const TRAPS = ["trap", "twin", "vortex"] as const;

const NAMES: readonly string[] = [...TRAPS, "focus"];

/** Returns whether a text is a signature. */
export function isSignature(text: unknown): text is string {
  if (typeof text !== "string") return false;
  const names = text.split(".");
  return text === "" || (names.length > 1 ? names.every((name) => NAMES.includes(name)) : (TRAPS as readonly string[]).includes(text));
}

/** Returns whether a signature has one name, or one for each of `count` points. */
export const fits = (signature: string, count: number) => !signature.includes(".") || signature.split(".").length === count;

/** Returns the signature as scene files have it. */
export const written = (signature: string): string | string[] => (signature.includes(".") ? signature.split(".") : signature);

/** Returns the signature of a value of a scene file; null if the page has no place for it. */
export function read(value: unknown): string | null {
  const text = Array.isArray(value) ? (value.join() === "focus" ? "" : value.join(".")) : value;
  return isSignature(text) ? text : null;
}

/** Returns whether a point is a trap. */
export const isTrap = (signature: string, point: number) => Boolean(signature) && (signature.split(".")[point] ?? signature) !== "focus";

/** Returns a signature for other points: those of `left`, by their former numbers, then `more` points like the last one. */
export function signatureOf({ signature }: State, left: number[], more = 0): string {
  const names = signature.split(".");
  if (names.length < 2) return signature;
  const all = [...left.map((k) => names[k]), ...Array<string>(more).fill(names.at(-1)!)];
  return all.length === 1 ? all[0].replace("focus", "") : all.join(".");
}
