import { defineConfig } from "@playwright/test";

export default defineConfig({
  testDir: "tests",
  outputDir: "../../../target/workbench/results",
  // one browser at a time, and a whole run in bounded time
  workers: 1,
  timeout: 60_000,
  globalTimeout: 300_000,
  expect: { timeout: 10_000 },
  reporter: [["list"]],
  use: {
    browserName: "chromium",
    viewport: { width: 1366, height: 640 },
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      // the tests run as root in namespaces of their own, where the sandbox of the browser has no place
      args: ["--no-sandbox", "--disable-gpu"],
    },
  },
});
