import type { Route, WebSocketRoute } from "@playwright/test";
import { alone, expect, idOf, rows, test } from "./bench";
import { screens } from "./screens";
import { change } from "./sockets";

for (const [kind, sizes] of [
  [
    "each viewport",
    [
      [1366, 640],
      [1024, 700],
      [768, 950],
      [400, 800],
    ],
  ],
  // a window of 1366 and of 1280 px
  [
    "one that is magnified to 400 %",
    [
      [341, 192],
      [320, 256],
    ],
  ],
] as const) {
  test(`STOP and the content can be reached on each screen and in ${kind}`, async ({ entered: page }) => {
    for (const [name, path] of await screens(page)) {
      await page.goto(path);
      const stop = page.getByRole("button", { name: /^STOP/ });
      await expect(stop).toBeVisible();
      // with all that is loaded later
      await expect(page.locator("main h1")).toBeVisible();
      await expect(page.locator(".bars")).toHaveCount(0, { timeout: 30_000 });
      if (kind === "each viewport") {
        // and with what STOP adds
        await stop.click();
        await expect(page.locator(".band.stopped")).toContainText("was received");
      }
      for (const [width, height] of sizes) {
        await page.setViewportSize({ width, height });
        await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
        const seen = await stop.evaluate((button) => {
          const { x, y, width, height, right, bottom } = button.getBoundingClientRect();
          const hit = document.elementFromPoint(x + width / 2, y + height / 2);
          const inside = x >= 0 && y >= 0 && right <= innerWidth && bottom <= innerHeight;
          const { scrollWidth, clientWidth } = document.documentElement;
          // what scrolls: the rest of the height is that of the frame, of the screens and of STOP
          let free = 0;
          for (let at = 0; at < 100; at += 1) {
            const place = document.elementFromPoint(innerWidth / 4, ((at + 0.5) / 100) * innerHeight);
            const fixed = place?.closest(".top, nav, .notices, .stop");
            if (!fixed || getComputedStyle(fixed).position === "static") free += 1;
          }
          return { inside, height, hit: hit === button, sideways: scrollWidth > clientWidth, free };
        });
        expect(seen, `${name} ${width}x${height}`).toMatchObject({ inside: true, hit: true, sideways: false });
        // a window of a phone has little beside what STOP has to say
        expect(seen.free, `${name} ${width}x${height}`).toBeGreaterThan(kind === "each viewport" ? 20 : 50);
        expect(seen.height).toBeGreaterThanOrEqual(44);
      }
    }
  });
}

test("notices and STOP of a magnified page do not cover each other", async ({ page }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.setViewportSize({ width: 341, height: 192 });
    await page.getByRole("button", { name: /^STOP/ }).click();
    const reset = page.getByRole("button", { name: "Reset STOP" });
    await expect(reset).toBeInViewport({ ratio: 1 });
    const box = async (name: string) => {
      const { y = 0, height = 0 } = (await page.locator(name).boundingBox()) ?? {};
      return { top: y, bottom: y + height };
    };
    // at the beginning nothing is below a notice, and it stays in sight further down
    await page.evaluate(() => scrollTo(0, 0));
    expect((await box(".notices")).bottom).toBeLessThanOrEqual((await box(".selector")).top);
    for (const down of [0, 10_000]) {
      await page.evaluate((down) => scrollTo(0, down), down);
      await expect(reset).toBeInViewport({ ratio: 1 });
      expect((await box(".notices")).bottom).toBeLessThanOrEqual((await box(".stop")).top);
    }
    await reset.click();
    await expect(reset).toHaveCount(0);
  });
});

