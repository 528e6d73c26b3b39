/**
 * A page that is frozen, killed or cut off while a button is held, and a server that ends: how long the axis goes on. The frames on
 * the cable decide, and what the drive reports. Not a part of `make test`: tools/web-bench.
 */
import { type Browser, type BrowserContext, expect, type Page, test } from "@playwright/test";
import { end, idOfStation, type Running, serve } from "../bench";
import { confirmChecks } from "../moving";
import { remote, renderers } from "./browser";
import { Verdicts } from "./verdict";
import { clock, first, percentile, record, runFirst, turned, wire } from "./wire";

const ROUNDS = Number(process.env.ROUNDS ?? 50);
/** Update time of the cyclic connection, ms, as the page takes it. */
const CYCLE = 16;
/** Most time from the end of a page to a frame with setpoint 0, ms: the time of a hold without a beat, and two cycles. */
const HOLD = 200 + 2 * CYCLE;
/** The same to a frame with OFF1: without beats control lasts a second. */
const LEASE = 1000 + 2 * CYCLE;
/** Most time to the fault of the drive once the server is gone, ms: the watchdog of the connection counts seven cycles. */
const WATCHDOG = 7 * CYCLE + 2 * CYCLE;

/** Opens Control of the drive in a context that is let in, takes it and enables it. */
async function control(context: BrowserContext, server: Running, id: string): Promise<Page> {
  const page = await context.newPage();
  await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
  await expect(page.getByRole("button", { name: "Take control" })).toBeVisible();
  await confirmChecks(page);
  await page.getByRole("button", { name: "Take control" }).click();
  await expect(page.getByText(/This page has control/)).toBeVisible();
  await page.getByRole("button", { name: "Enable" }).click();
  await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
  return page;
}

/** Holds a button until the axis turns. Where the round trip of beats forbids a jog, it is tried again. */
async function jog(page: Page): Promise<void> {
  const button = page.getByRole("button", { name: "+20 rpm" });
  await expect(async () => {
    await page.mouse.up();
    await expect(button).toBeEnabled();
    await button.hover();
    await page.mouse.down();
    await expect(page.locator("main").getByText("Torque on, moving")).toBeVisible({ timeout: 1000 });
  }).toPass({ timeout: 60_000 });
}

/** Enters a context with the link of the server; returns what its drive is called in paths. */
async function enter(context: BrowserContext, server: Running): Promise<string> {
  const page = await context.newPage();
  await page.goto(server.url);
  await expect(page.getByRole("row", { name: "axis-1" })).toContainText("no controller is connected", {
    timeout: 30_000,
  });
  const id = await idOfStation(page, "axis-1");
  await page.close();
  return id;
}

/** A way in which a page ends. */
interface Way {
  /** Ends it; returns what is done before the next round. */
  end(page: Page, browser: Browser): Promise<() => Promise<void> | void>;
  /** Whether the server notices the end of the connection, and takes control back at once. */
  noticed: boolean;
}

/** Lets the page end again and again, and judges the frames. */
async function measure(name: string, browser: Browser, context: BrowserContext, server: Running, way: Way) {
  const id = await enter(context, server);
  const token = new URL(server.url).hash.replace("#token=", "");
  // the server says beside the page whether it still has the axis
  const held = async () => {
    const headers = { Authorization: `Bearer ${token}` };
    const answer = await context.request.get(`${server.origin}/api/v1/server`, { headers });
    return ((await answer.json()) as { controlled: string[] }).controlled.length;
  };
  const { frames } = await record();
  const times: number[] = [];
  for (let round = 0; round < ROUNDS; round += 1) {
    const page = await control(context, server, id);
    await jog(page);
    const from = clock();
    const next = await way.end(page, browser);
    times.push(from);
    await expect.poll(held, `${name}: control ends`).toBe(0);
    await next();
    await page.close();
  }
  const [all, to] = [await frames(), id.replaceAll(":", "")];
  const verdicts = new Verdicts();
  const moving = times.filter((time) => turned(all, to, time));
  const took = (wanted: Parameters<typeof first>[3]) =>
    moving.map((time) => (first(all, to, time, wanted) ?? Number.POSITIVE_INFINITY) - time);
  const [zero, off] = [took(({ speed }) => speed === 0), took(({ on }) => !on)];
  const of = (values: number[]) => `median ${percentile(values, 50).toFixed(1)} ms, ${values.length} times`;
  verdicts.least(`${name}, motions that lasted until then`, moving.length, Math.ceil(0.98 * ROUNDS), "times", "", 0);
  verdicts.most(`${name} -> setpoint 0, max`, Math.max(...zero), HOLD, "ms", of(zero));
  verdicts.most(`${name} -> OFF1, max`, Math.max(...off), way.noticed ? HOLD : LEASE, "ms", of(off));
  verdicts.end();
}

