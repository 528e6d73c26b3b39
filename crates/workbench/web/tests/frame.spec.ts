import { chmodSync, copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Locator, Page, Route, WebSocketRoute } from "@playwright/test";
import { end, expect, idOf, pictures, rows, serve, serveIn, test } from "./bench";
import { alone, open, operate, options, underControl } from "./moving";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

async function screens(page: Page): Promise<[string, string][]> {
  const answer = await page.request.get("/api/v1/stations");
  const { stations } = (await answer.json()) as { stations: { id: string; name: string | null }[] };
  const named = (name: string) => {
    const id = stations.find((one) => one.name === name)?.id;
    if (id === undefined) throw new Error(`no station is called ${name}`);
    return encodeURIComponent(id);
  };
  return [
    ["network", "/network"],
    ["overview", `/drives/${named("fan-1")}/overview`],
    ["overview-fault", `/drives/${named("axis-2")}/overview`],
    ["overview-watch", `/drives/${named("press-1")}/overview`],
    ["overview-none", "/drives/none/overview"],
    ["faults", `/drives/${named("axis-2")}/faults`],
    ["faults-none", "/drives/none/faults"],
    ["control", `/drives/${named("axis-1")}/control`],
    ["control-none", "/drives/none/control"],
    ["scope", `/drives/${named("press-1")}/scope`],
    ["parameters", `/drives/${named("axis-1")}/parameters`],
    ["parameters-none", "/drives/none/parameters"],
    ["compare", `/drives/${named("axis-1")}/compare`],
    ["virtual", "/virtual"],
    ["machine", `/drives/${named("press-1")}/machine`],
    ["telegram", `/drives/${named("press-1")}/telegram`],
    ["capture", "/capture"],
    ["log", "/log"],
  ];
}

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

test("frame and navigation are not cut, and high contrast shows what cannot be pressed", async ({ entered: page }) => {
  await page.goto("/network");
  await rows(page);
  const line = page.getByText("Select a drive to see its state.");
  for (const [width, height] of [
    [1366, 640],
    [1024, 700],
    [768, 950],
  ] as const) {
    await page.setViewportSize({ width, height });
    expect(await line.evaluate((one) => one.scrollWidth - one.clientWidth), `${width}`).toBeLessThanOrEqual(0);
  }
  await page.setViewportSize({ width: 1366, height: 640 });
  const theme = page.getByRole("combobox", { name: "Theme" });
  await expect(theme).toBeInViewport({ ratio: 1 });
  await theme.selectOption("contrast");
  await expect(page.getByRole("button", { name: "Back up 0" })).toHaveCSS("border-style", "dashed");
  await expect(page.getByRole("button", { name: "Search now" })).toHaveCSS("border-style", "solid");
});

test("what is chosen is seen with the colours of the system", async ({ entered: page }) => {
  await page.emulateMedia({ forcedColors: "active" });
  const outlined = (of: Locator) => of.evaluate((one) => getComputedStyle(one).outlineStyle);
  expect(await outlined(page.locator("nav a[aria-current]"))).toBe("solid");
  await page.keyboard.press("Control+k");
  await page.keyboard.type("axis");
  expect(await outlined(page.locator(".palette [role=option][aria-selected=true]"))).toBe("solid");
});

test("notices and STOP of a magnified page do not cover each other", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    await page.setViewportSize({ width: 341, height: 192 });
    await page.getByRole("button", { name: /^STOP/ }).click();
    const reset = page.getByRole("button", { name: "Reset STOP" });
    await expect(reset).toBeInViewport({ ratio: 1 });
    const [notices, stop] = [await page.locator(".notices").boundingBox(), await page.locator(".stop").boundingBox()];
    expect((notices?.y ?? 0) + (notices?.height ?? 0)).toBeLessThanOrEqual(stop?.y ?? 0);
    await reset.click();
    await expect(reset).toHaveCount(0);
  } finally {
    await end(server);
  }
});

test("a page that waits for its server says so, and enters once it answers", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
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
  } finally {
    await end(server);
  }
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

