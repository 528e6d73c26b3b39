import { alone, expect, idOf, test } from "./bench";
import { enter, open, options } from "./moving";

test("who people say they are is asked once, and stands marked in the log and beside what they hold", async ({
  page,
  browser,
}) => {
  await alone(async (server) => {
    await open(page, server.url, "axis-1");
    await options(page);
    const name = page.getByLabel("Your name, for the log (not verified)");
    await name.fill("  Anna <b>");
    await name.press("Tab");
    await expect(name).toHaveValue("Anna <b>");
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.getByText("IN CONTROL")).toBeVisible();
    const other = await (await browser.newContext()).newPage();
    await enter(other, server.url);
    const id = await idOf(other, "axis-1");
    await other.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await expect(
      other.getByText(/Session 1 \(\u201cAnna <b>\u201d, not verified\) has control of this drive/).first(),
    ).toBeVisible();
    await page.getByRole("button", { name: "Release" }).click();
    await page.goto(`${server.origin}/log`);
    const taken = page.locator("tr[data-action=take]").first();
    await expect(taken).toContainText("(\u201cAnna <b>\u201d, not verified)");
    // a new session of this browser has it again
    await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
    await page.goto("about:blank");
    await page.goto(server.url);
    await expect
      .poll(async () => (await page.request.get(`${server.origin}/api/v1/session`)).json())
      .toMatchObject({ name: "Anna <b>" });
    await other.context().close();
  });
});
