import { execFileSync, spawn, spawnSync } from "node:child_process";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { end, expect, idOfStation, pictures, program, serve, test } from "./bench";

/** What belongs to a plant is neither in the menu nor in the interface, whatever a request has in its body. */
async function noPlant(page: Page): Promise<void> {
  await expect(page.getByRole("link", { name: "Log", exact: true })).toBeVisible();
  await expect(page.getByRole("link", { name: "Virtual drives" })).toHaveCount(0);
  const answers = await page.evaluate(async () => {
    const found: string[] = [];
    const headers = { "Content-Type": "application/json" };
    const right = JSON.stringify({ drive: "x", event: "sto=on", seconds: null });
    for (const path of ["inject", "check", "restart", "clock"]) {
      for (const body of [right, "{}", "{", ""]) {
        const answer = await fetch(`/api/v1/plant/${path}`, { method: "POST", headers, body });
        found.push(`${answer.status} ${((await answer.json()) as { kind: string }).kind}`);
      }
    }
    for (const path of ["drives", "scenario", "drives/x/events"]) {
      found.push(`${(await fetch(`/api/v1/plant/${path}`)).status} simulation`);
    }
    return [...new Set(found)];
  });
  expect(answers).toEqual(["404 simulation"]);
}

// the namespace of the tests has no network but this cable: this end has an address, a virtual drive is at the other
test("drives given by their addresses are read, and the page says what a search needs", async ({ page }) => {
  const ip = (...words: string[]) => execFileSync("ip", words, { stdio: "inherit" });
  ip("link", "add", "here", "type", "veth", "peer", "name", "there");
  ip("addr", "add", "192.168.99.1/24", "dev", "here");
  ip("link", "set", "here", "up");
  ip("link", "set", "there", "up");
  const drive = spawn(program, ["simulate", "-q", "--name", "akd-9", "--ip", "192.168.99.9/24", "-i", "there"], {
    stdio: ["ignore", "ignore", "inherit"],
  });
  const server = await serve("--ip", "192.168.99.9", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await expect(page.getByText("A search needs a network interface: start with -i")).toBeVisible();
    const row = page.getByRole("row", { name: "192.168.99.9" });
    await expect(row).toContainText("no controller is connected", { timeout: 30_000 });
    await expect(row).toContainText("V1.17.0");
    await expect(page.getByText("SIMULATION")).toHaveCount(0);
    await expect(page.getByRole("columnheader", { name: "Shaft" })).toHaveCount(0);
    await row.getByRole("link").click();
    await expect(page.locator(".sentence")).toContainText("no controller is connected");
    // the command that is copied shows the same
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.getByRole("button", { name: "Copy as command" }).click();
    await expect(page.getByText("Copied.")).toBeVisible();
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    expect(copied).toBe("profidrive status 192.168.99.9");
    const env = { ...process.env, PROFIDRIVE_INTERFACE: "here" };
    const ran = spawnSync(program, copied.split(" ").slice(1), { encoding: "utf8", env });
    expect(ran.stdout).toContain("no controller is connected");
    await noPlant(page);
    await end(server);
    // and neither does a server on an interface, which has the same drive
    const other = await serve("-i", "here", "--listen", "127.0.0.1:0");
    try {
      await page.goto(other.url);
      await expect(page.getByRole("row", { name: "akd-9" })).toContainText("no controller is connected", {
        timeout: 30_000,
      });
      await noPlant(page);
      // the file of the page is that of the program, in each octet
      const id = await idOfStation(page, "akd-9");
      await page.goto(`${other.origin}/drives/${encodeURIComponent(id)}/compare`);
      await page.getByRole("button", { name: "Back up akd-9" }).click();
      const link = page.getByRole("link", { name: "Download" });
      await expect(link).toBeVisible({ timeout: 30_000 });
      const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
      const file = join(pictures, "program.backup");
      rmSync(file, { force: true });
      execFileSync(program, ["backup", "akd-9", "-o", file], { env, stdio: "ignore" });
      const [theirs, own] = [readFileSync(await download.path()), readFileSync(file)];
      expect(own.length).toBeGreaterThan(10_000);
      expect(theirs.equals(own)).toBe(true);
    } finally {
      await end(other);
    }
  } finally {
    await end(server);
    drive.kill("SIGKILL");
    ip("link", "del", "here");
  }
});

test("STOP ramps down and releases a drive that lost its controller, and a second press turns the ramp into its quick stop", async ({
  page,
}) => {
  const ip = (...words: string[]) => execFileSync("ip", words, { stdio: "inherit" });
  ip("link", "add", "here", "type", "veth", "peer", "name", "there");
  ip("addr", "add", "192.168.99.1/24", "dev", "here");
  ip("link", "set", "here", "up");
  ip("link", "set", "there", "up");
  const model = ["--name", "vlt-9", "--model", "vlt", "--ip", "192.168.99.9/24"];
  const drive = spawn(program, ["simulate", "-q", ...model, "-i", "there"], { stdio: ["ignore", "ignore", "inherit"] });
  const env = { ...process.env, PROFIDRIVE_INTERFACE: "here" };
  const ask = (...words: string[]) => spawnSync(program, words, { encoding: "utf8", env }).stdout;
  try {
    await expect.poll(() => ask("status", "vlt-9", "--short")).toContain("vlt-9");
    const controller = spawn(program, ["run", "vlt-9", "--velocity", "300rpm", "--may-run-on"], {
      stdio: "ignore",
      env,
    });
    await expect.poll(() => ask("status", "vlt-9", "--short")).toContain("S4");
    controller.kill("SIGKILL");
    const server = await serve("-i", "here", "--listen", "127.0.0.1:0");
    try {
      await page.goto(server.url);
      await expect(page.locator("#stop-why")).toContainText("vlt-9 turns without a controller. Select it to stop it.");
      await page.getByRole("link", { name: "vlt-9", exact: true }).click();
      const stop = page.locator(".frame").getByRole("button", { name: "STOP vlt-9 (by control word)" });
      const notice = page.locator(".band.stopped");
      await stop.click();
      await expect(notice).toContainText("Press STOP again for its quick stop.");
      await stop.click();
      await expect(notice).toContainText("vlt-9 is at rest.", { timeout: 30_000 });
      await expect(notice).not.toContainText("was not stopped");
      expect(ask("status", "vlt-9", "--short")).not.toContain("S4");
    } finally {
      await end(server);
    }
  } finally {
    ip("link", "del", "here");
    drive.kill("SIGKILL");
  }
});