test("STOP says honestly that there is nothing to stop, by mouse and keys", async ({ entered: page }) => {
  const stop = page.getByRole("button", { name: "STOP not available" });
  await expect(page.getByText("This server controls no axis. Use the emergency stop of the machine.")).toBeVisible();
  const answer = page.getByRole("alert");
  const count = async () => ((await (await page.request.get("/api/v1/server")).json()) as { stops: number }).stops;
  const before = await count();
  await stop.click();
  await expect(answer).toHaveText(`STOP ${before + 1} was received. It stopped no axis: this server controls none.`);
  await page.keyboard.press("Control+Space");
  await expect(answer).toContainText(`STOP ${before + 2} `);
  await page.keyboard.press("Escape");
  await page.keyboard.press("Escape");
  await expect(answer).toContainText(`STOP ${before + 3} `);
});

for (const way of ["socket", "request"] as const) {
  test(`STOP to a server that hangs is reported at once, sent by ${way}`, async ({ page }) => {
    if (way === "request") await page.routeWebSocket("**/api/v1/control", (socket) => socket.close());
    await alone(async (server) => {
      await page.goto(server.url);
      await rows(page);
      server.process.kill("SIGSTOP");
      await expect(page.getByText(/Connection to the workbench lost/)).toBeVisible();
      await page.getByRole("button", { name: "STOP cannot reach" }).click();
      const notice = page.locator(".band.stopped");
      await expect(notice).toHaveText(/^STOP was sent/, { timeout: 2000 });
      // a request ends only after 5 s
      const emergency = "STOP was sent and is not confirmed. Use the emergency stop of the machine.";
      await expect(notice).toHaveText(emergency, { timeout: 4000 });
      server.process.kill("SIGCONT");
      await expect(notice).toContainText("was received");
    });
  });
}

test("STOP that its connection swallows is sent once more by a request", async ({ page }) => {
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      if (!String(message).includes('"stop"')) server.send(message);
    });
  });
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("button", { name: /^STOP/ }).click();
    await expect(page.locator(".band.stopped")).toContainText("was received");
  });
});

test("a STOP of which no frame went out is not confirmed", async ({ page }) => {
  await alone(async (server) => {
    let drive = "";
    await change(page, "control", (message) =>
      message.type === "stopped"
        ? { ...message, confirmed: false, axes: [{ drive, by: "off3", state: "unconfirmed", sent_unix_ms: null }] }
        : message,
    );
    await page.goto(server.url);
    await rows(page);
    drive = await idOf(page, "axis-1");
    await page.getByRole("button", { name: /^STOP/ }).click();
    await expect(page.locator(".band.stopped")).toHaveText(
      "STOP 1 was received and is not confirmed. axis-1: no frame was sent. Use the emergency stop of the machine.",
    );
  });
});

test("STOP stops a drive that turns without a controller by its parameter, and says what became of it", async ({
  page,
  demo,
}) => {
  let offer: object = { means: "parameter", parameter: "DRV.STOP", reason: null, controller: null };
  await change(page, "live", (message) => {
    if (message.topic !== "network") return message;
    const data = message.data as { stations: { name: string; status: { actions: object[] } | null }[] };
    const stations = data.stations.map((one) =>
      one.name !== "axis-1" || one.status === null
        ? one
        : {
            ...one,
            stop: offer,
            status: { ...one.status, actions: [{ action: "stop", arguments: ["axis-1"], command: null }] },
          },
    );
    return { ...message, data: { ...data, stations } };
  });
  let answer: { status: number; json: object } = { status: 200, json: { at_rest: true } };
  const asked: string[] = [];
  await page.route("**/api/v1/drives/*/stop", (route) => {
    asked.push(route.request().method());
    return route.fulfill(answer);
  });
  await page.goto(demo.url);
  await page.getByRole("link", { name: "axis-1", exact: true }).click();
  await expect(page.getByText("No controller has axis-1: its parameter DRV.STOP stops it.")).toBeVisible();
  const notice = page.locator(".band.stopped");
  await page.locator(".frame").getByRole("button", { name: "STOP axis-1 (by parameter)" }).click();
  await expect(notice).toContainText("axis-1 is at rest.");
  // beside what the library advises, and by a key
  answer = { status: 409, json: { kind: "refused", detail: "plc-1 has the drive", details: [] } };
  await page.locator("main").getByRole("button", { name: "STOP axis-1 (by parameter)" }).click();
  await expect(notice).toContainText(
    "axis-1 was not stopped: plc-1 has the drive. Use the emergency stop of the machine.",
  );
  await page.keyboard.press("Control+Space");
  await expect.poll(() => asked).toEqual(["POST", "POST", "POST"]);
  offer = { means: "none", parameter: null, reason: "needs_interface", controller: null };
  await expect(page.getByRole("button", { name: "STOP not available" })).toBeVisible();
  await expect(page.locator("#stop-why")).toContainText("for which the server needs a network interface");
  await page.getByRole("button", { name: "Reset STOP" }).click();
});

