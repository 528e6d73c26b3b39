import { readFileSync } from "node:fs";
import { alone, expect, idOf, inject, rows, test, watch } from "./bench";

// each test has a server of its own: what happens to its drives is no matter of another test
test("a fault is announced once, with its remedy, and goes to the history when it is acknowledged", async ({
  page,
}) => {
  const wrong = watch(page);
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/faults`);
    await expect(page.getByText("No fault and no warning is present.")).toBeVisible();
    // a warning is above each screen
    await inject(page, "axis-1", "warning=107");
    await expect(page.locator(".frame")).toContainText("W107");
    await inject(page, "axis-1", "clear=107");
    await inject(page, "axis-1", "fault=439!");
    const row = page.getByRole("listitem").filter({ hasText: "F439" });
    await expect(row).toContainText("Remedy:", { timeout: 3000 });
    await expect(page.getByRole("alert").filter({ hasText: "Fault F439" })).toHaveCount(1);
    await expect(row).toContainText("Seen by this page since");
    // what the remedy names leads to the parameter
    const named = row.getByRole("link").first();
    const name = await named.textContent();
    await named.click();
    await expect(page.getByRole("searchbox", { name: /Search/ })).toHaveValue(name ?? "");
    await expect(page.locator("tr.parameter").first()).toContainText(name ?? "");
    await page.goBack();
    // its time in the Scope, which has recorded nothing of it, and can record the next one
    const scope = row.getByRole("link", { name: "Scope at that time" });
    await scope.click();
    await expect(page.getByRole("status").filter({ hasText: /^Nothing of .* UTC is recorded/ })).toBeVisible();
    await page.getByRole("button", { name: "Record the next fault" }).click();
    await expect(page.getByText("Waiting for the trigger ..")).toBeVisible();
    await page.goBack();
    const acknowledge = page.getByRole("button", { name: "Acknowledge" });
    await acknowledge.click();
    await expect(page.getByText(/^Not acknowledged: .*439/)).toBeVisible();
    await inject(page, "axis-1", "clear=439");
    await acknowledge.click();
    await expect(page.getByText("No fault and no warning is present.")).toBeVisible();
    await expect(page.getByRole("row", { name: /F439/ })).toBeVisible();
    // one that came while the Scope was closed is not between what it recorded before and after
    await inject(page, "axis-1", "fault=439!");
    await expect(row).toBeVisible();
    await scope.click();
    await expect(page.getByRole("status").filter({ hasText: /^Nothing of .* UTC is recorded/ })).toBeVisible();
    await page.goBack();
    await inject(page, "axis-1", "clear=439");
    await acknowledge.click();
    await expect(page.getByText("No fault and no warning is present.")).toBeVisible();
    // the file has what the table has, and no cell is a formula
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.getByRole("button", { name: "Export CSV" }).click(),
    ]);
    const lines = readFileSync(await download.path(), "utf8")
      .trim()
      .split("\r\n");
    expect(lines[0]).toBe("drive,kind,situation,number,meaning,value,time of the drive,remedy");
    expect(lines[1]).toMatch(/^axis-1,acknowledged fault,1,439,/);
    expect(download.suggestedFilename()).toBe("faults.csv");
    // one that comes while the Scope is open is found there, also when it was seen on another screen
    await page.getByRole("link", { name: "Scope" }).first().click();
    await page.getByRole("combobox", { name: "Time" }).selectOption("1000000");
    await page.getByRole("button", { name: "Single (S)" }).click();
    await expect(page.getByText("Waiting for the trigger ..")).toBeVisible();
    await inject(page, "axis-1", "fault=439!");
    await expect(page.getByText("Stopped", { exact: true })).toBeVisible();
    await page.getByRole("link", { name: "Faults" }).click();
    await scope.click();
    await expect(page.getByRole("status").filter({ hasText: /^Around .* UTC/ })).toBeVisible();
    expect(wrong.filter((text) => !text.includes("409"))).toEqual([]);
  });
});

test("a fault that only a restart clears offers no acknowledgement", async ({ page }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    // earth fault: a trip lock of the VLT
    await inject(page, "pump-1", "fault=14");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "pump-1"))}/faults`);
    await expect(page.getByText("No command clears this.")).toBeVisible();
    await expect(page.getByText(/Fault situation counter \(PNU 952\): \d+/)).toBeVisible();
    await expect(page.getByRole("button", { name: "Acknowledge" })).toHaveCount(0);
  });
});

test("the overview acknowledges beside its sentence, and other pages show who did", async ({ page, browser }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    const other = await (await browser.newContext()).newPage();
    await other.goto(server.viewUrl);
    await rows(other);
    await page.getByRole("link", { name: "axis-2" }).click();
    await expect(page.locator(".why-not")).toHaveAttribute("data-cause", "fault");
    // its cause is present
    await page.getByRole("button", { name: "Acknowledge" }).click();
    await expect(page.getByText(/^Not acknowledged: .*439/)).toBeVisible();
    await inject(page, "axis-2", "clear=439");
    await page.getByRole("button", { name: "Acknowledge" }).click();
    await expect(page.locator(".why-not")).toHaveAttribute("data-cause", "no-controller", { timeout: 5000 });
    await expect(other.getByText(/Faults were acknowledged\. axis-2 \(session 1\)/)).toBeVisible();
    await other.getByRole("button", { name: "STOP" }).click();
    await expect(page.getByText("STOP 1 was pressed by session 2.")).toBeVisible();
    await expect(other.getByText("STOP 1 was pressed by this session.")).toBeVisible();
    // one line, not two
    await expect(page.getByText("STOP was pressed.")).toHaveCount(0);
    await other.context().close();
  });
});