test("the browser that the program starts is let in once", async ({ page, browser }) => {
  const folder = mkdtempSync(join(tmpdir(), "profidrive-open-"));
  const argument = join(folder, "argument");
  // in place of a desktop
  writeFileSync(join(folder, "xdg-open"), `#!/bin/sh\necho "$1" >${argument}.new && mv ${argument}.new ${argument}\n`);
  chmodSync(join(folder, "xdg-open"), 0o755);
  const path = `${folder}:${process.env.PATH}`;
  const server = await serveIn({ PATH: path }, "--demo", "--open", "--listen", "127.0.0.1:0");
  try {
    await expect.poll(() => existsSync(argument)).toBe(true);
    const url = readFileSync(argument, "utf8").trim();
    expect(url).not.toBe(server.url);
    await page.goto(url);
    await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
    await expect(page.getByRole("button", { name: "Search now" })).toBeEnabled();
    const other = await browser.newContext();
    const second = await other.newPage();
    await second.goto(url);
    await expect(second.getByRole("alert")).toContainText("The workbench refused");
    await other.close();
  } finally {
    await end(server);
    rmSync(folder, { recursive: true });
  }
});

test("a server that is read-only offers no change", async ({ page }) => {
  const server = await serve("--demo", "--read-only", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    await expect(page.getByText("READ-ONLY")).toBeVisible();
    await expect(page.getByRole("button", { name: "Search now" })).toHaveCount(0);
  } finally {
    await end(server);
  }
});

test("a view link looks and stops", async ({ browser, demo }) => {
  const context = await browser.newContext({ baseURL: demo.origin });
  const page = await context.newPage();
  await page.goto(demo.viewUrl);
  await rows(page);
  await expect(page.getByText("VIEW LINK")).toBeVisible();
  await page.getByRole("button", { name: /^STOP/ }).click();
  await expect(page.getByRole("alert")).toContainText("was received");
  await context.close();
});

for (const theme of ["light", "dark", "contrast"] as const) {
  // longer words take the room that they take, in whatever colours
  for (const lang of theme === "light" ? ["", "?lang=xx"] : [""]) {
    test(`axe finds nothing: ${theme} ${lang}`, async ({ entered: page }) => {
      if (theme === "contrast") await page.getByRole("combobox", { name: "Theme" }).selectOption("contrast");
      else await page.emulateMedia({ colorScheme: theme });
      for (const [name, path] of await screens(page)) {
        // without longer words they were looked at
        if (lang !== "" && name.endsWith("-none")) continue;
        await page.goto(path + lang);
        await expect(page.locator("main h1")).toBeVisible();
        await expect(page.locator(".bars")).toHaveCount(0, { timeout: 30_000 });
        await expect(page.getByRole("option").filter({ hasText: "axis-1" }).first()).toBeAttached();
        await expect(page.getByText(/(Connecting|Waiting for the first values) \.\./)).toHaveCount(0);
        // by the protocol of the browser, which the policy of the page does not bind
        await page.evaluate(axe);
        // its layout is that of the others
        const sizes = [[1366, 768] as const, ...(theme === "contrast" ? [] : [[768, 950] as const])];
        for (const [width, height] of sizes) {
          await page.setViewportSize({ width, height });
          await page.screenshot({ path: join(pictures, `${name}-${theme}${lang ? "-long" : ""}-${width}.png`) });
          const violations = await page.evaluate(async () => {
            const found = await (window as unknown as { axe: { run(): Promise<{ violations: unknown[] }> } }).axe.run();
            return found.violations;
          });
          expect(violations, `${name} ${width}`).toEqual([]);
        }
      }
    });
  }
}

/** What axe finds on the page as it is. */
async function violations(page: Page): Promise<unknown[]> {
  return page.evaluate(async () => {
    const { axe } = window as unknown as { axe: { run(): Promise<{ violations: unknown[] }> } };
    return (await axe.run()).violations;
  });
}

