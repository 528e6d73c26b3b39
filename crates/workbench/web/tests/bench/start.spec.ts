/** How soon a server with the demo is ready. Not a part of `make test`: tools/web-bench. */
import { test } from "@playwright/test";
import { end, serve } from "../bench";
import { Verdicts } from "./verdict";
import { clock, percentile } from "./wire";

const STARTS = Number(process.env.STARTS ?? 20);
/** Most time from the start of the program to its line that says where the page is, ms. */
const LIMIT = 300;

test("from the start to the line that says where the page is", async () => {
  test.setTimeout(120_000);
  const times: number[] = [];
  for (let start = 0; start < STARTS; start += 1) {
    const from = clock();
    const server = await serve("--demo", "--listen", "127.0.0.1:0");
    times.push(clock() - from);
    await end(server);
  }
  const verdicts = new Verdicts();
  const more = `max ${Math.max(...times).toFixed(0)} ms, ${STARTS} starts`;
  verdicts.most("serve --demo, start -> ready, median", percentile(times, 50), LIMIT, "ms", more, 0);
  verdicts.end();
});
