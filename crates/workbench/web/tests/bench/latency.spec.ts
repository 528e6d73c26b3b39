/**
 * From a click to the frame on the cable: with one drive and one page, and with 64 drives and four pages, one of which plots 16
 * signals. Not a part of `make test`: tools/web-bench.
 */
import { type Browser, expect, type Page, test } from "@playwright/test";
import { end, idOfStation, type Running, serve } from "../bench";
import { changed, clock, type Frame, percentile, record, runFirst, same, wire } from "./wire";

/** Presses of each kind; 500 give a figure of one in a hundred that chance moves little. */
const ROUNDS = Number(process.env.ROUNDS ?? 100);
const DRIVES = Number(process.env.DRIVES ?? 64);
/** Update times of the cyclic connection, ms. */
const CYCLES = (process.env.CYCLES ?? "16,4").split(",").map(Number);

/** What else the server and this computer have to do, and how long 99 of 100 presses of STOP may take beside the cycle, ms. */
const LOADS = [
  { name: "idle", drives: 1, others: 0, stop: 10 },
  { name: "busy", drives: DRIVES, others: 3, stop: 25 },
] as const;
/** The same of a button that goes up, ms. */
const RELEASE = 20;
/** With this cycle no button that goes up may take longer than that, ms. */
const NEVER = { cycle: 16, limit: 50 };

async function open(browser: Browser, url: string, drives: number): Promise<Page> {
  const page = await (await browser.newContext()).newPage();
  await page.goto(url);
  await expect(page.getByRole("row")).toHaveCount(drives + 1, { timeout: 30_000 });
  return page;
}

