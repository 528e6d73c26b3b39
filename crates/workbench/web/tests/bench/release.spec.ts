/** Each way to end a hold, many times: at rest, and after which time. Not a part of `make test`: tools/web-bench. */
import { expect, test } from "@playwright/test";
import { alone, enable, ends, open, rest, turning } from "../moving";
import { Verdicts } from "./verdict";
import { percentile } from "./wire";

const ROUNDS = Number(process.env.ROUNDS ?? 50);
/** A hold that is not put off ends after 200 ms, and the axis of the demo brakes in less; ms. */
const LIMIT = 600;

test("each way to end a hold, again and again", async ({ page }) => {
  // some rounds begin with taking control anew
  test.setTimeout(60_000 + ROUNDS * 60_000);
  await alone(async (server) => {
    const id = await open(page, server.url, "axis-1");
    await enable(page);
    const button = page.getByRole("button", { name: "+20 rpm" });
    const all = ends(page);
    all.push(
      ["keyup", async () => {}],
      ["hidden tab", () => page.evaluate(() => document.dispatchEvent(new Event("visibilitychange")))],
      ["pagehide", () => page.evaluate(() => dispatchEvent(new Event("pagehide")))],
    );
    const verdicts = new Verdicts();
    for (const [name, finish] of all) {
      const took: number[] = [];
      for (let round = 0; round < ROUNDS; round += 1) {
        if (name === "hidden tab") {
          await page.evaluate(() => Object.defineProperty(document, "hidden", { value: false, configurable: true }));
        }
        if (name === "keyup") {
          await button.focus();
          await page.keyboard.down("ArrowRight");
          await expect(page.locator("main").getByText("Torque on, moving")).toBeVisible();
        } else {
          await turning(page, server.origin, id);
        }
        if (name === "hidden tab") {
          await page.evaluate(() => Object.defineProperty(document, "hidden", { value: true, configurable: true }));
        }
        const since = performance.now();
        await (name === "keyup" ? page.keyboard.up("ArrowRight") : finish());
        took.push(await rest(page, server.origin, id, since));
        await page.mouse.up();
        if (name === "hidden tab" || name === "pagehide") {
          // the page gives control back by itself
          await page.evaluate(() => {
            Object.defineProperty(document, "hidden", { value: false, configurable: true });
            document.dispatchEvent(new Event("visibilitychange"));
          });
          await page.goto(page.url());
          await enable(page);
        }
      }
      const more = `median ${percentile(took, 50).toFixed(0)} ms, ${ROUNDS} times`;
      verdicts.most(`${name} -> at rest, max`, Math.max(...took), LIMIT, "ms", more, 0);
    }
    verdicts.end();
  });
});
