import { alone, expect, idOf, inject, openScreen, rows, test } from "./bench";

interface Known {
  id: string;
  name: string | null;
  status: { cause: string } | null;
}

test("each drive has the sentence of the library", async ({ entered: page }) => {
  const { stations } = (await (await page.request.get("/api/v1/stations")).json()) as { stations: Known[] };
  expect(stations.length).toBe(6);
  for (const { id, name, status } of stations) {
    await page.goto(`/drives/${encodeURIComponent(id)}/overview`);
    const why = page.locator(".why-not");
    await expect(why).toHaveAttribute("data-id", id);
    if (status === null) {
      expect(name).toBeNull();
      await expect(why).toContainText("It has no IP address");
      continue;
    }
    // the drive goes on meanwhile: both are looked at again until they agree
    await expect
      .poll(async () => {
        const answer = await page.request.get(`/api/v1/drives/${encodeURIComponent(id)}/status`);
        const { cause } = (await answer.json()) as { cause: string };
        return (await why.getAttribute("data-cause")) === cause ? "same" : cause;
      })
      .toBe("same");
  }
});

test("a drive under a controller is only watched", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.getByText("plc-1 controls this drive. This page only watches.")).toBeVisible();
  await expect(page.getByRole("button", { name: "STOP not available" })).toBeVisible();
  await expect(page.getByText("plc-1 controls this drive. Use the emergency stop of the machine.")).toBeVisible();
  await expect(page.locator("main").getByRole("button")).toHaveCount(0);
});

test("a fault has its meaning and its remedy, and the next step", async ({ entered: page }) => {
  await page.getByRole("link", { name: "axis-2" }).click();
  await expect(page.locator(".sentence")).toContainText("439");
  await expect(page.locator(".next")).toContainText("Next:");
  await expect(page.getByText("Remedy:").first()).toBeVisible();
  await expect(page.getByRole("listitem").filter({ hasText: "Faults" })).toContainText("not met");
});

test("what was acknowledged keeps the focus in its place, and says so for a while", async ({ page }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    const id = await idOf(page, "axis-1");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/overview`);
    await inject(page, "axis-1", "fault=439");
    await page.getByRole("button", { name: "Acknowledge" }).focus();
    await page.keyboard.press("Enter");
    await expect(page.getByRole("button", { name: "Acknowledge" })).toHaveCount(0);
    const notice = page.locator(".notices .happened");
    await expect(notice).toContainText("Faults were acknowledged.");
    await expect(page.locator(".why-not")).toBeFocused();
    await expect(notice).toHaveCount(0);
    await expect(page.locator(".why-not")).toBeFocused();
  });
});

test("a drive that does not answer any more has no advice and no signs of before", async ({ page }) => {
  await alone(async (server) => {
    await openScreen(page, server, "pump-1", "overview");
    const why = page.locator(".why-not");
    const tick = page.locator(".conditions li").filter({ hasText: /^met:/ });
    await expect(why).toContainText("start the controller");
    await expect(tick.first()).toBeVisible();
    await inject(page, "pump-1", "cable=pulled");
    await expect(why.locator(".next")).toContainText("Check its supply, cable and address.", {
      timeout: 20_000,
    });
    await expect(why.getByRole("button")).toHaveCount(0);
    await expect(why.getByRole("link")).toHaveCount(0);
    await expect(tick).toHaveCount(0);
  });
});

test("each advice of the library has a link to where it is followed", async ({ entered: page }) => {
  await page.getByRole("link", { name: "axis-1" }).click();
  const step = page.locator(".next-steps").getByRole("link", { name: "Open Control" });
  expect((await step.boundingBox())?.height).toBe(28);
  await step.click();
  await expect(page.getByRole("heading", { level: 1, name: "Control axis-1" })).toBeVisible();
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "new-1"))}/overview`);
  await page.getByRole("button", { name: "Name and address .." }).click();
  await expect(page.getByRole("dialog")).toBeVisible();
  // a value that is advised is typed, and not written
  const parameters = `/drives/${encodeURIComponent(await idOf(page, "axis-2"))}/parameters`;
  await page.goto(`${parameters}#q=DRV.ACC&set=DRV.ACC%3D2500`);
  const plan = page.getByRole("region", { name: "Changes" });
  await expect(plan).toContainText("2500");
  await page.getByRole("button", { name: "Discard" }).click();
  // the place in the telegram
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/parameters#q=VL.FB_32`);
  await page.getByRole("button", { name: "VL.FB_32", exact: true }).click();
  await expect(page.locator(".details")).toContainText("In telegram 1: NIST_A, octets 2-3 from the drive");
});