for (const [name, signal] of [
  ["page frozen (SIGSTOP)", "SIGSTOP"],
  ["page killed (SIGKILL)", "SIGKILL"],
] as const) {
  test(name, async ({ browser }) => {
    test.setTimeout(120_000 + ROUNDS * 20_000);
    const cable = wire(1);
    const server = await serve("-i", "bench-here", "--listen", "127.0.0.1:0");
    try {
      runFirst();
      await measure(name, browser, await browser.newContext(), server, {
        noticed: signal === "SIGKILL",
        async end(_, browser) {
          const all = await renderers(browser);
          expect(all.length).toBeGreaterThan(0);
          for (const pid of all) process.kill(pid, signal);
          return () => {
            if (signal === "SIGKILL") return;
            for (const pid of all) process.kill(pid, "SIGCONT");
          };
        },
      });
    } finally {
      await end(server);
      cable.end();
    }
  });
}

test("network cut", async ({ browserName }, testInfo) => {
  test.setTimeout(120_000 + ROUNDS * 20_000);
  expect(browserName).toBe("chromium");
  const cable = wire(1);
  const there = await remote(testInfo.project.use.launchOptions ?? {});
  const server = await serve(
    ...["-i", "bench-here", "--listen", `${there.address}:0`, "--tls", "self-signed", "--allow-remote-motion"],
  );
  try {
    runFirst();
    const context = await there.browser.newContext({ ignoreHTTPSErrors: true, viewport: { width: 1366, height: 640 } });
    await measure("network cut (cable pulled)", there.browser, context, server, {
      noticed: false,
      async end() {
        there.cable(false);
        return () => there.cable(true);
      },
    });
  } finally {
    await end(server);
    await there.end();
    cable.end();
  }
});

for (const signal of ["SIGKILL", "SIGSTOP"] as const) {
  test(`server gone by ${signal}`, async ({ browser }) => {
    test.setTimeout(120_000 + ROUNDS * 30_000);
    const [faults, rests]: [number[], number[]] = [[], []];
    for (let round = 0; round < ROUNDS; round += 1) {
      const cable = wire(1);
      const server = await serve("-i", "bench-here", "--listen", "127.0.0.1:0");
      const context = await browser.newContext();
      try {
        const page = await control(context, server, await enter(context, server));
        await jog(page);
        const since = performance.now();
        server.process.kill(signal);
        faults.push(await cable.happens("fault F702", since));
        rests.push(await cable.happens("-> S1 switching on inhibited", since));
      } finally {
        await end(server);
        await context.close();
        cable.end();
      }
    }
    const verdicts = new Verdicts();
    const off = `power stage off after ${Math.max(...rests).toFixed(1)} ms at most`;
    const of = `median ${percentile(faults, 50).toFixed(1)} ms, ${faults.length} times, ${off}`;
    verdicts.most(`server gone by ${signal} -> F702 of the drive, max`, Math.max(...faults), WATCHDOG, "ms", of);
    verdicts.end();
  });
}
