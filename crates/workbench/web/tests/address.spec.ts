import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import type { Page } from "@playwright/test";
import { alone, expect, idOf, type Running, rows, test, watch } from "./bench";
import { open as openControl } from "./moving";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

async function open(page: Page, server: Running, lang = ""): Promise<void> {
  await page.goto(server.url);
  await rows(page);
  if (lang !== "") {
    await page.goto(`${server.origin}/network${lang}`);
    await expect(page.getByRole("row")).toHaveCount(7);
  }
  await page.locator("tr", { hasText: "192.168.77.22" }).waitFor();
  await page.locator("tr").filter({ hasText: "no name" }).locator("button[aria-haspopup=dialog]").click();
}

test("a station is found by blinking, named with the offered form, and the log has old and new", async ({ page }) => {
  await alone(async (server) => {
    const wrong = watch(page);
    await open(page, server);
    const dialog = page.getByRole("dialog", { name: /^Name and address of \(no name\)/ });
    // what finds the station comes before what changes it
    await expect(dialog.getByRole("button", { name: /^Blink/ })).toBeFocused();
    await page.keyboard.press("Enter");
    await expect(dialog.getByRole("button", { name: /^Blinks/ })).toBeVisible();
    await expect(dialog.getByText(/has blinked for 6 s/)).toBeVisible();
    const field = dialog.getByRole("textbox", { name: "Name" });
    const set = dialog.getByRole("button", { name: "Set the name" });
    await field.fill("Axis_3");
    await expect(dialog.getByText(/`Axis_3` is not a valid station name: /)).toBeVisible();
    await expect(set).toBeDisabled();
    await dialog.getByRole("button", { name: "Use axis-3" }).click();
    await expect(field).toHaveValue("axis-3");
    await expect(field).toBeFocused();
    await expect(dialog.getByText("This name is valid, and no other station has it.")).toBeVisible();
    await page.keyboard.press("Enter");
    await expect(page.getByRole("link", { name: "axis-3", exact: true })).toBeVisible();
    await expect(page.getByRole("dialog", { name: "axis-3" }).getByText("Name set: axis-3.")).toBeVisible();
    await page.getByRole("link", { name: "Log" }).click();
    await expect(page.getByRole("row", { name: "none -> axis-3, kept over power-off" }).first()).toBeVisible();
    expect(wrong).toEqual([]);
  });
});

test("a name that another station has is refused with its MAC address", async ({ page }) => {
  await alone(async (server) => {
    await open(page, server);
    const dialog = page.getByRole("dialog");
    await dialog.getByRole("textbox", { name: "Name" }).fill("axis-1");
    await expect(dialog.getByText("the name axis-1 is taken already")).toContainText(await idOf(page, "axis-1"));
    await expect(dialog.getByRole("button", { name: "Set the name" })).toBeDisabled();
  });
});

test("an address is checked while it is typed and set until power-off", async ({ page }) => {
  await alone(async (server) => {
    await open(page, server);
    const dialog = page.getByRole("dialog");
    await dialog.getByRole("checkbox", { name: "Save in the station" }).uncheck();
    await expect(dialog.getByText(/lost at the next power-on/)).toBeVisible();
    const field = dialog.getByRole("textbox", { name: "IP address" });
    const set = dialog.getByRole("button", { name: "Set the address" });
    await field.fill("192.168.77.22");
    await expect(dialog.getByText("the address 192.168.77.22 is taken already")).toBeVisible();
    await field.fill("192.168.77.");
    await expect(dialog.getByText("Addresses have the form 192.168.0.10.")).toBeVisible();
    await expect(set).toBeDisabled();
    await field.fill("192.168.77.29");
    await expect(set).toBeEnabled();
    await set.click();
    await expect(dialog.getByText("Address set: 192.168.77.29.")).toBeVisible();
    await expect(page.getByRole("cell", { name: "192.168.77.29" })).toBeVisible();
    // a drive that a controller has keeps its name
    await dialog.getByRole("button", { name: "Close" }).click();
    await page.getByRole("button", { name: "Name .. press-1" }).click();
    await page.getByRole("dialog").getByRole("textbox", { name: "Name" }).fill("press-9");
    await expect(page.getByRole("dialog").getByText(/plc-1/)).toBeVisible();
  });
});

test("the dialog opens and closes by keys, gives the focus back, and STOP stays within reach", async ({
  entered: page,
}) => {
  const button = page.getByRole("button", { name: "Name .. axis-1" });
  await button.focus();
  await page.keyboard.press("Enter");
  const dialog = page.getByRole("dialog", { name: "Name and address of axis-1" });
  await expect(dialog.getByRole("button", { name: "Blink axis-1" })).toBeFocused();
  for (const [width, height] of [
    [1366, 640],
    [1024, 700],
    [768, 950],
  ] as const) {
    await page.setViewportSize({ width, height });
    const stop = page.getByRole("button", { name: /^STOP/ });
    await stop.click({ trial: true });
  }
  await page.keyboard.press("Escape");
  await expect(dialog).toHaveCount(0);
  await expect(button).toBeFocused();
  await page.keyboard.press("Enter");
  await dialog.getByRole("button", { name: "Close" }).click();
  await expect(button).toBeFocused();
});

test("an axis of this server keeps its name", async ({ page }) => {
  await alone(async (server) => {
    const id = await openControl(page, server.url, "axis-1");
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.getByText(/This page has control/)).toBeVisible();
    const status = await page.evaluate(async (id) => {
      const headers = { "Content-Type": "application/json" };
      const body = '{"name":"axis-9","permanent":true}';
      return (await fetch(`/api/v1/stations/${id}/name`, { method: "POST", headers, body })).status;
    }, id);
    expect(status).toBe(409);
    await expect(page.getByText(/This page has control/)).toBeVisible();
  });
});

test("a view link names nothing", async ({ browser, demo }) => {
  const context = await browser.newContext({ baseURL: demo.origin });
  const page = await context.newPage();
  await page.goto(demo.viewUrl);
  await rows(page);
  await expect(page.getByRole("button", { name: /^(Blink|Name)/ })).toHaveCount(0);
  await context.close();
});

for (const theme of ["light", "dark"] as const) {
  for (const lang of ["", "?lang=xx"]) {
    test(`axe finds nothing in the dialog: ${theme} ${lang}`, async ({ page, demo }) => {
      await page.emulateMedia({ colorScheme: theme });
      await open(page, demo, lang);
      const dialog = page.getByRole("dialog");
      await dialog.getByRole("textbox").first().fill("Axis_3");
      await expect(dialog.locator(".fault")).toBeVisible();
      await dialog.getByRole("checkbox").uncheck();
      await page.evaluate(axe);
      for (const width of [1366, 768]) {
        await page.setViewportSize({ width, height: 768 });
        const violations = await page.evaluate(async () => {
          const found = await (window as unknown as { axe: { run(): Promise<{ violations: unknown[] }> } }).axe.run();
          return found.violations;
        });
        expect(violations).toEqual([]);
      }
      await page.screenshot({ path: `../../../target/workbench/address-${theme}${lang === "" ? "" : "-long"}.png` });
      await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
    });
  }
}
