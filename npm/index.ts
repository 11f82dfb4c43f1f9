/** midair in Node and browsers: scenes that are solved, evaluated and played. */

import type { Notice } from "../studio/src/state/refusal.ts";
import { compile, Door, written } from "../studio/src/solving/door.ts";

export { type Notice, Refusal } from "../studio/src/state/refusal.ts";
export type * from "../studio/src/solving/door.ts";
export type { OwnArray, Vec3 } from "../studio/src/state/types.ts";

/** The text of a scene file, or its content as an object. */
export type SceneFile = string | object;

/** Options for reading a scene. */
export interface Reading {
  /** Whether the text is TOML; JSON is recognised by its first character. */
  toml?: boolean;
}

/** A scene with its session: all functions of a Door except `open` and `catalogue`. */
export type Scene = Omit<Door, "open" | "catalogue"> & {
  /** Warnings about the scene. */
  readonly warnings: readonly Notice[];
};

/** The compiled module. */
export interface Midair {
  /** Returns presets, solvers and boards, and the version. */
  catalogue(): ReturnType<Door["catalogue"]>;
  /** Opens a scene; throws a `Refusal` of one line with the item, its value and the cure. `free` returns its memory. */
  open(scene: SceneFile, reading?: Reading): Scene;
}

/** The WebAssembly module: its bytes, or its address. */
export type Source = BufferSource | URL | string;

async function bytes(source: Source): Promise<BufferSource> {
  if (typeof source !== "string" && !(source instanceof URL)) return source;
  const place = new URL(source, import.meta.url);
  if (place.protocol === "file:") {
    const { readFile } = await import(/* @vite-ignore */ "node:fs/promises");
    return new Uint8Array(await readFile(place));
  }
  const response = await fetch(place);
  if (!response.ok) throw new Error(`${place} answers ${response.status}: give load() the address of midair.wasm`);
  return response.arrayBuffer();
}

/** Loads the module, by default the file midair.wasm beside this one. Call this once per page or program. */
export async function load(source: Source = new URL(/* @vite-ignore */ "./midair.wasm", import.meta.url)): Promise<Midair> {
  const module = await compile(await bytes(source));
  return {
    catalogue() {
      const door = new Door(module);
      const catalogue = door.catalogue();
      door.free();
      return catalogue;
    },
    open(scene, { toml } = {}) {
      const text = typeof scene === "string" ? scene : written(scene);
      const door = new Door(module);
      try {
        const warnings = door.open(text, toml ?? !/^\s*\{/.test(text));
        return Object.assign(door, { warnings });
      } catch (error) {
        door.free();
        throw error;
      }
    },
  };
}
