import type { Route } from "@playwright/test";
import { alone, end, expect, idOf, rows, serve, test } from "./bench";
import { change } from "./sockets";

test("a page that waits for its server says so, and enters once it answers", async ({ page }) => {
  await alone(async (server) => {
    const waiting: Route[] = [];
    await page.route("**/api/v1/session", (route) => {
      waiting.push(route);
    });
    await page.goto(server.url);
    await expect(page.getByText("Waiting for the workbench ..")).toBeVisible({ timeout: 4000 });
    await waiting[0]?.abort();
    await expect(page.getByRole("alert")).toHaveText(
      "The workbench does not answer. This page tries again until it does.",
    );
    await page.unroute("**/api/v1/session");
    await Promise.all(waiting.slice(1).map((route) => route.abort()));
    // with the token that is in the address no more
    await rows(page);
  });
});

test("a lost workbench is said, old values are dashes, and it comes back by itself", async ({ page }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "press-1" }).click();
    await expect(page.locator(".value .main").first()).toHaveText(/\d/);
    server.process.kill("SIGSTOP");
    await expect(page.getByText(/Connection to the workbench lost \d+ s ago/)).toBeVisible();
    await expect(page.getByRole("button", { name: "STOP cannot reach" })).toBeVisible();
    // each badge in one line, and whole
    for (const width of [1366, 1024, 768, 400, 320]) {
      await page.setViewportSize({ width, height: 640 });
      const badges = await page.locator(".badge").evaluateAll((all) =>
        all.map((one) => ({
          cut: one.scrollWidth > one.clientWidth || one.getBoundingClientRect().top < 0,
          lines: Math.round(one.getBoundingClientRect().height / 20),
        })),
      );
      expect(badges, `${width}`).toEqual(Array(2).fill({ cut: false, lines: 1 }));
    }
    await page.setViewportSize({ width: 1366, height: 640 });
    for (const value of await page.locator(".value .main").allTextContents()) {
      expect(value).toBe("\u2013");
    }
    server.process.kill("SIGCONT");
    await expect(page.getByText(/Connection to the workbench lost/)).toBeHidden();
    await expect(page.locator(".value .main").first()).toHaveText(/\d/);
    await expect(page.getByText("WRITE", { exact: true })).toBeVisible();
    const address = new URL(server.url).host;
    await end(server);
    await expect(page.getByText(/Connection to the workbench lost/)).toBeVisible();
    const again = await serve("--demo", "--listen", address);
    try {
      await expect(page.getByText("Open the address that it printed last.")).toBeVisible();
    } finally {
      await end(again);
    }
  });
});

test("a page of another build says that it has to be loaded again, and takes no control", async ({ page, demo }) => {
  let build = "other";
  await change(page, "control", (message) => (message.type === "hello" ? { ...message, build } : message));
  await change(page, "live", (message) => (message.type === "hello" ? { ...message, build: "this" } : message));
  await page.goto(demo.url);
  await expect(page.getByText("The workbench has another version than this page.")).toBeVisible();
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/control`);
  await expect(page.locator("main").getByText("The workbench has another version than this page.")).toBeVisible();
  await expect(page.getByRole("button", { name: "Take control" })).toBeDisabled();
  build = "this";
  await page.getByRole("button", { name: "Reload" }).click();
  await expect(page.getByRole("button", { name: "Take control" })).toBeEnabled();
  await expect(page.getByText("another version")).toHaveCount(0);
});

test("a network that is back opens the control socket at once", async ({ page }) => {
  let tries = 0;
  let cut = false;
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    tries += 1;
    if (cut) socket.close();
    else socket.connectToServer();
  });
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    cut = true;
    await page.reload();
    // the pause before the next try is 2 s at least
    await expect.poll(() => tries).toBeGreaterThanOrEqual(5);
    const before = tries;
    cut = false;
    await page.evaluate(() => dispatchEvent(new Event("online")));
    await expect.poll(() => tries, { timeout: 1500 }).toBeGreaterThan(before);
  });
});