for (const theme of ["light", "dark"] as const) {
  test(`axe finds nothing in control, after STOP, in dialogs and in what is unfolded: ${theme}`, async ({ page }) => {
    await alone(async (server) => {
      await page.emulateMedia({ colorScheme: theme });
      await open(page, server.url, "axis-1");
      await expect(page.getByRole("button", { name: "Take control" })).toBeEnabled();
      await page.evaluate(axe);
      await options(page);
      expect(await violations(page), "options").toEqual([]);
      await underControl(page, async () => {
        await operate(page);
        expect(await violations(page), "in control").toEqual([]);
        // axe has not kept the page from its beats
        await expect(page.getByText("IN CONTROL")).toBeVisible({ timeout: 1000 });
        await expect(page.getByRole("button", { name: "Release" })).toBeVisible({ timeout: 1000 });
        await page.keyboard.press("Control+Space");
        await expect(page.getByText(/STOP \d+ was pressed by this session/)).toBeVisible();
      });
      expect(await violations(page), "after STOP").toEqual([]);
      for (const [key, dialog] of [
        ["Control+k", page.locator(".palette")],
        ["?", page.getByRole("dialog", { name: "Keys" })],
      ] as const) {
        await page.keyboard.press(key);
        await expect(dialog).toBeVisible();
        expect(await violations(page), key).toEqual([]);
        await page.keyboard.press("Escape");
        await expect(dialog).toHaveCount(0);
      }
      for (const screen of ["Telegram", "State machine", "Virtual drives"]) {
        await page.getByRole("link", { name: screen, exact: true }).click();
        await expect(page.locator("main h1")).toBeVisible();
        await expect(page.locator(".bars")).toHaveCount(0);
        for (const summary of await page.locator("main summary").all()) await summary.click();
        await expect(page.locator("main details[open]").first()).toBeVisible();
        expect(await violations(page), screen).toEqual([]);
      }
    });
  });
}

test("the keyboard reaches everything on each screen, with a visible focus", async ({ entered: page }) => {
  test.setTimeout(120_000);
  for (const [name, path] of await screens(page)) {
    if (name.includes("-")) continue;
    // the log may be long
    await page.goto(name === "log" ? `${path}#text=no+such+text` : path);
    await expect(page.locator("main h1"), name).toBeVisible();
    await expect(page.locator(".bars"), name).toHaveCount(0, { timeout: 30_000 });
    const count = await page.evaluate(() => {
      const reached = new Set<Element>();
      const ringless: string[] = [];
      // a list that makes its rows while one goes through them has a test of its own
      const wanted = () =>
        [
          ...document.querySelectorAll("a[href], button:enabled, select:enabled, input:enabled, textarea, summary"),
        ].filter((one) => one.checkVisibility() && !one.closest("[data-key], [tabindex='-1']"));
      document.addEventListener("focusin", ({ target }) => {
        const one = target as HTMLElement;
        reached.add(one);
        const { outlineStyle, outlineWidth } = getComputedStyle(one);
        if (outlineStyle === "none" || outlineWidth === "0px") ringless.push(one.outerHTML.slice(0, 120));
      });
      Object.assign(window, {
        walked: () => ({
          ringless,
          missed: wanted()
            .filter((one) => !reached.has(one))
            .map((one) => one.outerHTML.slice(0, 120)),
        }),
      });
      return wanted().length;
    });
    const walked = () =>
      page.evaluate(() => (window as unknown as { walked(): { ringless: string[]; missed: string[] } }).walked());
    for (let press = 0; press < count + 10; press += 1) await page.keyboard.press("Tab");
    // rows between, whose number is that of the list
    for (let press = 0; press < 100 && (await walked()).missed.length > 0; press += 1) {
      await page.keyboard.press("Tab");
    }
    expect(await walked(), name).toEqual({ ringless: [], missed: [] });
  }
});