test("one press stops the axes of the server and the selected drive without a controller, however long it ramps", async ({
  page,
}) => {
  let means = "none";
  await change(page, "live", (message) => {
    if (message.topic !== "network") return message;
    const data = message.data as { stations: { name: string; stop: object }[] };
    const stop = { means, parameter: "DRV.STOP", reason: null, controller: null };
    const stations = data.stations.map((one) => (one.name === "press-1" ? { ...one, stop } : one));
    return { ...message, data: { ...data, stations } };
  });
  const waiting: Route[] = [];
  await page.route("**/api/v1/drives/*/stop", (route) => {
    waiting.push(route);
  });
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    const why = page.locator("#stop-why");
    means = "parameter";
    await expect(why).toContainText("press-1 turns without a controller. Select it to stop it.");
    await expect(why).not.toContainText("controls no axis");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/control`);
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
    await expect(page.getByRole("button", { name: "STOP axis-1", exact: true })).toBeVisible();
    await expect(why).toContainText("press-1 turns without a controller. Select it to stop it.");
    await page.locator(".selector select").selectOption({ label: "press-1" });
    const stop = page.getByRole("button", { name: "STOP axis-1, press-1 (by parameter)" });
    await stop.click();
    const notice = page.locator(".band.stopped");
    await expect(notice).toContainText("Stopping press-1 ..");
    await expect(notice).toContainText("axis-1: was not in operation");
    await expect(why).toContainText("Stopping press-1 ..");
    // the controller that it has meanwhile is this server
    means = "none";
    await expect.poll(() => waiting.length).toBe(1);
    await stop.click();
    await expect.poll(() => waiting.length).toBe(2);
    // a reset of the STOP before it is refused
    await expect(notice).toContainText("STOP 2 is confirmed.");
    await page.getByRole("button", { name: "Reset STOP" }).click();
    await expect(notice).toHaveText("Stopping press-1 ..");
    await expect(page.locator(".band.happened")).toHaveText(/^Reset: STOP 2 \(this session\)/);
    await stop.click();
    await expect.poll(() => waiting.length).toBe(3);
    await expect(notice).toContainText("STOP 3 is confirmed.");
    for (const route of waiting) await route.fulfill({ json: { at_rest: true } });
    await expect(notice).toContainText("press-1 is at rest.");
    await expect(notice).not.toContainText("Stopping");
    await expect(page.getByRole("button", { name: "STOP axis-1", exact: true })).toBeVisible();
  });
});

test("a page that reconnects names the STOP that was pressed meanwhile", async ({ page }) => {
  let cut = false;
  const sockets: WebSocketRoute[] = [];
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    sockets.push(socket);
    if (cut) socket.close();
    else socket.connectToServer();
  });
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("button", { name: /^STOP/ }).click();
    await expect(page.getByText("STOP 1 was pressed by this session.")).toBeVisible();
    cut = true;
    for (const socket of sockets) await socket.close();
    expect(await page.evaluate(async () => (await fetch("/api/v1/stop", { method: "POST" })).status)).toBe(200);
    cut = false;
    await page.evaluate(() => dispatchEvent(new Event("online")));
    await expect(page.getByText("STOP 2 was pressed. Nothing is enabled")).toBeVisible();
    await expect(page.getByText("STOP 1 was pressed")).toHaveCount(0);
  });
});
