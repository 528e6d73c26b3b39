/** How fast the page is there, and what many samples cost it. Not a part of `make test`: tools/web-bench. */
import { expect, test } from "@playwright/test";
import { end, serve } from "../bench";
import { memory, renderers } from "./browser";
import { Verdicts } from "./verdict";
import { percentile } from "./wire";

const LOADS = Number(process.env.LOADS ?? 20);
/** Minutes of 16 signals with a row each millisecond. */
const MINUTES = Number(process.env.MINUTES ?? 20);
/** What the Scope keeps is full after so many minutes, and has so many MiB then: of 16 signals their samples and extremes. */
const FULL = { minutes: 10, memory: 43.5 };
/** From this minute on memory is judged: where the run is long enough once the Scope is full, else once the page is warm. */
const FROM = MINUTES >= 12 ? 11 : Math.min(2, MINUTES / 2);

test("the first picture and the first live value", async ({ browser }) => {
  test.setTimeout(300_000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  const verdicts = new Verdicts();
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
        const more = `CPU throttle ${throttle}, ${times.length} cold loads`;
        verdicts.most(`${name}, median`, percentile(times, 50), limit, "ms", more, 0);
      }
    }
    verdicts.end();
  } finally {
    await end(server);
  }
});

test("16 signals with a row each millisecond", async ({ page, browser }) => {
  test.setTimeout((MINUTES + 2) * 60_000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await page.goto(server.url);
    await page.getByRole("link", { name: "axis-1" }).click();
    await page.getByRole("link", { name: "Scope" }).click();
    await page.getByRole("combobox", { name: "Source" }).selectOption("test");
    await page.getByRole("combobox", { name: "Time", exact: true }).selectOption({ label: "600 s" });
    await expect(page.getByText(/test signal, \d+/)).toBeVisible();
    const running = page.evaluate(
      (time) =>
        new Promise<{ frames: number; long: number[] }>((resolve) => {
          const long: number[] = [];
          let frames = 0;
          new PerformanceObserver((list) => {
            for (const entry of list.getEntries()) long.push(entry.duration);
          }).observe({ type: "longtask" });
          const begin = performance.now();
          const turn = (now: number) => {
            frames += 1;
            if (now - begin < time) requestAnimationFrame(turn);
            else resolve({ frames: (frames * 1000) / (now - begin), long });
          };
          requestAnimationFrame(turn);
        }),
      MINUTES * 60_000,
    );
    // the process of the page has its worker with all samples; others wait for pages to come
    const sizes = (await renderers(browser)).map((pid) => ({ pid, size: memory(pid) }));
    const { pid } = sizes.reduce((one, other) => (other.size > one.size ? other : one));
    const used: { minute: number; size: number }[] = [];
    const begin = performance.now();
    const note = () => used.push({ minute: (performance.now() - begin) / 60_000, size: memory(pid) });
    const noting = setInterval(note, 2000);
    const seen = await running;
    clearInterval(noting);
    note();
    // memory that is no longer used is freed from time to time: the median of some time is judged, of a minute where there are enough
    const last = used.at(-1)?.minute ?? 0;
    const span = Math.min(1, (last - FROM) / 3);
    const around = (from: number) => {
      const sizes = used.filter(({ minute }) => minute >= from && minute <= from + span).map(({ size }) => size);
      expect(sizes.length).toBeGreaterThan(1);
      return percentile(sizes, 50);
    };
    const until = last - span;
    const [first, final] = [around(FROM), around(until)];
    const part = (minute: number) => (Math.min(minute, FULL.minutes) * FULL.memory) / FULL.minutes;
    const filled = part(until) - part(FROM);
    const verdicts = new Verdicts();
    const what = `16 signals x 1 kHz, ${MINUTES} min`;
    verdicts.least(`${what}, frames`, seen.frames, 30, "/s", "", 0);
    verdicts.most(`${what}, longest task`, Math.max(0, ...seen.long), 50, "ms", "", 0);
    const more =
      `minute ${FROM.toFixed(1)} to ${last.toFixed(1)}, ${first.toFixed(1)} -> ${final.toFixed(1)} MiB (medians), ` +
      `${filled.toFixed(1)} MiB of it samples that fill the buffers`;
    verdicts.most(
      `${what}, memory (PSS) of the page and its worker beside its buffers grows by`,
      final - first - filled,
      20,
      "MiB",
      more,
    );
    verdicts.end();
  } finally {
    await end(server);
  }
});
