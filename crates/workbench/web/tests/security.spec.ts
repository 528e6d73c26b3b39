import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { expect, test } from "./bench";

test("the policy of the page stops code that is not of the page", async ({ page, demo }) => {
  await page.goto(demo.url);
  await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
  const reports = await page.evaluate(async () => {
    const reports: string[] = [];
    document.addEventListener("securitypolicyviolation", (event) => reports.push(event.effectiveDirective));
    const script = document.createElement("script");
    try {
      script.textContent = "document.title = 'run'";
      document.head.append(script);
    } catch {
      reports.push("thrown");
    }
    try {
      document.body.insertAdjacentHTML("beforeend", "<b>markup</b>");
    } catch {
      reports.push("thrown");
    }
    await fetch("http://127.0.0.1:9/").catch(() => undefined);
    await new Promise((resolve) => setTimeout(resolve));
    return reports;
  });
  expect(reports).toContain("require-trusted-types-for");
  expect(reports).toContain("connect-src");
  expect(await page.title()).not.toBe("run");
});

test("a page of another origin changes nothing and is not a frame around this one", async ({ page, demo, context }) => {
  await page.goto(demo.url);
  await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
  const before = await (await page.request.get(`${demo.origin}/api/v1/server`)).json();
  const html = `<form method="post" action="${demo.origin}/api/v1/stop"><button>go</button></form>
    <img src="${demo.origin}/api/v1/stations"><iframe src="${demo.origin}/"></iframe>
    <iframe name="target"></iframe>`;
  const server = createServer((_, answer) => answer.setHeader("content-type", "text/html").end(html));
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    const { port } = server.address() as AddressInfo;
    const evil = await context.newPage();
    // the same host, so that the browser sends the cookie along
    await evil.goto(`http://127.0.0.1:${port}/`);
    const read = await evil.evaluate(async (origin) => {
      const tries = ["GET", "POST"].map((method) =>
        fetch(`${origin}/api/v1/stop`, { method, credentials: "include", mode: "no-cors" })
          .then((answer) => answer.type)
          .catch(() => "failed"),
      );
      return Promise.all(tries);
    }, demo.origin);
    for (const type of read) {
      expect(["failed", "opaque"]).toContain(type);
    }
    expect(evil.frames().some((frame) => frame.url() === `${demo.origin}/`)).toBe(false);
    const [answer] = await Promise.all([
      evil.waitForResponse((response) => response.url().endsWith("/stop") && response.request().isNavigationRequest()),
      evil.getByRole("button", { name: "go" }).click(),
    ]);
    expect(answer.status()).toBe(403);
    const after = await (await page.request.get(`${demo.origin}/api/v1/server`)).json();
    expect(after.stops).toBe(before.stops);
  } finally {
    server.close();
  }
});
