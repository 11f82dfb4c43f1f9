/** Beads: their places in moving traps, and sentences about them. */

import type { Obstacle, Vec3 } from "../state/types.ts";
import type { Flight } from "./door.ts";

/** The flight of a bead, and the point, from 0, whose trap it is in. */
export type BeadFlight = Flight & { point: number };

/** Returns a text of the page with its values. */
type Say = (word: "beadStays" | "beadsStay" | "beadLost" | "moreLost" | "othersStay", put: Record<string, string | number>) => string;

/** Radius of the core's default bead in m. */
const RADIUS = 1e-3;

/** The smallest radius of a drawn bead, in px. */
const LEAST = 7;

/** Warm white. */
const TINT: Vec3 = [1.35, 1.27, 1.12];

/** The acceleration of a lost bead in m/s^2, and the time in s after which it is no more drawn. */
const FALL = 9.81;
const FALLEN = 0.25;

/** The most lost beads that are named; the others are counted. */
const NAMED = 3;

/**
 * Returns the places of the beads at a frame counted over all laps; the last of the laps, of `turn` frames, repeats. A lost bead
 * falls; `rate` is the number of frames per second.
 */
export function beadsAt(flights: Flight[], frame: number, turn: number, rate: number): Vec3[] {
  return flights.flatMap(({ lost, places }) => {
    const count = places.length / 3;
    const again = frame < count ? frame : count - turn + (frame % turn);
    const kept = lost === null ? again : Math.min(frame, count - 1);
    const time = lost === null ? 0 : (frame - kept) / rate;
    const [x, y, z] = places.subarray(3 * kept, 3 * kept + 3);
    return kept < 0 || time > FALLEN ? [] : [[x, y, z - (FALL / 2) * time ** 2]];
  });
}

/** Returns beads as obstacles, which the painter draws; `pixel` returns the length of a pixel in m at a place. */
export const balls = (places: Vec3[], pixel: (place: Vec3) => number, radius = RADIUS): Obstacle[] =>
  places.map((center) => ({ center, radius: Math.max(radius, LEAST * pixel(center)), kind: "rigid", tint: TINT }));

/** Returns sentences: which beads are lost and when, and how far the others are from their points at most. */
export function fateOf(flights: BeadFlight[], say: Say): string[] {
  const lost = flights.flatMap(({ lost, point }) => (lost === null ? [] : [{ n: point + 1, lost }])).sort((a, b) => a.lost - b.lost);
  const most = Math.max(...flights.filter(({ lost }) => lost === null).map(({ farthest }) => farthest));
  const far = { most: (1000 * most).toFixed(2) };
  if (!lost.length) return [say(flights.length === 1 ? "beadStays" : "beadsStay", far)];
  const named = lost.slice(0, NAMED).map(({ n, lost }) => say("beadLost", { n, ms: (1000 * lost).toFixed(0) }));
  if (lost.length > NAMED) named.push(say("moreLost", { count: lost.length - NAMED }));
  if (lost.length < flights.length) named.push(say("othersStay", far));
  return named;
}