test("keys lead to screens, drives and fields, and can be switched off", async ({ entered: page }) => {
  await page.keyboard.press("g");
  await page.keyboard.press("o");
  await expect(page.getByText("Select a drive to see why it does not run.")).toBeVisible();
  await page.keyboard.press("g");
  await page.keyboard.press("n");
  await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
  // the list of keys switches them off, but for STOP
  await page.keyboard.press("?");
  const keys = page.getByRole("dialog", { name: "Keys" });
  await expect(keys.getByRole("row", { name: "g n Network" })).toBeVisible();
  // the keys of STOP are in sight, wherever the focus is
  await expect(keys.getByRole("row", { name: "Ctrl+Space STOP, everywhere" })).toBeInViewport({ ratio: 1 });
  await keys.getByRole("checkbox").uncheck();
  await page.keyboard.press("Escape");
  await expect(keys).toHaveCount(0);
  await page.keyboard.press("Control+k");
  await page.keyboard.press("g");
  await page.keyboard.press("l");
  await expect(page.getByRole("heading", { level: 1, name: "Network" })).toBeVisible();
  await page.getByRole("button", { name: "Keys ?" }).press("Enter");
  await keys.getByRole("checkbox").check();
  await keys.getByRole("button", { name: "Close" }).click();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("axis-1");
  await expect(page.getByRole("option", { name: "axis-1: Overview" })).toHaveAttribute("aria-selected", "true");
  await page.keyboard.press("Enter");
  await expect(page.locator(".why-not")).toBeVisible();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("log");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("heading", { level: 1, name: "Log" })).toBeVisible();
  await page.keyboard.press("/");
  await expect(page.getByRole("searchbox", { name: "Search" })).toBeFocused();
});

test("a lost workbench is said, old values are dashes, and it comes back by itself", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
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
  } finally {
    await end(server);
  }
});

for (const way of ["socket", "request"] as const) {
  test(`STOP to a server that hangs is reported at once, sent by ${way}`, async ({ page }) => {
    if (way === "request") await page.routeWebSocket("**/api/v1/control", (socket) => socket.close());
    const server = await serve("--demo", "--listen", "127.0.0.1:0");
    try {
      await page.goto(server.url);
      await rows(page);
      server.process.kill("SIGSTOP");
      await expect(page.getByText(/Connection to the workbench lost/)).toBeVisible();
      await page.getByRole("button", { name: "STOP cannot reach" }).click();
      const notice = page.locator(".band.stopped");
      await expect(notice).toHaveText(/^STOP was sent/, { timeout: 400 });
      // a request ends only after 5 s
      const emergency = "STOP was sent and is not confirmed. Use the emergency stop of the machine.";
      await expect(notice).toHaveText(emergency, { timeout: 1500 });
      server.process.kill("SIGCONT");
      await expect(notice).toContainText("was received");
    } finally {
      await end(server);
    }
  });
}

test("STOP that its connection swallows is sent once more by a request", async ({ page }) => {
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      if (!String(message).includes('"stop"')) server.send(message);
    });
  });
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("button", { name: /^STOP/ }).click();
    await expect(page.locator(".band.stopped")).toContainText("was received");
  } finally {
    await end(server);
  }
});

/** Changes the messages of a socket on their way to the page. */
async function change(page: Page, socket: "live" | "control", of: (message: Record<string, unknown>) => unknown) {
  await page.routeWebSocket(`**/api/v1/${socket}`, (route) => {
    const server = route.connectToServer();
    server.onMessage((text) => route.send(typeof text === "string" ? JSON.stringify(of(JSON.parse(text))) : text));
  });
}

test("a STOP of which no frame went out is not confirmed", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
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
  } finally {
    await end(server);
  }
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
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
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
  } finally {
    await end(server);
  }
});

test("a page that reconnects names the STOP that was pressed meanwhile", async ({ page }) => {
  let cut = false;
  const sockets: WebSocketRoute[] = [];
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    sockets.push(socket);
    if (cut) socket.close();
    else socket.connectToServer();
  });
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
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
  } finally {
    await end(server);
  }
});

test("a network that is back opens the control socket at once", async ({ page }) => {
  let tries = 0;
  let cut = false;
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    tries += 1;
    if (cut) socket.close();
    else socket.connectToServer();
  });
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    cut = true;
    await page.reload();
    // the pause before the next try is 2 s at least
    await expect.poll(() => tries).toBeGreaterThanOrEqual(5);
    const before = tries;
    cut = false;
    await page.evaluate(() => dispatchEvent(new Event("online")));
    await expect.poll(() => tries, { timeout: 1500 }).toBe(before + 1);
  } finally {
    await end(server);
  }
});

