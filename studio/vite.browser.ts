import { defineConfig } from "vite";

// One browser after another: two at once starve each other where there is no GPU.
export default defineConfig({
  test: { include: ["test/browser/*.test.ts"], fileParallelism: false, testTimeout: 120_000, hookTimeout: 120_000 },
} as object);
