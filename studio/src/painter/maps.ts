/** Colour maps, and how p becomes a colour: the same arithmetic as in the shaders, for all other code. */

import colours from "../../../python/midair/_pictures/colours.json";
import type { Look } from "../state/types.ts";

/** The range of the decibel scale below its top, in dB. */
export const RANGE = 30;

/** Returns a table of the 256 colours that `at` returns from 0 to 1. */
const tableOf = (at: (t: number) => number[]) => new Uint8Array(Array.from({ length: 256 }, (_, i) => [...at(i / 255), 255].map(Math.round)).flat());

/** Returns a function of `t` (0 to 1) that interpolates between evenly spaced colours. */
const between = (stops: number[][]) => (t: number) => {
  const i = Math.min(Math.floor(t * (stops.length - 1)), stops.length - 2);
  const f = t * (stops.length - 1) - i;
  return stops[i].map((value, channel) => value * (1 - f) + stops[i + 1][channel] * f);
};

/**
 * The colour maps as 256 colours of four bytes (red, green, blue, 255): |p| and the wave on a dark and a light page, where
 * silence has the page's colour; and the phase.
 */
export const TABLES = {
  field: tableOf(between(colours.field)),
  field_light: tableOf(between(colours.field_light)),
  wave: tableOf(between([[178, 216, 255], [45, 118, 200], [12, 15, 20], [200, 84, 36], [255, 208, 150]])),
  wave_light: tableOf(between([[10, 48, 110], [88, 150, 206], [246, 248, 250], [224, 122, 84], [120, 16, 32]])),
  phase: tableOf(between(colours.phase)),
};
export type MapName = keyof typeof TABLES;

/** Returns the name of the colour map of a look. */
export const mapOf = ({ quantity, theme }: Look): MapName =>
  quantity === "phase" ? quantity : `${quantity === "wave" ? "wave" : "field"}${theme === "dark" ? "" : "_light"}`;

/** Returns where `modulus` (|p| in Pa) is on the map, 0 to 1. */
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

/**
 * Returns where p = re + j im (Pa) is on its map, 0 to 1: |p| by `tone`, Re(p e^{-jwt}) from -top to top, the phase from -pi to
 * pi.
 */
export function shade(look: Look, re: number, im: number): number {
  if (look.quantity === "modulus") return tone(look, Math.hypot(re, im));
  if (look.quantity === "phase") return 0.5 + Math.atan2(im, re) / (2 * Math.PI);
  const now = re * Math.cos(look.turn) + im * Math.sin(look.turn);
  return Math.min(Math.max(0.5 + now / look.top / 2, 0), 1);
}

/** Returns the |p| (Pa) at `t` (0 to 1) of the map: the inverse of `tone`. */
export function modulusAt({ scale, top }: Look, t: number): number {
  return top * (scale === "linear" ? t : scale === "squared" ? Math.sqrt(t) : 10 ** ((RANGE * (t - 1)) / 20));
}

/** Returns the colour at `t` (0 to 1) of a map: red, green, blue, 0 to 255, interpolated linearly. */
export function entry(map: MapName, t: number): [number, number, number] {
  const table = TABLES[map];
  const i = Math.min(Math.floor(t * 255), 254);
  const f = t * 255 - i;
  const mix = (channel: number) => table[4 * i + channel] * (1 - f) + table[4 * i + 4 + channel] * f;
  return [mix(0), mix(1), mix(2)];
}

/** Draws each pixel of a canvas in the colour that `at` returns for its middle, 0 to 1 to the right and up. */
export function drawPixels(canvas: HTMLCanvasElement, at: (right: number, up: number) => [number, number, number]): void {
  const { width, height } = canvas;
  const pen = canvas.getContext("2d")!;
  const image = pen.createImageData(width, height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) image.data.set([...at((x + 0.5) / width, 1 - (y + 0.5) / height), 255], 4 * (y * width + x));
  }
  pen.putImageData(image, 0, 0);
}

/** Returns the colour of p = re + j im (Pa): red, green, blue, 0 to 255. */
export function colour(look: Look, re: number, im = 0): [number, number, number] {
  return entry(mapOf(look), shade(look, re, im));
}

/** A mark of the colour bar: its |p| or Re p in Pa or phase in rad, its place on the bar (0 bottom, 1 top), its text. */
export interface Tick {
  value: number;
  at: number;
  label: string;
}

/** Returns the least of 1, 2, 5, 10, 20, ... (times a power of ten) that is not below `least`. */
export function roundStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * ([1, 2, 5].find((digit) => digit * power >= least * 0.999) ?? 10);
}

/** Returns a whole number as text, with a minus sign in place of the hyphen. */
const signed = (value: number) => `${value < 0 ? "\u2212" : ""}${Math.abs(value)}`;

/**
 * Returns the marks of the colour bar of `look`: |p| or Re p in Pa or kPa, |p| in dB below the top, the phase in rad, felt strength
 * in dB above the threshold, a push in Pa or kPa, or displacement in um.
 */
export function ticks(look: Look): Tick[] {
  const waves = look.quantity === "wave";
  // At w t = 0 the wave is Re p.
  const tick = (value: number, label: string) => ({ value, at: shade({ ...look, turn: 0 }, value, 0), label });
  if (look.quantity === "phase") {
    return ["\u2212π", "\u2212π/2", "0", "π/2", "π"].map((name, k) => ({ value: (Math.PI * (k - 2)) / 2, at: k / 4, label: k === 2 ? name : `${name} rad` }));
  }
  if (look.touch === "felt") {
    const top = 20 * Math.log10(look.top);
    const first = Math.ceil((top - RANGE) / 10);
    return Array.from({ length: Math.floor(top / 10) - first + 1 }, (_, k) => {
      const level = 10 * (first + k);
      return { value: 10 ** (level / 20), at: 1 + (level - top) / RANGE, label: `${signed(level)} dB` };
    });
  }
  if (!waves && look.scale === "decibel") {
    return [-30, -20, -10, 0].map((level) => {
      const at = 1 + level / RANGE;
      return { value: modulusAt(look, at), at, label: `${signed(level)} dB` };
    });
  }
  const [unit, name] = look.touch === "skin" ? [1e-6, "µm"] : look.top >= 1000 ? [1000, "kPa"] : [1, "Pa"];
  const step = roundStep(look.top / unit / (waves ? 3 : 5));
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const count = Math.floor(look.top / unit / step + 1e-6);
  return Array.from({ length: count * (waves ? 2 : 1) + 1 }, (_, k) => {
    const i = waves ? k - count : k;
    return tick(i * step * unit, i ? `${i < 0 ? "\u2212" : ""}${Math.abs(i * step).toFixed(digits)} ${name}` : "0");
  });
}
