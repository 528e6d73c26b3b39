import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import type { Page } from "@playwright/test";
import { expect, idOf, test, watch } from "./bench";

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
    // not in the turn that the test began, which may evaluate
    const evaluate = "eval";
    for (const run of [window[evaluate] as (text: string) => unknown, (text: string) => new Function(text)()]) {
      try {
        run("document.title = 'run'");
        reports.push("evaluated");
      } catch {
        reports.push("not evaluated");
      }
    }
    return reports;
  });
  expect(reports).toContain("require-trusted-types-for");
  expect(reports).toContain("connect-src");
  expect(reports.filter((report) => report === "not evaluated")).toHaveLength(2);
  expect(reports).not.toContain("evaluated");
  expect(await page.title()).not.toBe("run");
});

test("a script that came into the page does not run, and is reported", async ({ page, demo }) => {
  await reporting(page);
  await page.route(`${demo.origin}/*`, async (route) => {
    if (route.request().resourceType() !== "document") return route.continue();
    const answer = await route.fetch();
    const body = (await answer.text()).replace("</head>", "<script>document.title = 'run'</script></head>");
    return route.fulfill({ response: answer, body });
  });
  await page.goto(demo.url);
  await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
  expect(await reported(page)).toEqual(["script-src-elem"]);
  expect(await page.title()).not.toBe("run");
  await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
});

/** Notes what the policy of a page refuses, from its beginning. */
async function reporting(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const refused: string[] = [];
    Object.assign(window, { refused });
    document.addEventListener("securitypolicyviolation", (event) => refused.push(event.effectiveDirective));
  });
}

async function reported(page: Page): Promise<string[]> {
  return page.evaluate(() => (window as unknown as { refused: string[] }).refused);
}

const HOSTILE = [
  "<img src=x onerror=\"document.title='run'\">",
  "<script>document.title='run'</script>",
  "\u202egnp.exe",
  "javascript:document.title='run'",
  "=1+1",
];
/** Each so many texts one is that long. */
const [LONG, EVERY] = ["x".repeat(65_536), 97];

/** What a drive or a file words, by the names that the interface has for it. */
const TEXTS = new Set(
  [
    "name description text meaning sentence remedy reason detail summary cause_text unit common_names bits choices",
    "vendor product type station_type order_number serial firmware function location tag date descriptor high low",
    "label word words title message claimed_name who changes value old new hint unread",
  ]
    .join(" ")
    .split(" "),
);

/** Puts hostile texts in the place of all texts of a report. */
function poisoned<T>(report: T): T {
  let count = 0;
  const text = () => {
    count += 1;
    return count % EVERY === 0 ? LONG : `${HOSTILE[count % HOSTILE.length]}`;
  };
  const walk = (value: unknown, key: string): unknown => {
    if (typeof value === "string") return TEXTS.has(key) ? text() : value;
    if (Array.isArray(value)) return value.map((one) => walk(one, key));
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, walk(one, name)]));
  };
  return walk(report, "") as T;
}

test("whatever a drive words is shown as text on each screen", async ({ page, demo }) => {
  test.setTimeout(120_000);
  const wrong = watch(page);
  const outside: string[] = [];
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(demo.origin) && !url.startsWith("blob:") && !url.startsWith("data:")) outside.push(url);
  });
  await reporting(page);
  await page.goto(demo.url);
  await expect(page.getByRole("row")).toHaveCount(7);
  const id = encodeURIComponent(await idOf(page, "axis-2"));
  const press = encodeURIComponent(await idOf(page, "press-1"));
  await page.route("**/api/v1/**", async (route) => {
    const kind = route.request().resourceType();
    if (kind !== "fetch" || /session|server$/.test(route.request().url())) return route.continue();
    const answer = await route.fetch({ maxRetries: 2 }).catch(() => null);
    if (answer === null) return route.abort();
    const type = answer.headers()["content-type"] ?? "";
    if (!type.includes("json")) return route.fulfill({ response: answer });
    return route.fulfill({ response: answer, json: poisoned(await answer.json()) });
  });
  await page.routeWebSocket("**/api/v1/live", (socket) => {
    const server = socket.connectToServer();
    server.onMessage((content) => {
      if (typeof content !== "string") return socket.send(content);
      const message = JSON.parse(content) as { type: string; data?: unknown };
      if (message.data !== undefined) message.data = poisoned(message.data);
      return socket.send(JSON.stringify(message));
    });
  });
  const hostile = page
    .locator("main")
    .getByText(/<img src=x|<script>document|=1\+1|javascript:/)
    .filter({ visible: true });
  for (const [path, shown] of [
    ["/network", true],
    [`/drives/${id}/overview`, true],
    [`/drives/${id}/faults`, true],
    [`/drives/${id}/control`, true],
    [`/drives/${id}/parameters`, true],
    [`/drives/${id}/compare`, false],
    [`/drives/${press}/machine`, true],
    [`/drives/${press}/telegram`, true],
    ["/virtual", true],
    ["/capture", false],
    ["/log", true],
    [`/drives/${id}/scope`, true],
  ] as const) {
    await page.goto(demo.origin + path);
    await expect(page.locator("main h1"), path).toBeVisible();
    if (shown) await expect(hostile.first(), path).toBeVisible();
    expect(await page.locator("main img, main script").count(), path).toBe(0);
    expect(await page.title(), path).not.toBe("run");
    expect(await reported(page), path).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), path).toBe(false);
    // no link leads to a script
    expect(await page.locator("a[href^='javascript:']").count(), path).toBe(0);
  }
  // and what a file has in its head
  const head = `t,wall,drive,gap,"${(HOSTILE[0] ?? "").replaceAll('"', '""')} [rpm]",${HOSTILE[1]}`;
  const rows = Array.from({ length: 20 }, (_, row) => `${row / 100},,${HOSTILE[1]},false,${row},${row}`);
  const file = { name: "x.csv", mimeType: "text/csv", buffer: Buffer.from(`${head}\n${rows.join("\n")}\n`) };
  await page.getByLabel("Open CSV").setInputFiles(file);
  await expect(
    page
      .getByRole("status")
      .or(page.getByRole("heading", { level: 1 }))
      .filter({ hasText: "x.csv" })
      .first(),
  ).toBeVisible();
  expect(await page.locator("main img, main script").count()).toBe(0);
  expect(await reported(page)).toEqual([]);
  expect(outside).toEqual([]);
  expect(wrong).toEqual([]);
  await page.unrouteAll({ behavior: "ignoreErrors" });
  await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
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
    const statuses: string[] = [];
    evil.on("response", (response) => {
      if (response.url().endsWith("/stations"))
        statuses.push(`${response.request().resourceType()} ${response.status()}`);
    });
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
    // the browser has refused to pass the answer on, or the server has refused it
    expect(statuses.filter((status) => status !== "image 403")).toEqual([]);
    expect(await evil.evaluate(() => document.images[0]?.naturalWidth ?? 0)).toBe(0);
    // what was refused is in the log, with where it came from
    const wanted = `POST /api/v1/stop, from http://127.0.0.1:${port}`;
    await expect
      .poll(async () => {
        const log = await (await page.request.get(`${demo.origin}/api/v1/audit`)).text();
        return log.includes(wanted);
      })
      .toBe(true);
    const after = await (await page.request.get(`${demo.origin}/api/v1/server`)).json();
    expect(after.stops).toBe(before.stops);
  } finally {
    server.close();
  }
});
