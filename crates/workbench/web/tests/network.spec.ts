import { expect, test } from "./bench";

test("the stations appear without a click, those that need attention first", async ({ entered: page, demo }) => {
  // the token is gone from the address
  expect(page.url()).toBe(`${demo.origin}/`);
  await expect(page.getByRole("row").nth(1)).toContainText("F439");
  await expect(page.getByRole("row").nth(1)).toContainText("axis-2");
  const press = page.getByRole("row", { name: "press-1" });
  await expect(press.getByRole("img", { name: /turns at \d+ rpm/ })).toBeVisible();
  await expect(press).toContainText("plc-1");
  await expect(press).toContainText("S4");
  await expect(press).toContainText("Kollmorgen");
  const fresh = page.getByRole("row", { name: "(no name)" });
  await expect(fresh).toContainText("no name, no IP address");
  await expect(page.getByText("SIMULATION: these drives are virtual")).toBeVisible();
});

test("rows stay where they are while a drive runs and waits by turns", async ({ entered: page }) => {
  const names = () => page.locator("tbody th bdi").allTextContents();
  const press = page.getByRole("row", { name: "press-1" });
  const before = await names();
  for (const word of ["runs:", "waits:", "runs:"]) {
    await expect(press.locator(".reason .unseen")).toHaveText(word, { timeout: 15_000 });
    expect(await names()).toEqual(before);
  }
});

test("a simulation shows how to make a motor turn", async ({ entered: page }) => {
  const card = page.getByRole("region", { name: "Make a motor turn" });
  await expect(card.getByRole("listitem")).toHaveCount(3);
  await card.getByRole("link", { name: "Start" }).click();
  await expect(page.getByRole("heading", { level: 1, name: "Control axis-1" })).toBeVisible();
  await expect(page.getByRole("button", { name: "Take control" })).toBeInViewport();
});

test("the drives that are selected are saved, and two of them compared", async ({ entered: page }) => {
  await page.getByRole("checkbox", { name: "Select pump-1" }).check();
  await expect(page.getByRole("button", { name: "Compare two" })).toBeDisabled();
  await page.getByRole("checkbox", { name: "Select fan-1" }).check();
  await page.getByRole("button", { name: "Read identity of 2" }).click();
  const identities = page.getByRole("region", { name: "Identities" }).last();
  await expect(identities.getByRole("row", { name: "pump-1" })).toContainText("FC-302");
  await page.getByRole("button", { name: "Close" }).click();
  await expect(identities).toHaveCount(0);
  await page.getByRole("button", { name: "Back up 2" }).click();
  const said = page.getByRole("status").filter({ hasText: "Settings of 2 of 2 drives were saved" });
  await expect(said).toContainText(/pump-1-.*\.backup/, { timeout: 30_000 });
  await page.getByRole("button", { name: "Compare two" }).click();
  await expect(page.getByRole("heading", { level: 1, name: /^Compare/ })).toBeVisible();
  await expect(page.getByRole("combobox", { name: "Right" })).toHaveValue(/^drive /);
});

test("a search can be requested", async ({ entered: page }) => {
  const [answer] = await Promise.all([
    page.waitForResponse((response) => response.url().endsWith("/stations/scan")),
    page.getByRole("button", { name: "Search now" }).click(),
  ]);
  expect(answer.status()).toBe(200);
  await expect(page.getByRole("button", { name: "Search now" })).toBeEnabled();
  await expect(page.getByText(/Searched \d+ s ago/)).toBeVisible();
});

test("the glyph of a shaft follows its position", async ({ entered: page }) => {
  const key = page.getByRole("row", { name: "press-1" }).locator(".key");
  const angle = () => key.evaluate((path) => (path as SVGPathElement).style.transform);
  const first = await angle();
  await expect.poll(angle).not.toBe(first);
});

test("without motion the shaft is described in words", async ({ entered: page }) => {
  await page.emulateMedia({ reducedMotion: "reduce" });
  await expect(page.getByRole("row", { name: "axis-1" }).getByText("at rest").last()).toBeVisible();
});

test("texts of stations are shown as text", async ({ page, demo }) => {
  const texts = [
    "<img src=x onerror=\"document.title='run'\">",
    "<script>document.title='run'</script>",
    "\u202egnp.exe",
    "x".repeat(65_536),
    "=1+1",
  ];
  const outside: string[] = [];
  page.on("request", (request) => {
    if (!request.url().startsWith(demo.origin) && !request.url().startsWith("blob:")) outside.push(request.url());
  });
  await page.routeWebSocket("**/api/v1/live", (socket) => {
    const server = socket.connectToServer();
    server.onMessage((text) => {
      const message = JSON.parse(String(text));
      if (message.type === "snapshot" && message.topic === "network") {
        message.data.stations.forEach((station: Record<string, unknown>, index: number) => {
          station.name = texts[index] ?? "plain";
          station.type = texts[index] ?? "plain";
          station.unread = texts[index] ?? null;
          if (index % 2 === 0 && station.status) {
            station.status = { ...(station.status as object), sentence: texts[index] };
          }
        });
      }
      socket.send(JSON.stringify(message));
    });
  });
  await page.goto(demo.url);
  await expect(page.getByRole("row")).toHaveCount(7);
  await expect(page.getByRole("cell", { name: "<script>document.title='run'</script>" }).first()).toBeVisible();
  await expect(page.getByText("(+65416)").first()).toBeAttached();
  expect(await page.locator("main img").count()).toBe(0);
  expect(await page.title()).toBe("Network - profidrive workbench");
  const boxes = await page.getByRole("row").evaluateAll((all) => all.map((row) => row.getBoundingClientRect().height));
  // a state is read whole, and texts are cut with a count before they have more lines than these
  expect(Math.max(...boxes)).toBeLessThan(90);
  expect(await page.locator("bdi", { hasText: "gnp.exe" }).first().textContent()).toContain("\ufffdgnp.exe");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Export CSV" }).click(),
  ]);
  const chunks: Buffer[] = [];
  for await (const chunk of await download.createReadStream()) chunks.push(chunk as Buffer);
  const table = Buffer.concat(chunks).toString("utf8");
  expect(table).toContain("\n'=1+1,");
  expect(outside).toEqual([]);
});
