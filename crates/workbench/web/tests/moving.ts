/** Verbs of the tests that move axes. */
import type { Page } from "@playwright/test";
import { end, expect, idOf, type Running, rows, serve } from "./bench";

/** A server of its own for a test that moves drives. */
export async function alone(test: (server: Running) => Promise<void>): Promise<void> {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await test(server);
  } finally {
    await end(server);
  }
}

/** Enters a page while drives are under control, whatever their status is. */
export async function enter(page: Page, url: string): Promise<void> {
  await page.goto(url);
  await expect(page.getByRole("row")).toHaveCount(7);
}

export async function open(page: Page, url: string, name: string, free = true): Promise<string> {
  await (free ? page.goto(url).then(() => rows(page)) : enter(page, url));
  const id = await idOf(page, name);
  await page.goto(`${new URL(url).origin}/drives/${encodeURIComponent(id)}/control`);
  return id;
}

/** Unfolds what rarely is other than before. */
export async function options(page: Page): Promise<void> {
  await page.getByText(/^Options: /).click();
}

/** Takes control of the drive on the page and enables it. */
export async function enable(page: Page, mode = false): Promise<void> {
  if (mode) {
    await options(page);
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("position");
    await page.getByRole("checkbox", { name: /Set the operating mode/ }).check();
  }
  await page.getByRole("button", { name: "Take control" }).click();
  await expect(page.getByText(/This page has control/)).toBeVisible();
  await page.getByRole("button", { name: "Enable" }).click();
  await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
}

/** Where a shaft really is and how fast it turns, as the plant says beside the server. */
export async function speed(page: Page, origin: string, id: string): Promise<number> {
  const answer = await page.request.get(`${origin}/api/v1/plant/drives`);
  const { drives } = (await answer.json()) as { drives: { id: string; speed: number }[] };
  return drives.find((drive) => drive.id === id)?.speed ?? Number.NaN;
}

/** Waits until the shaft rests; returns after how many ms. */
export async function rest(page: Page, origin: string, id: string, since: number): Promise<number> {
  let stood = Number.NaN;
  await expect
    .poll(
      async () => {
        const now = await speed(page, origin, id);
        if (Math.abs(now) < 0.5 && Number.isNaN(stood)) stood = performance.now() - since;
        return Math.abs(now) < 0.5;
      },
      { intervals: [1] },
    )
    .toBe(true);
  return stood;
}

export async function hold(page: Page, name = "+20 rpm"): Promise<void> {
  const button = page.getByRole("button", { name });
  // the round trip of the first beats is measured before
  await expect(button).toBeEnabled();
  await button.hover();
  await page.mouse.down();
}

/** Holds the jog button until the axis turns. On a computer with much to do the round trip of beats may forbid that for a while. */
export async function turning(page: Page, origin: string, id: string): Promise<void> {
  const button = page.getByRole("button", { name: "+20 rpm" });
  await expect(async () => {
    await page.mouse.up();
    await expect(button).toBeEnabled();
    await hold(page);
    await expect.poll(async () => speed(page, origin, id), { intervals: [5], timeout: 2000 }).toBeGreaterThan(15);
  }).toPass({ timeout: 40_000 });
}

/** What ends a hold, each by its name. */
export function ends(page: Page): [string, () => Promise<unknown>][] {
  const button = page.getByRole("button", { name: "+20 rpm" });
  const fire = (type: string) => button.dispatchEvent(type, { pointerId: 1 });
  return [
    ["pointerup", () => page.mouse.up()],
    ["pointercancel", () => fire("pointercancel")],
    ["lostpointercapture", () => fire("lostpointercapture")],
    ["blur of the window", () => page.evaluate(() => dispatchEvent(new Event("blur")))],
    ["focus into a field", () => page.getByRole("textbox", { name: "Speed" }).focus()],
    ["blur of the pad", () => page.getByRole("button", { name: "Disable" }).focus()],
  ];
}
