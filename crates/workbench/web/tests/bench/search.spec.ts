/** How soon the rows are there after a key of a search in 5,000 parameters. Not a part of `make test`: tools/web-bench. */
import { expect, test } from "@playwright/test";
import { end, idOf, rows, serve } from "../bench";
import { letters, MANY, synthetic } from "../synthetic";
import { Verdicts } from "./verdict";
import { percentile } from "./wire";

const KEYS = Number(process.env.KEYS ?? 100);
/** From a key to the rows, ms. */
const LIMIT = 50;

/** Two digits that are looked for, as letters: each key finds other rows than the one before. */
const WORDS = ["12", "34", "47", "09", "81", "25", "63", "90", "17", "46"];

test("a search in 5,000 parameters", async ({ page }) => {
  test.setTimeout(120_000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await synthetic(page);
    await page.goto(server.url);
    await rows(page);
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/parameters`);
    const count = page.locator(".parameters .title > .muted");
    await expect(count).toHaveText(`${MANY} of ${MANY}`);
    await page.getByRole("searchbox").focus();
    // from the time of the key, as the browser has it, to the picture with the rows: what is behind the next frame was painted
    await page.evaluate(() => {
      const count = document.querySelector(".parameters .title > .muted");
      const seen: number[] = [];
      Object.assign(window, { seen });
      let pressed = 0;
      addEventListener(
        "keydown",
        (event) => {
          pressed = event.timeStamp;
        },
        { capture: true },
      );
      new MutationObserver(() => {
        const from = pressed;
        requestAnimationFrame(() => {
          const channel = new MessageChannel();
          channel.port1.onmessage = () => seen.push(performance.now() - from);
          channel.port2.postMessage(null);
        });
      }).observe(count as Node, { characterData: true, childList: true, subtree: true });
    });
    const done = () => page.evaluate(() => (window as unknown as { seen: number[] }).seen.length);
    let pressed = 0;
    const press = async (key: string, part: string) => {
      await page.keyboard.press(key);
      pressed += 1;
      await expect.poll(done, { intervals: [5] }).toBe(pressed);
      const names = await page.locator("[data-key] th bdi").allTextContents();
      expect(names.length).toBeGreaterThan(0);
      expect(names.filter((name) => !name.includes(part))).toEqual([]);
    };
    while (pressed < KEYS) {
      const [first = "", second = ""] = WORDS[(pressed / 4) % WORDS.length] ?? "";
      await press(letters(first), first);
      await press(letters(second), first + second);
      await press("Backspace", first);
      await press("Backspace", "");
    }
    const took = await page.evaluate(() => (window as unknown as { seen: number[] }).seen);
    const [median, p95, most] = [50, 95, 100].map((percent) => percentile(took, percent)) as [number, number, number];
    const verdicts = new Verdicts();
    const more = `median ${median.toFixed(1)} ms, max ${most.toFixed(1)} ms, ${took.length} keys`;
    verdicts.most(`search in ${MANY} parameters, p95`, p95, LIMIT, "ms", more);
    verdicts.end();
  } finally {
    await end(server);
  }
});