test("the selected drive stays selected on screens of all drives", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.getByRole("heading", { name: "press-1" })).toBeVisible();
  for (const screen of ["Log", "Capture", "Virtual drives", "Network"]) {
    await page.getByRole("link", { name: screen, exact: true }).click();
    await expect(page.getByRole("heading", { level: 1, name: screen })).toBeVisible();
    await expect(page.locator(".selector option:checked")).toHaveText("press-1");
  }
  await page.keyboard.press("g");
  await page.keyboard.press("f");
  await expect(page.getByRole("heading", { level: 1, name: "press-1" })).toBeVisible();
  // and the focus is where the new screen begins
  await expect(page.locator("#content")).toBeFocused();
});

test("shortcuts react with the focus on a box and on a slider, not in a field", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await page.getByRole("link", { name: "Scope", exact: true }).click();
  await page.getByRole("checkbox").first().focus();
  await page.keyboard.press("c");
  await page.getByRole("slider").first().focus();
  await page.keyboard.press("g");
  await page.keyboard.press("p");
  const search = page.getByRole("searchbox");
  await expect(search).toBeVisible();
  await search.focus();
  await page.keyboard.press("g");
  await page.keyboard.press("n");
  await expect(search).toHaveValue("gn");
});

test("on a touch screen STOP is at the lower right, and what is pressed is large", async ({ browser, demo }) => {
  const context = await browser.newContext({
    baseURL: demo.origin,
    hasTouch: true,
    isMobile: true,
    viewport: { width: 768, height: 1024 },
  });
  const page = await context.newPage();
  await page.goto(demo.url);
  await rows(page);
  for (const [name, path] of await screens(page)) {
    await page.goto(path);
    await expect(page.locator("main h1")).toBeVisible();
    const stop = page.getByRole("button", { name: /^STOP/ });
    const seen = await stop.evaluate((button) => {
      const { x, y, width, height, right, bottom } = button.getBoundingClientRect();
      const nav = document.querySelector("nav")?.getBoundingClientRect();
      return {
        hit: document.elementFromPoint(x + width / 2, y + height / 2) === button,
        corner: innerWidth - right < 16 && bottom <= (nav?.top ?? 0) && innerHeight - bottom < 100,
        bottom: Math.round(nav?.bottom ?? 0) === innerHeight && (nav?.top ?? 0) > innerHeight - 100,
        sideways: document.documentElement.scrollWidth > innerWidth,
      };
    });
    expect(seen, name).toEqual({ hit: true, corner: true, bottom: true, sideways: false });
    const ends = await page
      .locator("nav > a")
      .evaluateAll((all) => all.map((one) => one.getBoundingClientRect().right));
    expect(Math.max(...ends), `${name}: each screen is in sight`).toBeLessThanOrEqual(768);
    const small = await page
      .locator(
        "button:visible, select:visible, summary:visible, nav a:visible, .next-steps a:visible, input:not([type=checkbox]):visible",
      )
      .evaluateAll((all) =>
        all
          // rows of a table that was filled meanwhile are gone
          .filter((one) => one.isConnected && !one.closest(".tools .file, label.button"))
          .filter((one) => one.getBoundingClientRect().height < 44)
          .map((one) => one.outerHTML.slice(0, 120)),
      );
    expect(small, name).toEqual([]);
    if ((await page.locator(".pad").count()) > 0) {
      // the speed stays in sight, and the pad is above the screens
      const pad = page.locator(".pad");
      await pad.evaluate((one) => one.scrollIntoView({ block: "nearest" }));
      const speed = await page.locator(".control-values .main").first().boundingBox();
      const buttons = await pad.boundingBox();
      const nav = await page.locator("nav").boundingBox();
      expect(speed?.y).toBeGreaterThan((await page.locator(".top").boundingBox())?.height ?? 0);
      expect((buttons?.y ?? 0) + (buttons?.height ?? 0)).toBeLessThan(nav?.y ?? 0);
    }
  }
  await page.getByRole("button", { name: /^STOP/ }).tap();
  await expect(page.getByRole("alert")).toContainText("was received");
  // the notice is not above STOP, and STOP not above what it offers, with longer words either
  await page.getByRole("button", { name: /^STOP/ }).tap();
  await page.goto("/network?lang=xx");
  const reset = page.getByRole("button", { name: /Reset STOP/ });
  await expect(reset).toBeVisible();
  const [left, right] = [await reset.boundingBox(), await page.locator(".stop").boundingBox()];
  expect((left?.x ?? 0) + (left?.width ?? 0)).toBeLessThanOrEqual(right?.x ?? 0);
  await context.close();
});