test("values come with unit, age and the last minute", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.getByRole("img", { name: /Speed, last 60 s: .* rpm/ })).toBeVisible();
  await expect(page.getByText(/Read \d s ago/)).toBeVisible();
  // the last thing that is read of a drive
  await expect(page.getByRole("heading", { name: "Backup and rights" })).toBeVisible();
  // values change, and nothing moves its place
  const speed = page.locator(".value").first();
  const shown = () => speed.locator(".main").textContent();
  const before = await shown();
  const boxes = () =>
    page
      .locator(".value, h2, .stop")
      .evaluateAll((all) => all.map((one) => JSON.stringify(one.getBoundingClientRect())));
  const places = await boxes();
  await expect.poll(shown).not.toBe(before);
  // and neither does it when the sentence is another one
  const cause = () => page.locator(".why-not").getAttribute("data-cause");
  const first = await cause();
  await expect.poll(cause).not.toBe(first);
  expect(await boxes()).toEqual(places);
});

test("what is read last has its place before, so that no heading moves", async ({ entered: page }) => {
  for (const [name, last] of [
    ["axis-1", /differs? from default|as delivered/],
    ["pump-1", "Parameter Edit"],
  ] as const) {
    let answer = () => {};
    const held = new Promise<void>((resolve) => {
      answer = resolve;
    });
    await page.route(/\/api\/v1\/drives\/[^/]+\/(changed|values)/, async (route) => {
      await held;
      await route.continue();
    });
    await page.goto(`/drives/${encodeURIComponent(await idOf(page, name))}/overview`);
    await expect(page.getByText(/Read \d s ago/)).toBeVisible();
    const headings = () =>
      page
        .locator("h2")
        .evaluateAll((all) => all.map((one) => `${one.textContent} ${one.getBoundingClientRect().top}`));
    const care = page.locator(".care");
    await expect(care.locator(".bars")).toBeVisible();
    // with the words of a wait that takes long
    await expect(care).toContainText(`Waiting for the settings of ${name} ..`);
    const still = (all: string[]) => all.map((one) => one.replace(/Read \d+ s ago/, ""));
    const before = still(await headings());
    answer();
    await expect(care).toContainText(last);
    await expect(care.locator(".bars")).toHaveCount(0);
    expect(still(await headings()), name).toEqual(before);
    await page.unrouteAll({ behavior: "wait" });
  }
});

test("the frame has how regular the cyclic frames are, and values are those the drive has", async ({
  entered: page,
}) => {
  await page.getByRole("link", { name: "press-1" }).click();
  const link = page.locator(".frame [data-link]");
  await expect(link).toHaveText(/^\d+ ms, jitter p99 \d+\.\d\d ms, missed 0$/);
  const frames = async () => Number(await link.getAttribute("data-link"));
  const before = await frames();
  await expect.poll(frames).toBeGreaterThan(before);
  const named = (title: string) => page.locator(".value").filter({ has: page.getByText(title, { exact: true }) });
  await expect(named("Current")).toContainText(/\d\.\d\d A/);
  await expect(named("Power stage")).toContainText(/\d \u00b0C/);
  await expect(named("Torque")).toHaveCount(0);
  // 3000 rpm/s are delivered, the demo has 100: both ramps
  await expect(page.getByText("2 settings differ from default")).toBeVisible();
  await page.getByRole("link", { name: "Show them" }).click();
  await expect(page.getByRole("combobox", { name: "Show" })).toHaveValue("changed");
  await expect(page.locator("tr.parameter th")).toHaveText(["DRV.ACC", "DRV.DEC"]);
  // without a cyclic connection there is none
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "pump-1"))}/overview`);
  await expect(page.locator(".frame").getByText("No cyclic frames")).toBeVisible();
  await expect(named("Torque")).toContainText("Nm");
});

test("an event is noted while the page is open", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.locator(".events li").first()).toContainText(/\d\d:\d\d:\d\d/, { timeout: 30_000 });
});
