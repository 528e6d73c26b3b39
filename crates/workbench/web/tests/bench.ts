/** A server for each test file, and a page that is let in. */
import { type ChildProcess, spawn } from "node:child_process";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { test as base, expect, type Page } from "@playwright/test";

const root = fileURLToPath(new URL("../../../..", import.meta.url));
export const program = process.env.PROFIDRIVE ?? join(root, "target/debug/profidrive");
export const pictures = join(root, "target/workbench");
mkdirSync(pictures, { recursive: true });

/** A server that runs. */
export interface Running {
  process: ChildProcess;
  url: string;
  viewUrl: string;
  origin: string;
  /** Of its certificate; nothing without encryption. */
  fingerprint: string | null;
}

/** What a server prints when it is ready. */
interface Ready {
  event: string;
  url: string;
  view_url: string;
  fingerprint: string | null;
}

/** Starts `profidrive serve` with these arguments and waits until it is ready. */
export async function serve(...args: string[]): Promise<Running> {
  return serveIn({}, ...args);
}

/** The same with other variables of its environment. */
export async function serveIn(variables: Record<string, string>, ...args: string[]): Promise<Running> {
  // the log of what tests do is no log of this user, and no other test writes to it at the same time
  const state = join(pictures, `state-${process.env.TEST_WORKER_INDEX ?? 0}`);
  const env = { ...process.env, XDG_STATE_HOME: state, ...variables };
  const child = spawn(program, ["serve", "--json", ...args], { stdio: ["ignore", "pipe", "inherit"], env });
  const lines = createInterface({ input: child.stdout });
  for await (const line of lines) {
    const { event, url, view_url, fingerprint } = JSON.parse(line) as Ready;
    expect(event).toBe("ready");
    return { process: child, url, viewUrl: view_url, origin: new URL(url).origin, fingerprint };
  }
  throw new Error(`${program} serve ${args.join(" ")} did not start`);
}

export async function end(server: Running): Promise<void> {
  if (server.process.exitCode === null && server.process.signalCode === null) {
    const ended = new Promise((resolve) => server.process.once("exit", resolve));
    server.process.kill("SIGKILL");
    await ended;
  }
}

/** A server of its own for a test that changes or moves drives. */
export async function alone(test: (server: Running) => Promise<void>): Promise<void> {
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  try {
    await test(server);
  } finally {
    await end(server);
  }
}

/** What the page must not do: its policy refuses something, or a script fails. */
export function watch(page: Page): string[] {
  const wrong: string[] = [];
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") wrong.push(message.text());
  });
  page.on("dialog", (dialog) => {
    wrong.push(`dialog: ${dialog.message()}`);
    void dialog.dismiss();
  });
  return wrong;
}

export const test = base.extend<{ entered: Page }, { demo: Running }>({
  demo: [
    // biome-ignore lint/correctness/noEmptyPattern: Playwright reads the names in the pattern
    async ({}, use) => {
      const server = await serve("--demo", "--listen", "127.0.0.1:0");
      await use(server);
      await end(server);
    },
    { scope: "worker" },
  ],
  baseURL: async ({ demo }, use) => use(demo.origin),
  entered: async ({ page, demo }, use) => {
    const wrong = watch(page);
    await page.goto(demo.url);
    await rows(page);
    await use(page);
    expect(wrong).toEqual([]);
    // a server has room for 16 sessions
    await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
  },
});

/** Waits until each drive of the demo was read. */
export async function rows(page: Page): Promise<void> {
  await expect(page.getByRole("row")).toHaveCount(7);
  await expect(page.getByRole("row", { name: "F439" })).toBeVisible();
  await expect(page.getByRole("row", { name: "axis-1" })).toContainText("no controller is connected");
  await expect(page.getByRole("row", { name: "fan-1" })).toContainText("Safe torque off");
  await expect(page.getByRole("row", { name: "pump-1" })).toContainText("no controller is connected");
}

export { expect };

/** Returns what the drive of this name is called in paths. */
export async function idOf(page: Page, name: string): Promise<string> {
  const answer = await page.request.get(new URL("/api/v1/plant/drives", page.url()).href);
  const { drives } = (await answer.json()) as { drives: { id: string; name: string }[] };
  const id = drives.find((drive) => drive.name === name)?.id;
  // an empty one would be a path that exists
  if (id === undefined) throw new Error(`the plant has no drive ${name}`);
  return id;
}

/** Returns what the station of this name is called in paths, on any server. */
export async function idOfStation(page: Page, name: string): Promise<string> {
  let id: string | undefined;
  const look = async () => {
    const answer = await page.request.get(new URL("/api/v1/stations", page.url()).href);
    const { stations } = (await answer.json()) as { stations: { id: string; name: string | null }[] };
    id = stations.find((station) => station.name === name)?.id;
    return id !== undefined;
  };
  // a station may have been found before its name
  await expect.poll(look, name).toBe(true);
  return id ?? "";
}

/** Enters the page of a server, and goes to a screen of the drive of this name. Returns what that is called in paths. */
export async function openScreen(page: Page, server: Running, name: string, screen: string): Promise<string> {
  await page.goto(server.url);
  await rows(page);
  const id = await idOf(page, name);
  await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/${screen}`);
  return id;
}

/** Lets something happen to a drive as a click does. */
export async function inject(page: Page, drive: string, event: string): Promise<void> {
  const done = await page.evaluate(
    async (body) => {
      const headers = { "Content-Type": "application/json" };
      return (await fetch("/api/v1/plant/inject", { method: "POST", headers, body })).status;
    },
    JSON.stringify({ drive: await idOf(page, drive), event, seconds: null }),
  );
  expect(done).toBe(200);
}