/** Plots 16 signals with a row each millisecond. */
async function plot(page: Page, server: Running, id: string): Promise<void> {
  await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/scope`);
  await page.getByRole("combobox", { name: "Source" }).selectOption("test");
  await expect(page.getByText(/test signal, \d+/)).toBeVisible();
}

/** Notes when the page gets what a pointer does, by the clock of the frames. */
async function watchPointer(page: Page): Promise<void> {
  await page.evaluate(() => {
    const note = (event: Event) => {
      document.documentElement.dataset[event.type] = String(performance.timeOrigin + performance.now());
    };
    for (const type of ["pointerdown", "pointerup"]) addEventListener(type, note, { capture: true });
  });
}

async function noted(page: Page, type: "pointerdown" | "pointerup"): Promise<number> {
  return Number(await page.evaluate((type) => document.documentElement.dataset[type], type));
}

/** Lets a page take its axis with this update time, ms: the page itself has no choice of it. */
async function withCycle(page: Page, cycle: number): Promise<void> {
  await page.addInitScript((cycle_ms) => {
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (data) {
      const takes = typeof data === "string" && data.includes('"type":"take"');
      send.call(this, takes ? JSON.stringify({ ...JSON.parse(data), cycle_ms }) : data);
    };
  }, cycle);
}

/** When the motion was begun, when this process asks the browser for the press that ends it, and when the page has that. */
interface Press {
  begun: number;
  asked: number;
  had: number;
}

/** Prints how long presses took; returns how long from the page to the frame. */
function took(name: string, pressed: Press[], frames: Frame[], to: string, limit: number): number[] {
  // a hold whose beats were late has ended by its deadline, before the button went up
  const presses = pressed.filter(({ begun, asked }) => !same(frames, to, begun, asked));
  expect(presses.length, `${name}: motions that lasted until the press`).toBeGreaterThanOrEqual(0.9 * pressed.length);
  const all = presses.map(({ asked }) => (changed(frames, to, asked) ?? Number.POSITIVE_INFINITY) - asked);
  const before = presses.map(({ asked, had }) => had - asked);
  const after = all.map((time, at) => time - (before[at] ?? 0));
  const of = (times: number[]) => {
    const [median, p99, most] = [50, 99, 100].map((percent) => percentile(times, percent).toFixed(1));
    return `median ${median} ms, p99 ${p99} ms, max ${most} ms`;
  };
  console.log(
    `${name}: ${of(all)}, ${presses.length} times, ${pressed.length - presses.length} ended before\n` +
      `  until the page has it: ${of(before)}\n  from the page to the frame: ${of(after)} (limit of p99 ${limit} ms)`,
  );
  // how long this browser has its pages drawn before it passes an event on is no property of the page or the server
  return after;
}

for (const cycle of CYCLES) {
  for (const load of LOADS) {
    const pages = load.others + 1;
    test(`from a press to the frame, ${cycle} ms, ${load.name}`, async ({ browser }) => {
      test.setTimeout(120_000 + ROUNDS * 20_000);
      const cable = wire(load.drives);
      const server = await serve("-i", "bench-here", "--listen", "127.0.0.1:0");
      try {
        const page = await open(browser, server.url, load.drives);
        const others = await Promise.all(
          Array.from({ length: load.others }, () => open(browser, server.viewUrl, load.drives)),
        );
        const id = await idOfStation(page, "axis-1");
        if (others[0] !== undefined) await plot(others[0], server, id);
        // the browser gives the page less time while another one is in front
        await page.bringToFront();
        await withCycle(page, cycle);
        await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
        const checks = page.getByRole("checkbox");
        await expect(checks.first()).toBeVisible();
        for (const check of await checks.all()) await check.check();
        await page.getByRole("button", { name: "Take control" }).click();
        await expect(page.getByText(/This page has control/)).toBeVisible();
        await expect(page.locator(".frame [data-link]")).toHaveText(new RegExp(`^${cycle} ms`));
        const enable = page.getByRole("button", { name: "Enable" });
        const on = page.locator("main").getByText("Torque on, at rest");
        const moves = page.locator("main").getByText("Torque on, moving");
        await enable.click();
        await expect(on).toBeVisible();
        const button = page.getByRole("button", { name: "+20 rpm" });
        const { frames } = await record();
        await watchPointer(page);
        runFirst();
        const [releases, stops]: [Press[], Press[]] = [[], []];
        for (let round = 0; round < ROUNDS; round += 1) {
          // where the round trip of beats forbids it, it is tried again
          let begun = 0;
          await expect(async () => {
            await page.mouse.up();
            await expect(button).toBeEnabled();
            await button.hover();
            begun = clock();
            await page.mouse.down();
            await expect(moves).toBeVisible({ timeout: 1000 });
          }).toPass({ timeout: 60_000 });
          const asked = clock();
          await page.mouse.up();
          releases.push({ begun, asked, had: await noted(page, "pointerup") });
          await expect(on).toBeVisible();
        }
        const stop = page.getByRole("button", { name: /^STOP/ });
        for (let round = 0; round < ROUNDS; round += 1) {
          await page.getByRole("tab", { name: "Velocity" }).click();
          const begun = clock();
          await page.getByRole("button", { name: "Turn at this speed" }).click();
          await expect(moves).toBeVisible();
          await stop.hover();
          const asked = clock();
          await page.mouse.down();
          await page.mouse.up();
          stops.push({ begun, asked, had: await noted(page, "pointerdown") });
          await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
          await page.getByRole("button", { name: "Reset STOP" }).click();
          await enable.click();
          await expect(on).toBeVisible();
        }
        const all = await frames();
        const to = id.replaceAll(":", "");
        const slow: string[] = [];
        const where = `${cycle} ms, ${load.drives} drives, ${pages} pages`;
        for (const [name, presses, limit, never] of [
          ["button up -> frame with setpoint 0", releases, cycle + RELEASE, cycle === NEVER.cycle ? NEVER.limit : null],
          ["STOP -> frame", stops, cycle + load.stop, null],
        ] as const) {
          const after = took(`${name}, ${where}`, presses, all, to, limit);
          if (!(percentile(after, 99) <= limit)) slow.push(name);
          if (never !== null && !(Math.max(...after) <= never)) slow.push(`${name}, never over ${never} ms`);
        }
        // all of them are measured before one of them is missed
        expect(slow).toEqual([]);
        await Promise.all(others.map((other) => other.context().close()));
        await page.context().close();
      } finally {
        await end(server);
        cable.end();
      }
    });
  }
}
