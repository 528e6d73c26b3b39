import { expect, test } from "./bench";

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
  await expect(page.getByRole("listitem").filter({ hasText: "No fault" })).toContainText("not met");
});

test("values come with unit, age and the last minute", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.getByRole("img", { name: /Speed, last 60 s: .* rpm/ })).toBeVisible();
  await expect(page.getByText(/Read \d s ago/)).toBeVisible();
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

test("an event is noted while the page is open", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await expect(page.locator(".events li").first()).toContainText(/\d\d:\d\d:\d\d/, { timeout: 30_000 });
});
