import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import type { Page } from "@playwright/test";
import { end, expect, idOfStation, program, serve, test, watch } from "./bench";

const NAME = "<img src=x onerror=\"document.title='run'\">";
const TYPE = "\u202e<script>document.title='run'</script>";
/** Calls that the station answers while four pages watch. Before, it has answered the others of its six lies. */
const CALLS = 4;
/** Memory that the server may take for all of that, in kB. */
const MEMORY = 32_000;

test("a station that lies is shown as text, and four pages, the server and another drive go on", async ({
  page,
  browser,
}) => {
  const ip = (...words: string[]) => execFileSync("ip", words, { stdio: "inherit" });
  ip("link", "add", "odd-here", "type", "veth", "peer", "name", "odd-there");
  ip("addr", "add", "192.168.96.1/24", "dev", "odd-here");
  ip("link", "set", "odd-here", "up");
  ip("link", "set", "odd-there", "up");
  const drive = spawn(program, ["simulate", "--name", "akd-9", "--ip", "192.168.96.9/24", "-i", "odd-there"], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  // both are there for the first search
  await once(drive.stdout, "data");
  const liar = spawn("python3", [join(import.meta.dirname, "station.py"), "odd-there", "192.168.96.66", NAME, TYPE], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  let calls = 0;
  createInterface({ input: liar.stdout }).on("line", () => {
    calls += 1;
  });
  const server = await serve("-i", "odd-here", "--listen", "127.0.0.1:0");
  const memory = () =>
    Number(/^VmRSS:\s+(\d+) kB/m.exec(readFileSync(`/proc/${server.process.pid}/status`, "utf8"))?.[1]);
  try {
    const troubles = watch(page);
    await page.goto(server.url);
    const row = page.getByRole("row").filter({ hasText: "<img src=x" });
    await expect(row).toBeVisible({ timeout: 30_000 });
    await expect(row).toContainText("<script>document.title='run'</script>");
    await expect(page.getByRole("row", { name: "akd-9" })).toContainText("no controller is connected", {
      timeout: 30_000,
    });
    const before = memory();
    const id = encodeURIComponent(await idOfStation(page, NAME));
    const others = await Promise.all(
      ["overview", "parameters", "telegram"].map(async (screen) => {
        const other = await (await browser.newContext()).newPage();
        await other.goto(server.url);
        await expect(other.getByRole("row").filter({ hasText: "<img src=x" })).toBeVisible();
        await other.goto(`${server.origin}/drives/${id}/${screen}`);
        return other;
      }),
    );
    const counted = calls;
    await expect.poll(() => calls - counted, { timeout: 40_000 }).toBeGreaterThanOrEqual(CALLS);
    expect(calls).toBeGreaterThanOrEqual(6);
    // why it is not read stands in its row, and nothing of its texts ran
    await expect(row).toContainText(/answer|read/);
    const akd = encodeURIComponent(await idOfStation(page, "akd-9"));
    const goesOn = async (one: Page) => {
      await expect(one).toHaveTitle(/profidrive workbench$/);
      expect(await one.locator("main img, main script").count()).toBe(0);
      // alive: a key opens what it opens, and the other drive is selected and read
      await one.keyboard.press("?");
      await expect(one.getByRole("dialog")).toBeVisible();
      await one.keyboard.press("Escape");
      await one.goto(`${server.origin}/drives/${akd}/overview`);
      await expect(one.locator(".sentence")).toContainText("no controller is connected");
      await expect(one.locator(".value .main").first()).toHaveText(/\d/);
    };
    await Promise.all([page, ...others].map(goesOn));
    expect(memory() - before).toBeLessThan(MEMORY);
    expect(troubles).toEqual([]);
    for (const other of others) await other.context().close();
  } finally {
    await end(server);
    liar.kill("SIGKILL");
    drive.kill("SIGKILL");
    ip("link", "del", "odd-here");
  }
});
