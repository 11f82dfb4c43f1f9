import { defineConfig } from "vite";

export default defineConfig({ test: { include: ["test/*.test.ts"], testTimeout: 120_000 } } as object);
