import { execFileSync } from "node:child_process";
import { end, expect, idOf, program, rows, serve, test, watch } from "./bench";

test("what happens to a virtual drive shows on its other screens at once", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  const wrong = watch(page);
  try {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "Virtual drives" }).click();
    await expect(page.getByRole("row", { name: "press-1" })).toContainText(/\d+\.\d/);
    await page.getByRole("button", { name: "Select axis-1" }).click();
    await page.getByRole("button", { name: "STO on" }).click();
    await expect(page.getByRole("status").filter({ hasText: "axis-1: sto=on" }).first()).toBeVisible();
    const overview = `${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/overview`;
    await page.goto(overview);
    await expect(page.locator(".why-not")).toHaveAttribute("data-cause", "sto");
    await page.goto(`${server.origin}/virtual`);
    await page.getByRole("button", { name: "Select axis-1" }).click();
    // what lasts is named in its row, and has a button that ends it
    const row = page.getByRole("row", { name: "axis-1" });
    await expect(row).toContainText("sto=on");
    await page.getByRole("button", { name: "End sto=on" }).click();
    await expect(row).not.toContainText("sto=on");
    await expect(page.getByText("Nothing that was injected lasts.")).toBeVisible();
    await page.getByRole("combobox", { name: /^Fault/ }).selectOption("439");
    await page.getByRole("button", { name: "Until its cause is cleared" }).click();
    await expect(row).toContainText("F439");
    await expect(row).toContainText("fault=439!");
    await page.getByLabel("Any event").fill("load=0.2Nm");
    await page.getByRole("button", { name: "Inject" }).click();
    await expect(page.getByText("axis-1: load=0.2Nm").first()).toBeVisible();
    await page.getByLabel("Any event").fill("load=much");
    await page.getByRole("button", { name: "Inject" }).click();
    await expect(page.getByRole("status").filter({ hasText: "load" }).last()).toHaveClass("fault");
    await page.getByLabel("For seconds").fill("-3");
    await expect(page.getByText("A time is more than 0 s and at most a day.")).toBeVisible();
    await expect(page.getByRole("button", { name: "STO on" })).toBeDisabled();
    expect(wrong.filter((text) => !text.includes("400"))).toEqual([]);
  } finally {
    await end(server);
  }
});

test("what was let happen becomes a plant file in which it happens again", async ({ page }) => {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "Virtual drives" }).click();
    await page.getByRole("button", { name: "Select axis-1" }).click();
    await page.getByRole("button", { name: "Record" }).click();
    await expect(page.getByRole("link", { name: "Save 0 events" })).toBeVisible();
    const clicks = [
      ["STO on", "sto=on"],
      ["STO off", "sto=off"],
      ["Pull the cable", "cable=pulled"],
      ["Plug the cable", "cable=plugged"],
    ] as const;
    for (const [name, event] of clicks) {
      await page.getByRole("button", { name, exact: true }).click();
      await expect(
        page
          .getByRole("status")
          .filter({ hasText: `axis-1: ${event}` })
          .first(),
      ).toBeVisible();
    }
    await page.getByText("Plant file, with what was injected").click();
    await expect(page.locator("pre")).toContainText('do = "cable=plugged"');
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.getByRole("link", { name: "Save 4 events" }).click(),
    ]);
    const printed = execFileSync(program, ["simulate", "--virtual-time", await download.path(), "--for", "20s"], {
      encoding: "utf8",
    });
    const happened = printed.split("\n").filter((line) => line.includes("axis-1") && line.includes("! "));
    expect(happened.map((line) => line.split("! ")[1]?.trim())).toEqual(clicks.map(([, event]) => event));
  } finally {
    await end(server);
  }
});