test("a tablet and a phone have their screens at the lower end, a phone those that look", async ({ entered: page }) => {
  const links = page.locator("nav > a:visible");
  const offered = ["Network", "Overview", "Faults"];
  for (const [name, path] of await screens(page)) {
    await page.goto(path);
    await expect(page.locator("main h1")).toBeVisible();
    for (const [width, height] of [
      [768, 950],
      [600, 900],
    ] as const) {
      await page.setViewportSize({ width, height });
      const seen = await page.evaluate(() => {
        const nav = document.querySelector("nav")?.getBoundingClientRect();
        const stop = document.querySelector(".stop")?.getBoundingClientRect();
        const rows = [...document.querySelectorAll("tbody tr")].filter((row) => row.checkVisibility());
        return {
          below: nav?.bottom === innerHeight && nav.top > innerHeight - 100,
          corner: stop !== undefined && (nav?.right ?? 0) - stop.right < 16 && stop.bottom <= (nav?.top ?? 0),
          high: stop?.height === 64,
          rows: rows.every((row) => row.getBoundingClientRect().height >= 43),
        };
      });
      // the histogram is a picture made of rows
      const rows = name === "telegram" ? { ...seen, rows: true } : seen;
      expect(rows, `${name} ${width}`).toEqual({ below: true, corner: true, high: true, rows: true });
      if (width < 700) await expect(links).toHaveText(offered);
      else await expect(links).toHaveCount(12);
    }
    const needs = page.getByText("This screen is made for a width of 700 px");
    const whole = ["network", "overview", "faults"].includes(name.split("-")[0] ?? "");
    await expect(needs).toHaveCount(whole ? 0 : 1);
  }
  // nothing else leads to another screen
  await page.goto("/network");
  // what matters most is first, and in sight
  await expect(page.locator("thead th").filter({ hasText: /\w/ }).first()).toHaveText("Name");
  for (const [width, seen] of [
    [390, ["Name", "State"]],
    [768, ["Name", "State", "Actions"]],
  ] as const) {
    await page.setViewportSize({ width, height: 844 });
    for (const name of seen) {
      const box = await page.getByRole("columnheader", { name, exact: true }).boundingBox();
      expect((box?.x ?? width) + (box?.width ?? 0), `${name} at ${width}`).toBeLessThanOrEqual(width);
    }
  }
  await page.setViewportSize({ width: 600, height: 900 });
  await expect(page.getByRole("row", { name: "axis-2" })).toBeVisible();
  await page.getByRole("link", { name: "axis-2", exact: true }).click();
  await expect(page.locator(".why-not")).toBeVisible();
  const elsewhere = await page
    .locator("main a:visible")
    .evaluateAll((all) =>
      all.map((one) => one.getAttribute("href") ?? "").filter((to) => !/overview|faults|network/.test(to)),
    );
  expect(elsewhere).toEqual([]);
});

