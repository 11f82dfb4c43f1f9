/** Colour maps, and how |p| becomes a colour: the arithmetic of the shaders, for all that is not a shader. */

import type { Look, MapName } from "../types.ts";
import packed from "./maps.json";

/** How far below the top the decibel scale reaches, dB. */
export const RANGE = 30;

/** First colour, then the steps of red, green and blue ("M": none), made from matplotlib's tables (CC0). */
const STEPS: Record<MapName, { first: number[]; steps: string }> = packed;

function unpack({ first, steps }: (typeof STEPS)[MapName]): Uint8Array<ArrayBuffer> {
  const table = new Uint8Array(256 * 4).fill(255);
  for (let channel = 0; channel < 3; channel++) {
    let value = first[channel];
    table[channel] = value;
    for (let i = 1; i < 256; i++) {
      value += steps.charCodeAt(channel * 255 + i - 1) - 77;
      table[4 * i + channel] = value;
    }
  }
  return table;
}

/** The maps as 256 colours of four bytes (red, green, blue, 255). */
export const TABLES = Object.fromEntries(
  Object.entries(STEPS).map(([name, steps]) => [name, unpack(steps)]),
) as Record<MapName, Uint8Array<ArrayBuffer>>;

/** Where `modulus` (|p| in Pa) lies on the map, 0 to 1. */
export function tone(look: Look, modulus: number): number {
  const ratio = modulus / look.top;
  const t =
    look.scale === "linear"
      ? ratio
      : look.scale === "squared"
        ? ratio * ratio
        : 1 + (20 * Math.log10(Math.max(ratio, 1e-9))) / RANGE;
  return Math.min(Math.max(t, 0), 1);
}

/** The |p| (Pa) that lies at `t` (0 to 1) on the map: `tone` read backwards. */
export function modulusAt({ scale, top }: Look, t: number): number {
  return top * (scale === "linear" ? t : scale === "squared" ? Math.sqrt(t) : 10 ** ((RANGE * (t - 1)) / 20));
}

/** The colour at `t` (0 to 1) of a map: red, green, blue, 0 to 255, linear between the map's entries. */
export function entry(map: MapName, t: number): [number, number, number] {
  const table = TABLES[map];
  const i = Math.min(Math.floor(t * 255), 254);
  const f = t * 255 - i;
  const mix = (channel: number) => table[4 * i + channel] * (1 - f) + table[4 * i + 4 + channel] * f;
  return [mix(0), mix(1), mix(2)];
}

/** The colour of `modulus` (|p| in Pa): red, green, blue, 0 to 255. */
export function colour(look: Look, modulus: number): [number, number, number] {
  return entry(look.map, tone(look, modulus));
}

/** A mark of the colour bar: its |p| in Pa, its place on the bar (0 bottom, 1 top), its text. */
export interface Tick {
  value: number;
  at: number;
  label: string;
}

/** The least of 1, 2, 5, 10, 20, ... (times a power of ten) that is not below `least`. */
export function roundStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * ([1, 2, 5].find((digit) => digit * power >= least * 0.999) ?? 10);
}

/** The marks of the colour bar of `look`: |p| in Pa or kPa, or in dB below the top. */
export function ticks(look: Look): Tick[] {
  const tick = (value: number, label: string) => ({ value, at: tone(look, value), label });
  if (look.scale === "decibel") {
    return [-30, -20, -10, 0].map((level) => {
      const at = 1 + level / RANGE;
      return { value: modulusAt(look, at), at, label: `${level ? `\u2212${-level}` : 0} dB` };
    });
  }
  const [unit, name] = look.top >= 1000 ? [1000, "kPa"] : [1, "Pa"];
  const step = roundStep(look.top / unit / 5);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const count = Math.floor(look.top / unit / step + 1e-6);
  return Array.from({ length: count + 1 }, (_, i) =>
    tick(i * step * unit, i ? `${(i * step).toFixed(digits)} ${name}` : "0"),
  );
}
