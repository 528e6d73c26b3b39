/**
 * From a click to the frame on the cable: with one drive and one page, and with 64 drives and four pages, one of which plots 16
 * signals. Not a part of `make test`: tools/web-bench.
 */
import { type Browser, expect, type Page, test } from "@playwright/test";
import { end, idOfStation, type Running, serve } from "../bench";
import { confirmChecks, type Hand, hands } from "../moving";
import { Verdicts } from "./verdict";
import { type Commanded, clock, type Frame, first, percentile, record, runFirst, turned, wire } from "./wire";

/** Presses of each kind; 500 give a figure of one in a hundred that chance moves little. */
const ROUNDS = Number(process.env.ROUNDS ?? 500);
const DRIVES = Number(process.env.DRIVES ?? 64);
/** Update times of the cyclic connection, ms. */
const CYCLES = (process.env.CYCLES ?? "16,4").split(",").map(Number);

/** What else the server and this computer have to do, and how long 99 of 100 presses of STOP may take beside the cycle, ms. */
const LOADS = [
  { name: "idle", drives: 1, others: 0, stop: 10 },
  { name: "busy", drives: DRIVES, others: 3, stop: 25 },
] as const;
/** The same of a button that is let go, ms. */
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

/** Plots the cyclic frames of an axis under control. */
async function follow(page: Page, server: Running, id: string): Promise<void> {
  await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/scope`);
  await expect(page.getByText(/^cyclic \d+ ms/)).toBeVisible();
}

/** Notes when the page gets what a pointer or a key does, by the clock of the frames. */
async function watchInput(page: Page): Promise<void> {
  await page.evaluate(() => {
    const note = (event: Event) => {
      const kind = ["pointerup", "keyup"].includes(event.type) ? "up" : "down";
      document.documentElement.dataset[kind] = String(performance.timeOrigin + performance.now());
    };
    for (const type of ["pointerdown", "pointerup", "keyup"]) addEventListener(type, note, { capture: true });
  });
}

async function noted(page: Page, kind: "down" | "up"): Promise<number> {
  return Number(await page.evaluate((kind) => document.documentElement.dataset[kind], kind));
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

/** When this process asks the browser for the press that ends a motion, and when the page has it. */
interface Press {
  asked: number;
  had: number;
}

/** Of a hundred motions so many may have ended before the press: a hold whose beats were late ends by its deadline. */
const ENDED = 1;

/** Judges how long presses took: from before the browser was asked for them to the frame with what they command. */
function judge(
  verdicts: Verdicts,
  name: string,
  pressed: Press[],
  { frames, to }: { frames: Frame[]; to: string },
  wanted: (of: Commanded) => boolean,
  limit: number,
  never: number | null,
): void {
  const presses = pressed.filter(({ asked }) => turned(frames, to, asked));
  const ended = pressed.length - presses.length;
  verdicts.most(`${name}, ended before`, ended, Math.ceil((pressed.length * ENDED) / 100), "times", "", 0);
  const all = presses.map(({ asked }) => (first(frames, to, asked, wanted) ?? Number.POSITIVE_INFINITY) - asked);
  const after = all.map((time, at) => time - ((presses[at]?.had ?? 0) - (presses[at]?.asked ?? 0)));
  const [median, most] = [50, 100].map((percent) => percentile(all, percent).toFixed(1));
  // how long this browser has its pages drawn before it passes an event on is no property of the page or the server
  const page = `from the page to the frame p99 ${percentile(after, 99).toFixed(1)} ms`;
  const more = `median ${median} ms, max ${most} ms, ${page}, ${all.length} times`;
  verdicts.most(`${name}, p99`, percentile(all, 99), limit, "ms", more);
  if (never !== null) verdicts.most(`${name}, max`, Math.max(...all), never, "ms");
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
        await confirmChecks(page);
        await page.getByRole("button", { name: "Take control" }).click();
        await expect(page.getByText(/This page has control/)).toBeVisible();
        await expect(page.locator(".frame [data-link]")).toHaveText(new RegExp(`^${cycle} ms`));
        const enable = page.getByRole("button", { name: "Enable" });
        const on = page.locator("main").getByText("Torque on, at rest");
        const moves = page.locator("main").getByText("Torque on, moving");
        await enable.click();
        await expect(on).toBeVisible();
        const button = page.getByRole("button", { name: "+20 rpm" });
        if (others[1] !== undefined) await follow(others[1], server, id);
        await page.bringToFront();
        const ways = await hands(page);
        const { frames } = await record();
        await watchInput(page);
        runFirst();
        const [releases, stops]: [Press[], Press[]] = [[], []];
        for (let round = 0; round < ROUNDS; round += 1) {
          const hand = ways[round % ways.length] as Hand;
          // where the round trip of beats forbids it, it is tried again
          await expect(async () => {
            await hand.up();
            await expect(button).toBeEnabled();
            await hand.reach();
            await hand.down();
            await expect(moves).toBeVisible({ timeout: 1000 });
          }).toPass({ timeout: 60_000 });
          const asked = clock();
          await hand.up();
          releases.push({ asked, had: await noted(page, "up") });
          await expect(on).toBeVisible();
        }
        const stop = page.getByRole("button", { name: /^STOP/ });
        for (let round = 0; round < ROUNDS; round += 1) {
          await page.getByRole("tab", { name: "Velocity" }).click();
          await page.getByRole("button", { name: "Turn at this speed" }).click();
          await expect(moves).toBeVisible();
          await stop.hover();
          const asked = clock();
          await page.mouse.down();
          await page.mouse.up();
          stops.push({ asked, had: await noted(page, "down") });
          await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
          await page.getByRole("button", { name: "Reset STOP" }).click();
          await enable.click();
          await expect(on).toBeVisible();
        }
        const all = await frames();
        const to = id.replaceAll(":", "");
        const where = `${cycle} ms, ${load.drives} drives, ${pages} pages`;
        const seen = { frames: all, to };
        const verdicts = new Verdicts();
        const zero = ({ speed }: Commanded) => speed === 0;
        const never = cycle === NEVER.cycle ? NEVER.limit : null;
        for (const [place, { name }] of ways.entries()) {
          const own = releases.filter((_, round) => round % ways.length === place);
          judge(verdicts, `${name} up -> frame with setpoint 0, ${where}`, own, seen, zero, cycle + RELEASE, never);
        }
        const off3 = ({ quickStop }: Commanded) => quickStop;
        judge(verdicts, `STOP -> frame with OFF3, ${where}`, stops, seen, off3, cycle + load.stop, null);
        verdicts.end();
        await Promise.all(others.map((other) => other.context().close()));
        await page.context().close();
      } finally {
        await end(server);
        cable.end();
      }
    });
  }
}
