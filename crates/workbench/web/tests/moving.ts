/** Verbs of the tests that move axes. */
import type { Page } from "@playwright/test";
import { expect, idOf, rows } from "./bench";
import { commanded, type Frame, parse } from "./bench/wire";

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

/** Writes parameters of a drive as a program does it, beside what the page shows. */
export async function write(page: Page, id: string, values: Record<string, string>): Promise<void> {
  const changes = Object.entries(values).map(([parameter, value]) => ({ parameter, value }));
  const status = await page.evaluate(
    async ({ id, changes }) => {
      const post = (path: string, body: unknown) => {
        const headers = { "Content-Type": "application/json" };
        return fetch(`/api/v1/${path}`, { method: "POST", headers, body: JSON.stringify(body) });
      };
      const planned = await post(`drives/${encodeURIComponent(id)}/plans`, { changes, save: false });
      const plan = (await planned.json()) as { id: number };
      return (await post(`plans/${plan.id}/apply`, {})).status;
    },
    { id, changes },
  );
  expect(status).toBe(200);
  // it is written by and by
  const number = Object.keys(values).join(",");
  const wanted = Object.values(values);
  await expect
    .poll(async () => {
      const path = `/api/v1/drives/${encodeURIComponent(id)}/values/${encodeURIComponent(number)}`;
      const answer = await page.request.get(new URL(path, page.url()).href);
      return ((await answer.json()) as { parameters: { text: string }[] }).parameters.map(({ text }) => text);
    }, number)
    .toEqual(wanted);
}

/** Where a shaft really is and how fast it turns, as the plant says beside the server. */
export async function speed(page: Page, origin: string, id: string): Promise<number> {
  return (await shaft(page, origin, id)).speed;
}

