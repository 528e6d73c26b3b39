import { defineConfig } from "@playwright/test";

export default defineConfig({
  testDir: process.env.BENCH ? "tests/bench" : "tests",
  // measurements are no tests: tools/web-bench
  testIgnore: process.env.BENCH ? [] : "**/bench/**",
  outputDir: "../../../target/workbench/results",
  // one browser at a time, and a whole run in bounded time
  workers: 1,
  timeout: 60_000,
  globalTimeout: process.env.BENCH ? 1_500_000 : 360_000,
  expect: { timeout: 10_000 },
  reporter: [["list"]],
  use: {
    // an action that never becomes possible names what it waits for
    actionTimeout: 30_000,
    browserName: "chromium",
    viewport: { width: 1366, height: 640 },
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      // the tests run as root in namespaces of their own, where the sandbox of the browser has no place
      args: ["--no-sandbox", "--disable-gpu"],
    },
  },
});
