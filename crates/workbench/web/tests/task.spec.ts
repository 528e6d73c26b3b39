/** The task of a commissioning engineer, whole: by the keyboard alone, then by the mouse. */
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Locator, Page } from "@playwright/test";
import { end, expect, idOf, pictures, type Running, serve, test, watch } from "./bench";

/** Eight drives of three vendors; of one the fault keeps it from running. */
function plant(broken: number): string {
  const file = join(pictures, "task.toml");
  const drive = (place: number, name: string, more: string) =>
    `[[drive]]\nname = "${name}"\nip = "192.168.77.${place + 30}/24"\n${more}`;
  const fault = 'event = [{ at = "0s", do = "fault=439" }]\n';
  const rows = ["servo-1", "servo-2", "servo-3", "servo-4"].map((name, place) =>
    drive(place, name, place === broken ? fault : ""),
  );
  rows.push(drive(4, "pump-1", 'model = "vlt"\n'), drive(5, "pump-2", 'model = "vlt"\n'));
  rows.push(drive(6, "fan-1", 'model = "vacon"\n'), drive(7, "fan-2", 'model = "vacon"\n'));
  writeFileSync(file, rows.join("\n"));
  return file;
}

async function speed(page: Page, server: Running, id: string): Promise<number> {
  const answer = await page.request.get(`${server.origin}/api/v1/plant/drives`);
  const { drives } = (await answer.json()) as { drives: { id: string; speed: number }[] };
  return drives.find((drive) => drive.id === id)?.speed ?? Number.NaN;
}

/** How a person uses the page. */
interface Hand {
  /** Follows a link that is seen, whatever it is called. */
  follow(link: Locator): Promise<void>;
  /** Activates a link or a button. */
  press(role: "link" | "button", name: string): Promise<void>;
  /** Opens a screen. */
  screen(name: string, letter: string): Promise<void>;
  /** Writes into a field in place of what it has. */
  write(role: "textbox" | "searchbox", name: string, text: string): Promise<void>;
  hold(): Promise<void>;
  letGo(): Promise<void>;
}

/** Moves the focus by the tab key alone until it is on this element. */
async function reach(page: Page, wanted: Locator): Promise<void> {
  await expect(wanted).toBeEnabled();
  for (let press = 0; press < 400; press += 1) {
    if (await wanted.evaluate((element) => element === document.activeElement)) return;
    await page.keyboard.press("Tab");
  }
  throw new Error(`the tab key does not reach ${wanted}`);
}

/** The first element of this role and name. */
function named(page: Page, role: "link" | "button" | "textbox" | "searchbox", name: string): Locator {
  return page.getByRole(role, { name, exact: role !== "searchbox" }).first();
}

const keyboard = (page: Page): Hand => ({
  async follow(link) {
    await reach(page, link);
    await page.keyboard.press("Enter");
  },
  async press(role, name) {
    await reach(page, named(page, role, name));
    await page.keyboard.press("Enter");
  },
  async screen(_, letter) {
    // a letter in a field is a text: the tab key leaves it
    const typing = () => page.evaluate(() => document.activeElement?.matches("input, textarea, select") ?? false);
    for (let press = 0; press < 20 && (await typing()); press += 1) await page.keyboard.press("Tab");
    await page.keyboard.press("g");
    await page.keyboard.press(letter);
  },
  async write(role, name, text) {
    await reach(page, named(page, role, name));
    await page.keyboard.press("Control+a");
    await page.keyboard.type(text);
  },
  async hold() {
    await reach(page, named(page, "button", "+20 rpm"));
    await page.keyboard.down("ArrowRight");
  },
  async letGo() {
    await page.keyboard.up("ArrowRight");
  },
});