test("what is waited for keeps its place, and has a name when it takes long", async ({ entered, context }) => {
  const all = await screens(entered);
  const path = (name: string) => all.find(([one]) => one === name)?.[1] ?? "";
  const held = async (name: string, withheld: RegExp, text: string) => {
    const page = await context.newPage();
    await page.routeWebSocket("**/api/v1/live", (socket) => {
      const server = socket.connectToServer();
      server.onMessage((message) => {
        if (typeof message !== "string" || !withheld.test(message)) socket.send(message);
      });
    });
    // requests that are not answered
    await page.route(/\/api\/v1\/(audit|backups|captures|drives\/[^/]+\/(parameters|changed))/, () => {});
    await page.goto(path(name));
    const line = page.getByText(text);
    await expect(line, name).toBeVisible();
    await expect(page.locator(".bars").first(), name).toBeVisible();
    // the line was there before its words, so that nothing has moved
    expect((await line.boundingBox())?.height, name).toBe(20);
    await page.close();
  };
  const cases = [
    ["network", /"topic":"network"/, "Waiting for the workbench .."],
    ["overview", /"topic":"network"/, "Waiting for the end of the first search for stations .."],
    ["overview", /nothing/, "Waiting for the settings of fan-1 .."],
    ["faults", /\/faults"/, "Waiting for the fault buffer of axis-2 .."],
    ["parameters", /nothing/, "Waiting for the list of parameters .."],
    ["compare", /nothing/, "Waiting for the list of files .."],
    ["machine", /\/machine"/, "Waiting for the control and status word of press-1 .."],
    ["telegram", /\/telegram"/, "Waiting for the frames of press-1 .."],
    ["capture", /nothing/, "Waiting for the list of files .."],
    ["log", /nothing/, "Waiting for the log .."],
    ["virtual", /"topic":"plant"/, "Waiting for the virtual drives .."],
  ] as const;
  // some at once: each waits two seconds
  for (let first = 0; first < cases.length; first += 4) {
    await Promise.all(cases.slice(first, first + 4).map(([name, withheld, text]) => held(name, withheld, text)));
  }
});

test("a long state is read whole, and so is why a jog is refused", async ({ page }) => {
  // one whose STOP was not pressed
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    const cut = await page
      .locator("td.why bdi")
      .evaluateAll((all) => all.filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent));
    expect(cut).toEqual([]);
    const table = page.getByRole("region", { name: /^Stations of the network/ });
    expect(await table.evaluate((one) => one.scrollWidth - one.clientWidth)).toBeLessThanOrEqual(0);
    const heights = await page
      .locator("tbody tr")
      .evaluateAll((all) => all.map((one) => Math.round(one.getBoundingClientRect().height)));
    expect([...new Set(heights)]).toEqual([28]);
    // and nothing in a row is higher than it
    const higher = await page
      .locator("tbody td, tbody td bdi")
      .evaluateAll((all) =>
        all.filter((one) => one.scrollHeight > Math.max(28, one.clientHeight + 1)).map((one) => one.textContent),
      );
    expect(higher).toEqual([]);
    const id = await idOf(page, "axis-1");
    // beats that are answered late
    await page.routeWebSocket("**/api/v1/control", (socket) => {
      const server = socket.connectToServer();
      server.onMessage((message) => {
        if (String(message).includes('"beat"')) setTimeout(() => socket.send(message), 150);
        else socket.send(message);
      });
    });
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    const why = page.locator("#jog-why");
    const pad = page.getByRole("group", { name: /^Jog buttons/ });
    await expect(why).toHaveText("Take control first.");
    await expect(why).toBeInViewport({ ratio: 1 });
    await expect(pad).toBeInViewport({ ratio: 1 });
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(why).toHaveText("Enable the axis first.");
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(why).toHaveText(/^The round trip to the workbench is \d+ ms: too slow to jog\.$/);
    await expect(page.getByRole("button", { name: "+20 rpm" })).toBeDisabled();
    await expect(why).toBeInViewport({ ratio: 1 });
    await expect(pad).toBeInViewport({ ratio: 1 });
    await page.getByRole("button", { name: "Release" }).click();
    await expect(why).toHaveText("Take control first.");
  } finally {
    await end(server);
  }
});

test("without a token the page says what it needs", async ({ browser, demo }) => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(`${demo.origin}/network`);
  await expect(page.getByRole("alert")).toContainText("Open the address that the server printed");
  await page.goto(`${demo.origin}/#token=00000000000000000000000000000000`);
  await page.reload();
  await expect(page.getByRole("alert")).toBeVisible();
  await context.close();
});

test("the picture of the README", async ({ page }) => {
  // one on which nothing was pressed yet
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    await page.setViewportSize({ width: 1366, height: 440 });
    await expect(page.getByRole("row", { name: "press-1" })).toContainText("it runs");
    const file = join(pictures, "workbench.png");
    await page.screenshot({ path: file });
    if (process.env.PICTURE) {
      copyFileSync(file, process.env.PICTURE);
    }
  } finally {
    await end(server);
  }
});
