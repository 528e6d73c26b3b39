/** Each way to end a hold, many times: at rest, and after which time. Not a part of `make test`: tools/web-bench. */
import { expect, test } from "@playwright/test";
import { alone } from "../bench";
import { enable, ends, open, rest, turningBy, underControl, withLateBeats } from "../moving";
import { Verdicts } from "./verdict";
import { percentile } from "./wire";

const ROUNDS = Number(process.env.ROUNDS ?? 50);
/** A hold that is not put off ends after 200 ms, and the axis of the demo brakes in less; ms. */
const LIMIT = 600;

test("each way to end a hold, again and again", async ({ page }) => {
  // some rounds begin with taking control anew
  test.setTimeout(60_000 + ROUNDS * 60_000);
  await alone(async (server) => {
    await withLateBeats(page);
    const id = await open(page, server.url, "axis-1");
    const take = page.getByRole("button", { name: "Take control" });
    await expect(take).toBeEnabled();
    const verdicts = new Verdicts();
    for (const { name, hand, end, back, releases } of await ends(page)) {
      const took: number[] = [];
      for (let round = 0; round < ROUNDS; round += 1) {
        await underControl(page, async () => {
          await hand.up();
          if (await take.isVisible()) await enable(page);
          await turningBy(page, server.origin, id, hand);
        });
        const since = performance.now();
        await end();
        took.push(await rest(page, server.origin, id, since));
        await back?.();
        await hand.up();
        if (releases) await expect(take).toBeEnabled();
      }
      const more = `median ${percentile(took, 50).toFixed(0)} ms, ${ROUNDS} times`;
      verdicts.most(`${name} -> at rest, max`, Math.max(...took), LIMIT, "ms", more, 0);
    }
    verdicts.end();
  });
});
