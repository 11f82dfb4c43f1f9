import { defineConfig } from "vite";

// Test files run one after the other: two browsers at once are too slow without a GPU.
export default defineConfig({
  test: { include: ["test/browser/*.test.ts"], fileParallelism: false, testTimeout: 120_000, hookTimeout: 120_000 },
} as object);
