import { defineConfig } from "@playwright/test";

export default defineConfig({
  testDir: process.env.BENCH ? "tests/bench" : "tests",
  // measurements are no tests: tools/web-bench
  testIgnore: process.env.BENCH ? [] : "**/bench/**",
  outputDir: "../../../target/workbench/results",
  // what measures how soon an axis rests has the computer for itself (tools/web-test)
  projects: process.env.BENCH
    ? [{ name: "bench" }]
    : [
        { name: "motion", testMatch: /control\.spec/ },
        { name: "rest", testIgnore: [/control\.spec/, "**/bench/**"] },
      ],
  workers: 1,
  timeout: 60_000,
  // a whole run in bounded time
  globalTimeout: process.env.BENCH ? 10_800_000 : 420_000,
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
