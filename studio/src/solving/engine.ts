/** The engine: three workers. One for each slot solves and computes its slice; the third does slow work. */

import { initial } from "../state/initial.ts";
import { Refusal } from "../state/notice.ts";
import { sceneOf } from "../state/scene_file.ts";
import type { Catalogue } from "./door.ts";
import type { Jobs } from "./solve.worker.ts";

/** The jobs of a worker as asynchronous functions. */
export type Hand = {
  [Job in keyof Jobs]: (...inputs: Parameters<Jobs[Job]>) => Promise<Awaited<ReturnType<Jobs[Job]>>>;
};

/** The workers, and the core's methods, presets and boards. */
export interface Engine {
  catalogue: Catalogue;
  slots: [Hand, Hand];
  /** The worker for bounds, volumes and sequences. */
  slow: Hand;
  dispose(): void;
}

/** Numbers the messages to a worker, and resolves each promise with its reply. */
function hand(worker: Worker): Hand {
  const waiting = new Map<number, { resolve: (value: unknown) => void; reject: (error: Error) => void }>();
  let last = 0;
  worker.onmessage = ({ data: { id, result, refused } }) => {
    const { resolve, reject } = waiting.get(id)!;
    waiting.delete(id);
    if (refused === undefined) resolve(result);
    else reject(new Refusal(refused));
  };
  worker.onerror = (event) => {
    waiting.forEach(({ reject }) => reject(new Error(event.message || "a worker could not be started")));
    waiting.clear();
  };
  const ask = (job: string, inputs: unknown[]) =>
    new Promise((resolve, reject) => {
      last += 1;
      waiting.set(last, { resolve, reject });
      worker.postMessage({ id: last, job, inputs });
    });
  return new Proxy({} as Hand, { get: (_, job: string) => (...inputs: unknown[]) => ask(job, inputs) });
}

/** A small scene that each worker solves first, because the first solve is slow. */
const WARM = JSON.stringify(sceneOf({ ...initial, array: { preset: "paper20", tiles: [1, 1] }, points: [[0, 0, 0.15]] }, 0));

/** Starts the workers with the bytes of the WebAssembly module. */
export async function startEngine(makeWorker: () => Worker, wasm: BufferSource): Promise<Engine> {
  const workers = [makeWorker(), makeWorker(), makeWorker()];
  const [first, second, slow] = workers.map(hand);
  const { catalogue, module } = await first.setup(wasm, WARM);
  for (const other of [second, slow]) other.setup(module, WARM).catch(() => undefined);
  return {
    catalogue,
    slots: [first, second],
    slow,
    dispose: () => workers.forEach((worker) => worker.terminate()),
  };
}
