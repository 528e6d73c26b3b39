/** How fast the page is there, and what many samples cost it. Not a part of `make test`: tools/web-bench. */
import { expect, test } from "@playwright/test";
import { end, serve } from "../bench";
import { percentile } from "./wire";

const LOADS = Number(process.env.LOADS ?? 20);
/** Minutes of 16 signals with a row each millisecond. */
const MINUTES = Number(process.env.MINUTES ?? 1);

test("the first picture and the first live value", async ({ browser }) => {
  test.setTimeout(300_000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  const slow: string[] = [];
  try {
    for (const [throttle, factor] of [
      [1, 1],
      [4, 2.5],
    ] as const) {
      const [paints, values]: [number[], number[]] = [[], []];
      for (let round = 0; round < LOADS; round += 1) {
        const context = await browser.newContext();
        const page = await context.newPage();
        const protocol = await context.newCDPSession(page);
        await protocol.send("Emulation.setCPUThrottlingRate", { rate: throttle });
        await page.goto(server.url);
        const value = await page.evaluate(
          () =>
            new Promise<number>((resolve) => {
              const look = () => {
                const live = document.querySelector("tbody tr .state");
                if (live === null) requestAnimationFrame(look);
                else resolve(performance.now());
              };
              look();
            }),
        );
        values.push(value);
        const paint = await page.evaluate(
          () =>
            new Promise<number>((resolve) => {
              new PerformanceObserver((list) => {
                const first = list.getEntriesByName("first-contentful-paint")[0];
                if (first !== undefined) resolve(first.startTime);
              }).observe({ type: "paint", buffered: true });
            }),
        );
        paints.push(paint);
        // a server has room for 16 sessions
        await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
        await context.close();
      }
      for (const [name, times, limit] of [
        ["first contentful paint", paints, 400 * factor],
        ["first live value", values, 1000 * factor],
      ] as const) {
        const median = percentile(times, 50);
        console.log(
          `${name}: median ${median.toFixed(0)} ms (limit ${limit} ms), CPU throttle ${throttle}, ${times.length} cold loads`,
        );
        if (!(median <= limit)) slow.push(`${name}, throttle ${throttle}`);
      }
    }
    expect(slow).toEqual([]);
  } finally {
    await end(server);
  }
});

test("16 signals with a row each millisecond", async ({ page }) => {
  test.setTimeout((MINUTES + 2) * 60_000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await page.getByRole("link", { name: "axis-1" }).click();
    await page.getByRole("link", { name: "Scope" }).click();
    await page.getByRole("combobox", { name: "Source" }).selectOption("test");
    await page.getByRole("combobox", { name: "Time", exact: true }).selectOption({ label: "600 s" });
    await expect(page.getByText(/test signal, \d+/)).toBeVisible();
    const seen = await page.evaluate(
      (time) =>
        new Promise<{ frames: number; long: number[]; heap: number[] }>((resolve) => {
          const long: number[] = [];
          const heap: number[] = [];
          let frames = 0;
          new PerformanceObserver((list) => {
            for (const entry of list.getEntries()) long.push(entry.duration);
          }).observe({ type: "longtask" });
          const begin = performance.now();
          let noted = begin;
          const turn = (now: number) => {
            frames += 1;
            if (now - noted > 5000) {
              noted = now;
              heap.push((performance as unknown as { memory: { usedJSHeapSize: number } }).memory.usedJSHeapSize);
            }
            if (now - begin < time) requestAnimationFrame(turn);
            else resolve({ frames: (frames * 1000) / (now - begin), long, heap });
          };
          requestAnimationFrame(turn);
        }),
      MINUTES * 60_000,
    );
    const longest = Math.max(0, ...seen.long);
    const growth = ((seen.heap.at(-1) ?? 0) - (seen.heap[Math.floor(seen.heap.length / 2)] ?? 0)) / 2 ** 20;
    console.log(
      `16 signals x 1 kHz, ${MINUTES} min: ${seen.frames.toFixed(0)} frames/s (limit 30), longest task ${longest.toFixed(0)} ms (limit 50 ms), ` +
        `heap of the page grows ${growth.toFixed(1)} MiB in the second half (limit 20 MiB)`,
    );
    expect(seen.frames).toBeGreaterThanOrEqual(30);
    expect(longest).toBeLessThanOrEqual(50);
    expect(growth).toBeLessThanOrEqual(20);
  } finally {
    await end(server);
  }
});
