import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";

// a running server for `npm run dev`: PROFIDRIVE_SERVER=http://127.0.0.1:8934
const server = process.env.PROFIDRIVE_SERVER ?? "http://127.0.0.1:8934";

/** The packages that are a part of the page. */
const LINKED = ["preact", "@preact/signals", "@preact/signals-core", "preact-iso", "uplot"];

/** Adds their licences, which ask to stand beside each copy; fails where another package is linked. */
const licences: Plugin = {
  name: "licences",
  generateBundle(_, bundle) {
    for (const file of Object.values(bundle)) {
      for (const [id, { renderedLength }] of Object.entries(file.type === "chunk" ? file.modules : {})) {
        const name = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(id)?.[1];
        if (name !== undefined && renderedLength > 0 && !LINKED.includes(name)) {
          throw new Error(`${name} is linked and not among the licences of vite.config.ts`);
        }
      }
    }
    const texts = LINKED.map((name) => {
      const { version } = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8"));
      return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n`;
    });
    this.emitFile({ type: "asset", fileName: "licences.txt", source: texts.join(`\n${"-".repeat(80)}\n`) });
  },
};

/** Limits of what a browser loads, compressed, in octets: of the first screen, and of all. */
const FIRST = 90_000;
const ALL = 200_000;

/** What a browser loads to show Network, Overview and Control. */
const FIRST_FILES = ["index.html", "app.js", "app.css", "screens.js"];

/** Fails a build that is too large. */
const limits: Plugin = {
  name: "limits",
  writeBundle(_, bundle) {
    const sizes = Object.entries(bundle).map(([name, file]) => {
      const content = file.type === "chunk" ? file.code : file.source;
      return { name, octets: gzipSync(content, { level: 9 }).length };
    });
    const sum = (all: typeof sizes) => all.reduce((octets, file) => octets + file.octets, 0);
    // Overview and Control are in the second script, which the first screen loads too
    const first = sum(sizes.filter(({ name }) => FIRST_FILES.includes(name)));
    const absent = FIRST_FILES.filter((name) => !sizes.some((file) => file.name === name));
    if (absent.length > 0) throw new Error(`not among the files: ${absent.join(", ")}`);
    if (first > FIRST || sum(sizes) > ALL) {
      throw new Error(`the page is too large: ${first} octets at first, ${sum(sizes)} in all`);
    }
  },
};

export default defineConfig({
  plugins: [licences, limits],
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
  worker: { format: "es", rolldownOptions: { output: { entryFileNames: "scope-worker.js" } } },
  // the server compares origins; the proxy makes requests of its own
  server: { proxy: { "/api": { target: server, changeOrigin: true, headers: { origin: server } } } },
  test: { include: ["src/**/*.test.ts"] },
});