export async function shaft(page: Page, origin: string, id: string): Promise<{ position: number; speed: number }> {
  const answer = await page.request.get(`${origin}/api/v1/plant/drives`);
  const { drives } = (await answer.json()) as { drives: { id: string; position: number; speed: number }[] };
  return drives.find((drive) => drive.id === id) ?? { position: Number.NaN, speed: Number.NaN };
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

interface Node {
  name: string;
  start: number;
  end: number;
  children?: Node[];
}

function nodes(node: Node): Node[] {
  return [node, ...(node.children ?? []).flatMap(nodes)];
}

/** The set speed in the last frame to a drive, in steps of its telegram. */
export async function setpoint(page: Page, origin: string, id: string): Promise<number> {
  const answer = await page.request.get(`${origin}/api/v1/drives/${encodeURIComponent(id)}/telegram`);
  const { halves } = (await answer.json()) as { halves: { direction: string; octets: string; tree: Node }[] };
  const output = halves.find(({ direction }) => direction === "output");
  const field = output && nodes(output.tree).find(({ name }) => name === "NSOLL_A");
  if (output === undefined || field === undefined) return Number.NaN;
  return Buffer.from(output.octets.replaceAll(" ", ""), "hex").readInt16BE(field.start);
}

/** The frames to a drive of the last minute. */
export async function sent(page: Page, origin: string, id: string): Promise<Frame[]> {
  const answer = await page.request.get(`${origin}/api/v1/traffic`);
  return parse(await answer.body()).filter(({ to }) => to === id.replaceAll(":", ""));
}

/** Waits for the next frames to a drive with telegram 1, in each of which the setpoint has to be 0. */
export async function stays(page: Page, origin: string, id: string): Promise<void> {
  const since = (await sent(page, origin, id)).at(-1)?.time ?? Number.NaN;
  let next: Frame[] = [];
  const count = async () => {
    next = (await sent(page, origin, id)).filter(({ time }) => time > since);
    return next.length;
  };
  await expect.poll(count).toBeGreaterThan(20);
  expect(next.filter((frame) => commanded(frame).speed !== 0)).toEqual([]);
}

/** What a button is held with. */
export interface Hand {
  name: string;
  /** Brings it to the button. */
  reach(): Promise<void>;
  down(): Promise<void>;
  up(): Promise<void>;
  /** Lets the browser take the finger for something else, as it does when it scrolls. */
  cancel?(): Promise<void>;
}

/** Mouse, finger and key, on the button for this speed. */
export async function hands(page: Page): Promise<Hand[]> {
  const button = page.getByRole("button", { name: "+20 rpm" });
  const protocol = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchEnd" | "touchCancel", touchPoints: { x: number; y: number }[]) =>
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
      async cancel() {
        await touch("touchCancel", []);
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

export async function hold(page: Page, name = "+20 rpm"): Promise<void> {
  const button = page.getByRole("button", { name });
  // the round trip of the first beats is measured before
  await expect(button).toBeEnabled();
  await button.hover();
  await page.mouse.down();
}

/** Holds the jog button until the axis turns. On a computer with much to do the round trip of beats may forbid that for a while. */
export async function turning(page: Page, origin: string, id: string, name = "+20 rpm", least = 15): Promise<void> {
  const hand = {
    up: () => page.mouse.up(),
    reach: () => page.getByRole("button", { name }).hover(),
    down: () => page.mouse.down(),
  };
  await turningBy(page, origin, id, hand, name, least);
}

/** The same with another hand than the mouse. */
export async function turningBy(
  page: Page,
  origin: string,
  id: string,
  hand: Pick<Hand, "reach" | "down" | "up">,
  name = "+20 rpm",
  least = 15,
): Promise<void> {
  const button = page.getByRole("button", { name });
  await expect(async () => {
    await hand.up();
    await expect(button).toBeEnabled();
    await hand.reach();
    await hand.down();
    await expect.poll(async () => speed(page, origin, id), { intervals: [5], timeout: 2000 }).toBeGreaterThan(least);
  }).toPass({ timeout: 40_000 });
}

/** A way in which a hold ends. */
export interface End {
  name: string;
  /** What holds the button. */
  hand: Hand;
  end(): Promise<unknown>;
  /** What puts the page back, where something has to. */
  back?(): Promise<unknown>;
  /** Whether the page gives control back as well. */
  releases?: boolean;
}

/** Lets beats wait that are sent while `late` is set on the page. Called before the page is opened. */
export async function withLateBeats(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (data) {
      const late = (window as unknown as { late?: boolean }).late === true;
      if (late && typeof data === "string" && data.includes('"beat"')) setTimeout(() => send.call(this, data), 300);
      else send.call(this, data);
    };
  });
}

/** All that ends a hold; the page was prepared by `withLateBeats`. */
export async function ends(page: Page): Promise<End[]> {
  const [mouse, touch, key] = (await hands(page)) as [Hand, Hand, Hand];
  const button = page.getByRole("button", { name: "+20 rpm" });
  const hidden = (value: boolean) =>
    page.evaluate((value) => {
      Object.defineProperty(document, "hidden", { value, configurable: true });
      document.dispatchEvent(new Event("visibilitychange"));
    }, value);
  const late = (late: boolean) => page.evaluate((late) => Object.assign(window, { late }), late);
  return [
    { name: "pointerup", hand: mouse, end: mouse.up },
    { name: "pointerup of a finger", hand: touch, end: touch.up },
    { name: "pointercancel", hand: touch, end: async () => touch.cancel?.() },
    {
      name: "lostpointercapture",
      hand: mouse,
      // as when something else takes the pointer; the browser reports it with its next event, which is on the button still
      async end() {
        await button.evaluate((one) => one.releasePointerCapture(1));
        const { x = 0, y = 0, width = 0, height = 0 } = (await button.boundingBox()) ?? {};
        await page.mouse.move(x + width / 2 + 2, y + height / 2);
      },
    },
    { name: "keyup", hand: key, end: key.up },
    { name: "blur of the window", hand: mouse, end: () => page.evaluate(() => dispatchEvent(new Event("blur"))) },
    { name: "blur of the pad", hand: mouse, end: () => page.getByRole("button", { name: "Disable" }).focus() },
    {
      name: "focus into a field",
      hand: mouse,
      end: () => page.getByRole("textbox", { name: "Speed" }).focus(),
    },
    { name: "dialog", hand: mouse, end: () => page.keyboard.press("?"), back: () => page.keyboard.press("Escape") },
    { name: "late beat", hand: mouse, end: () => late(true), back: () => late(false) },
    { name: "hidden tab", hand: mouse, end: () => hidden(true), back: () => hidden(false), releases: true },
    {
      name: "pagehide",
      hand: mouse,
      end: () => page.evaluate(() => dispatchEvent(new Event("pagehide"))),
      back: () => page.reload(),
      releases: true,
    },
  ];
}
