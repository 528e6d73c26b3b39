import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";

// a running server for `npm run dev`: PROFIDRIVE_SERVER=http://127.0.0.1:8934
const server = process.env.PROFIDRIVE_SERVER ?? "http://127.0.0.1:8934";

/** Limits of what a browser loads, compressed, in octets: of the first screen, and of all. */
const FIRST = 90_000;
const ALL = 200_000;

/** Fails a build that is too large. */
const limits: Plugin = {
  name: "limits",
  writeBundle(_, bundle) {
    const sizes = Object.entries(bundle).map(([name, file]) => {
      const content = file.type === "chunk" ? file.code : file.source;
      return { name, octets: gzipSync(content, { level: 9 }).length };
    });
    const sum = (all: typeof sizes) => all.reduce((octets, file) => octets + file.octets, 0);
    const first = sum(sizes.filter(({ name }) => name.startsWith("app.") || name === "index.html"));
    if (first > FIRST || sum(sizes) > ALL) {
      throw new Error(`the page is too large: ${first} octets at first, ${sum(sizes)} in all`);
    }
  },
};

export default defineConfig({
  plugins: [limits],
  // names without digests: the files are committed, and browsers compare tags
  build: {
    outDir: process.env.PROFIDRIVE_ASSETS ?? "../assets",
    emptyOutDir: false,
    target: "es2022",
    modulePreload: false,
    // styles are one file, so no code inserts any
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rolldownOptions: {
      output: {
        entryFileNames: "app.js",
        chunkFileNames: "[name].js",
        assetFileNames: (asset) => (asset.names[0]?.endsWith(".css") ? "app.css" : "[name][extname]"),
      },
    },
  },
  // the server compares origins; the proxy makes requests of its own
  server: { proxy: { "/api": { target: server, changeOrigin: true, headers: { origin: server } } } },
  test: { include: ["src/**/*.test.ts"] },
});