const mouse = (page: Page): Hand => ({
  async follow(link) {
    await link.click();
  },
  async press(role, name) {
    await named(page, role, name).click();
  },
  async screen(name) {
    await page.getByRole("link", { name, exact: true }).click();
  },
  async write(role, name, text) {
    await page.getByRole(role, { name, exact: role !== "searchbox" }).click({ clickCount: 3 });
    await page.keyboard.type(text);
  },
  async hold() {
    await page.getByRole("button", { name: "+20 rpm" }).hover();
    await page.mouse.down();
  },
  async letGo() {
    await page.mouse.up();
  },
});

for (const [how, hand, broken] of [
  ["the keyboard alone", keyboard, 1],
  ["the mouse", mouse, 2],
] as const) {
  test(`of eight drives the one that does not run is found, fixed, tuned, jogged and recorded by ${how}`, async ({
    page,
  }) => {
    const server = await serve("--plant", plant(broken), "--listen", "127.0.0.1:0");
    const wrong = watch(page);
    const by = hand(page);
    try {
      await page.goto(server.url);
      await expect(page.getByRole("row")).toHaveCount(9);
      await expect(page.getByText("no controller is connected")).toHaveCount(7);
      // the worst is on top, and the only one with a fault
      const worst = page.getByRole("row").nth(1);
      await expect(worst).toContainText("F439");
      await expect(page.getByRole("row", { name: "F439" })).toHaveCount(1);
      const found = worst.getByRole("link").first();
      const name = (await found.textContent()) ?? "";
      const id = await idOf(page, name);
      await by.follow(found);
      await expect(page.getByRole("heading", { level: 1, name })).toBeVisible();
      await expect(page.locator(".why-not")).toHaveAttribute("data-cause", "fault");
      await by.press("button", "Acknowledge");
      await expect(page.locator(".why-not")).not.toHaveAttribute("data-cause", "fault");

      await by.screen("Parameters", "p");
      await by.write("searchbox", "", "DRV.ACC");
      await expect(page.getByRole("textbox", { name: "Value of DRV.ACC", exact: true })).toHaveValue("3000");
      await by.write("textbox", "Value of DRV.ACC", "100 rpm/s");
      const changes = page.getByRole("region", { name: "Changes" });
      await expect(changes).toContainText("3000 \u2192 100 rpm/s");
      await by.press("button", "Apply 1");
      await expect(changes).toContainText("written and verified");

      await by.screen("Control", "c");
      await by.press("button", "Take control");
      await expect(page.getByText(/This page has control/)).toBeVisible();
      await by.press("button", "Enable");
      await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
      await by.press("button", "Record the next step");
      await expect(page.getByText("Waiting for a step of the set speed ..")).toBeVisible();
      await expect(async () => {
        await by.letGo();
        await by.hold();
        await expect.poll(() => speed(page, server, id), { intervals: [5], timeout: 2000 }).toBeGreaterThan(19);
      }).toPass({ timeout: 30_000 });
      await by.letGo();
      await expect(page.getByText("The step is recorded.")).toBeVisible();
      await by.press("link", "Open in Scope");
      await expect(page.getByText("Stopped", { exact: true })).toBeVisible();
      await expect(page.getByText(/^cyclic 16 ms/)).toBeVisible();
      // the set speed steps, and the speed follows by the new ramp
      const row = (signal: string) => page.getByRole("row", { name: signal });
      await expect(row("NSOLL_A")).toContainText(/(19|20)\.\d/);
      await expect(row("NIST_A")).toContainText(/(19|20)\.\d/);
      await page.screenshot({ path: join(pictures, `task-${how.split(" ").at(-1)}.png`) });
      const download = page.waitForEvent("download");
      await by.press("button", "Save picture");
      const picture = await download;
      expect(picture.suggestedFilename()).toMatch(new RegExp(`^${name}-.*\\.png$`));
      expect(readFileSync(await picture.path()).length).toBeGreaterThan(5000);

      await by.screen("Control", "c");
      await by.press("button", "Disable");
      await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
      await by.press("button", "Release");
      await expect(page.getByText("Not under control")).toBeVisible();
      expect(wrong).toEqual([]);
    } finally {
      await end(server);
    }
  });
}
