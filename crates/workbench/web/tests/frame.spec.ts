import { chmodSync, copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { alone, end, expect, idOf, pictures, rows, serve, serveIn, test } from "./bench";
import { screens } from "./screens";

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
  await alone(async (server) => {
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
  });
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
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.setViewportSize({ width: 1366, height: 440 });
    await expect(page.getByRole("row", { name: "press-1" })).toContainText("it runs");
    const file = join(pictures, "workbench.png");
    await page.screenshot({ path: file });
    if (process.env.PICTURE) {
      copyFileSync(file, process.env.PICTURE);
    }
  });
});
