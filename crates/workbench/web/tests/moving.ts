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

/** Confirms what a person has seen of a real machine. */
export async function confirmChecks(page: Page): Promise<void> {
  for (const line of ["I see the axis", "The travel range", "I can reach"]) {
    await page.getByRole("checkbox", { name: line }).check();
  }
}

/** Takes control of the drive on the page and enables it. */
export async function enable(page: Page, mode = false): Promise<void> {
  if (mode) {
    await options(page);
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("position");
    await page.getByRole("checkbox", { name: /Set the operating mode/ }).check();
  }
  await operate(page);
}

/** Whether a page could send its beats: the longest time without a frame, in ms, and in how many frames beats were late or missing. */
interface Beats {
  gap: number;
  late: number;
}

/** Takes control and enables, as the page offers it, and notes from then on whether its beats are in time. */
export async function operate(page: Page): Promise<void> {
  await page.evaluate(() => {
    if ("beats" in window) return;
    const beats: Beats = { gap: 0, late: 0 };
    Object.assign(window, { beats });
    let last = performance.now();
    const turn = () => {
      const now = performance.now();
      beats.gap = Math.max(beats.gap, now - last);
      last = now;
      if (document.querySelector(".beat.late, .beat.missing") !== null) beats.late += 1;
      requestAnimationFrame(turn);
    };
    requestAnimationFrame(turn);
  });
  await page.getByRole("button", { name: "Take control" }).click();
  await expect(page.getByText(/This page has control/)).toBeVisible();
  await page.getByRole("button", { name: "Enable" }).click({ timeout: 10_000 });
  await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
}

/**
 * Does something under control, and begins again where control was lost because beats were late: a page that has no time for them for a
 * second loses control, as it must, and on a computer with much to do it may have none. Every other failure is one, also a loss of
 * control whose beats were in time.
 */
export async function underControl(page: Page, steps: () => Promise<void>): Promise<void> {
  for (let left = 3; ; left -= 1) {
    try {
      return await steps();
    } catch (error) {
      const beats = await page.evaluate(() => (window as unknown as { beats?: Beats }).beats);
      const lost = await page.getByRole("button", { name: "Take control" }).isVisible();
      const late = beats !== undefined && (beats.gap > 200 || beats.late > 0);
      if (!lost || !late || left === 0) throw error;
      console.log(
        `control was lost, with ${beats.gap.toFixed(0)} ms without a frame and ${beats.late} frames with late beats`,
      );
      await page.mouse.up();
    }
  }
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
export async function turning(page: Page, origin: string, id: string, name = "+20 rpm", least = 15): Promise<void> {
  const button = page.getByRole("button", { name });
  await expect(async () => {
    await page.mouse.up();
    await expect(button).toBeEnabled();
    await hold(page, name);
    await expect.poll(async () => speed(page, origin, id), { intervals: [5], timeout: 2000 }).toBeGreaterThan(least);
  }).toPass({ timeout: 40_000 });
}

/** What a button is held with. */
export interface Hand {
  name: string;
  /** Brings it to the button. */
  reach(): Promise<void>;
  down(): Promise<void>;
  up(): Promise<void>;
}

/** Mouse, finger and key, on the button for this speed. */
export async function hands(page: Page): Promise<Hand[]> {
  const button = page.getByRole("button", { name: "+20 rpm" });
  const protocol = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchEnd", touchPoints: { x: number; y: number }[]) =>
    protocol.send("Input.dispatchTouchEvent", { type, touchPoints });
  let place = { x: 0, y: 0 };
  let touched = false;
  return [
    { name: "mouse", reach: () => button.hover(), down: () => page.mouse.down(), up: () => page.mouse.up() },
    {
      name: "touch",
      async reach() {
        const { x = 0, y = 0, width = 0, height = 0 } = (await button.boundingBox()) ?? {};
        place = { x: x + width / 2, y: y + height / 2 };
      },
      async down() {
        touched = true;
        await touch("touchStart", [place]);
      },
      async up() {
        // the browser refuses the end of nothing
        if (touched) await touch("touchEnd", []);
        touched = false;
      },
    },
    {
      name: "key",
      reach: () => button.focus(),
      down: () => page.keyboard.down("ArrowRight"),
      up: () => page.keyboard.up("ArrowRight"),
    },
  ];
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
