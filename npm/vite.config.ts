// Builds one module for Node and browsers, which loads midair.wasm from its own folder.
export default {
  root: import.meta.dirname,
  build: {
    lib: { entry: "index.ts", formats: ["es"], fileName: "index" },
    outDir: "dist",
    emptyOutDir: false,
    target: "es2022",
    assetsInlineLimit: 0,
    rollupOptions: { external: [/^node:/] },
  },
};
