import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import type { Page } from "@playwright/test";
import { alone, end, expect, idOf, inject, program, rows, serve, test, watch } from "./bench";
import { packets } from "./bench/wire";

const captures = fileURLToPath(new URL("../../../../captures", import.meta.url));

async function go(page: Page, drive: string, screen: string): Promise<void> {
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, drive))}/${screen}`);
}

test("the time line has each state of a drive that is enabled and disabled", async ({ page }) => {
  const wrong = watch(page);
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "axis-1" }).click();
    await page.getByRole("link", { name: "State machine" }).click();
    await expect(page.locator(".machine-state")).toContainText("S1");
    await expect(page.getByText("from its parameters, read once a second")).toBeVisible();
    await page.getByRole("link", { name: "Control" }).click();
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.getByText(/This page has control/)).toBeVisible();
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
    await page.getByRole("link", { name: "State machine" }).click();
    await expect(page.locator(".machine-state")).toContainText("S4");
    await expect(page.locator(".diagram .active")).toHaveAttribute("data-state", "S4");
    await expect(page.getByText("from its cyclic frames")).toBeVisible();
    await expect(page.locator("table[data-word=ZSW1] td.set").first()).toBeVisible();
    await page.getByRole("link", { name: "Control" }).click();
    await page.getByRole("button", { name: "Disable" }).click();
    await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
    await page.getByRole("link", { name: "State machine" }).click();
    const seen = page.locator(".changes-of-state li");
    const order = async () =>
      (await seen.evaluateAll((all) => all.map((one) => one.getAttribute("data-state")))).join(" ");
    await expect.poll(order).toMatch(/S1 S2 (S3 )?S4 S5 S2/);
    // what the drive waits for now, with its bit
    await expect(
      page.locator(".conditions.awaited .accent").filter({ hasText: "STW1 bit 0 ON must be 1" }),
    ).toBeVisible();
    await expect(page.locator(".edge.awaited")).toHaveAttribute("data-edge", "S2 S3");
    expect(wrong).toEqual([]);
  });
});

test("the diagram and its table have the same transitions, and STO is the condition of fan-1", async ({
  entered: page,
}) => {
  // the meaning is that of the value that is needed, and the present one stands behind it
  await go(page, "axis-1", "machine");
  const bit = page.locator(".conditions.awaited li").filter({ hasText: "STW1 bit 1" });
  await expect(bit).toContainText("OFF2 must be 1 (OFF2 not active)");
  await expect(bit).toContainText("is 0 now");
  await go(page, "fan-1", "machine");
  const condition = page.locator(".conditions.awaited .accent").filter({ hasText: /STO|safe torque off/i });
  await expect(condition.first()).toBeVisible();
  await page.locator("summary").click();
  const of = (rows: string) =>
    page.locator(rows).evaluateAll((all) => [...new Set(all.map((one) => one.getAttribute("data-edge")))].sort());
  const edges = await of(".diagram .edge");
  expect(edges.length).toBeGreaterThan(10);
  const table = (await of(".twin tbody tr")).filter((edge) => edge !== "S5 S5");
  expect(table).toEqual(edges);
  // the words of a vendor have strips of their own
  await go(page, "pump-1", "machine");
  await expect(page.locator("table[data-word]").first()).toBeVisible();
});

test("the byte map has the values of the program for the same octets", async ({ entered: page }) => {
  await go(page, "press-1", "telegram");
  const input = page.locator("[data-direction=input]");
  await expect(input.getByRole("row", { name: /NIST_A/ })).toBeVisible();
  const read = () =>
    input.evaluate((section) => ({
      command: section.querySelector("code")?.textContent ?? "",
      speed: section.querySelector("[data-field=NIST_A] td:last-child")?.textContent ?? "",
      offset: section.querySelector("[data-field=NIST_A] td")?.textContent ?? "",
      octets: section.getAttribute("data-octets")?.split(" ") ?? [],
      hex: section.querySelector("[data-field=NIST_A] td:nth-of-type(2)")?.textContent ?? "",
    }));
  const first = await read();
  const [, ...words] = first.command.split(" ");
  const printed = execFileSync(program, words, { encoding: "utf8" });
  expect(first.speed).toMatch(/rpm/);
  expect(printed).toContain(first.speed);
  const at = Number(first.offset);
  expect(first.octets.slice(at, at + 2).join(" ")).toBe(first.hex);
  // the drive turns to and fro: the value is another one some time later
  await expect.poll(async () => (await read()).speed).not.toBe(first.speed);
  await expect(input.getByText("Missed")).toBeVisible();
  // a drive without a connection says what it would need
  await go(page, "axis-2", "telegram");
  await expect(page.getByText("No cyclic frame of this drive was seen.")).toBeVisible();
});

/**
 * A press that a controller turns at a constant speed, so that nothing but a load changes it.
 * Its inertia is such that 5 N m hold it below 50 rpm for 0.3 s: a page shows this however slow its computer is.
 */
const PRESS = `
[[drive]]
name = "press-1"
ip = "192.168.77.21/24"
load = { inertia = 1e-2, friction = 0.1 }

[[controller]]
drive = "press-1"
telegram = 1
step = [
    { at = "0.3s", send = { STW1 = "0x047E" } },
    { at = "0.5s", send = { STW1 = "0x047F" } },
    { at = "0.6s", send = { NSOLL_A = "60rpm" } },
]
`;

/** A field of a frame as `profidrive decode` prints it. */
interface Field {
  name: string;
  value: string;
  start: number;
  end: number;
  children?: Field[];
}

function fields(node: Field): Field[] {
  return [node, ...(node.children ?? []).flatMap(fields)];
}

test("a load changes the speed in the telegram, at the octets and with the value of the same frame in a capture", async ({
  page,
}) => {
  const folder = mkdtempSync(join(tmpdir(), "profidrive-load-"));
  writeFileSync(join(folder, "press.toml"), PRESS);
  const server = await serve("--plant", join(folder, "press.toml"), "--listen", "127.0.0.1:0");
  const wrong = watch(page);
  try {
    await page.goto(server.url);
    await expect(page.getByRole("row", { name: "press-1" })).toContainText("S4");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "press-1"))}/telegram`);
    const input = page.locator("[data-direction=input]");
    const speed = input.locator("[data-field=NIST_A] td").last();
    await expect(speed).toHaveText(/^60\.\d+ rpm$/);
    // each frame that the page shows with a lower speed than 50 rpm
    await input.evaluate((section) => {
      const seen: object[] = [];
      Object.assign(window, { seen });
      const look = () => {
        const row = section.querySelector("[data-field=NIST_A]");
        const text = (place: string) => row?.querySelector(`td:${place}`)?.textContent ?? "";
        const value = text("last-child");
        if (Number.parseFloat(value) < 50) {
          const octets = section.getAttribute("data-octets") ?? "";
          seen.push({ octets, value, offset: Number(text("first-child")), hex: text("nth-of-type(2)") });
        }
      };
      new MutationObserver(look).observe(section, { subtree: true, childList: true, characterData: true });
    });
    type Seen = { octets: string; value: string; offset: number; hex: string };
    const seen = () => page.evaluate(() => (window as unknown as { seen: Seen[] }).seen);
    await inject(page, "press-1", "load=5Nm");
    await expect.poll(async () => (await seen()).length, { timeout: 30_000 }).toBeGreaterThan(0);
    const [shown] = (await seen()) as [Seen];
    const octets = shown.octets.split(" ");
    expect(octets.slice(shown.offset, shown.offset + 2).join(" ")).toBe(shown.hex);
    // the same frame, among those of the last minute
    const answer = await page.request.get(`${server.origin}/api/v1/traffic`);
    const file = join(folder, "a.pcapng");
    writeFileSync(file, await answer.body());
    const frames = [...packets(readFileSync(file))].map(({ frame }) => frame.toString("hex"));
    const place = frames.indexOf(octets.join("").toLowerCase());
    expect(place).toBeGreaterThan(0);
    const printed = execFileSync(program, ["decode", file, "--frame", String(place + 1), "--json"], {
      encoding: "utf8",
    });
    const { tree } = JSON.parse(printed) as { tree: Field };
    const found = fields(tree).find(({ name }) => name === "NIST_A");
    expect(found).toMatchObject({ value: shown.value, start: shown.offset, end: shown.offset + 2 });
    expect(wrong).toEqual([]);
  } finally {
    await end(server);
    rmSync(folder, { recursive: true });
  }
});

test("a record is read by its numbers, and what the drive refuses is said", async ({ page, demo }) => {
  await page.goto(demo.url);
  await rows(page);
  await go(page, "axis-1", "telegram");
  await page.getByText("Read a record").click();
  const read = page.getByRole("button", { name: "Read", exact: true });
  await read.click();
  // I&M0: the block type and the order number
  await expect(page.locator(".record pre")).toContainText("0000  00 20");
  await expect(page.locator(".record")).toContainText("order number AKD");
  await expect(page.getByText(/^\d+ octets$/)).toBeVisible();
  const index = page.getByRole("textbox", { name: "Index" });
  await index.fill("0x");
  await expect(index).toHaveAttribute("aria-invalid", "true");
  await index.fill("0xBEEF");
  await read.click();
  await expect(page.locator(".record .fault")).toContainText(/0xBEEF|refused|index/i);
  await expect(page.locator(".record pre")).toHaveCount(0);
  await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
});

test("the log says from which computer something was done", async ({ page, demo }) => {
  await page.route("**/api/v1/audit?*", async (route) => {
    const answer = await route.fetch();
    const report = (await answer.json()) as { records: object[] };
    const records = report.records.map((one, place) => ({ ...one, address: place === 0 ? "192.168.0.7" : null }));
    await route.fulfill({ response: answer, json: { ...report, records } });
  });
  await page.goto(demo.url);
  await rows(page);
  await page.evaluate(() => fetch("/api/v1/stop", { method: "POST" }));
  await page.getByRole("link", { name: "Log" }).click();
  await expect(page.locator(".log-table tbody tr").first()).toContainText("from 192.168.0.7");
  await expect(page.locator(".log-table").getByText(/^ ?from /)).toHaveCount(1);
});

test("the log has what was done, follows it, and exports it", async ({ page }) => {
  const wrong = watch(page);
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "Log" }).click();
    await page.getByRole("combobox", { name: "Action" }).selectOption("inject");
    const drive = await idOf(page, "axis-1");
    const inject = (event: string) =>
      page.evaluate(
        async (body) => {
          const headers = { "Content-Type": "application/json" };
          await fetch("/api/v1/plant/inject", { method: "POST", headers, body });
        },
        JSON.stringify({ drive, event, seconds: null }),
      );
    await page.getByRole("combobox", { name: "Drive", exact: true }).last().selectOption(drive);
    // earlier runs have left records
    const torque = `0.1${String(Date.now()).slice(-5)}1`;
    await inject(`load=${torque}Nm`);
    const row = page.locator("tr[data-action=inject]").filter({ hasText: `load=${torque}Nm` });
    // one row for what was requested and what became of it
    await expect(row).toHaveCount(1);
    await expect(row).toContainText("done");
    // nothing that a page can send changes a record or deletes one
    const log = async () => {
      const { records } = (await (await page.request.get(`${server.origin}/api/v1/audit`)).json()) as {
        records: { action: string; time: string }[];
      };
      return records.filter(({ action }) => action !== "request").map(({ action, time }) => `${time} ${action}`);
    };
    const records = await log();
    const answers = await page.evaluate(async () => {
      const found: number[] = [];
      for (const path of ["audit", "logs", "audit/1", "logs/audit.jsonl"]) {
        for (const method of ["DELETE", "PUT", "PATCH", "POST"]) {
          const headers = { "Content-Type": "application/json" };
          found.push((await fetch(`/api/v1/${path}`, { method, headers, body: "{}" })).status);
        }
      }
      return found;
    });
    expect(answers.filter((status) => status !== 404 && status !== 405)).toEqual([]);
    expect(await log()).toEqual(records);
    await page.getByRole("searchbox", { name: "Search" }).fill("no such text");
    await expect(page.getByText("No matching records.")).toBeVisible();
    await page.getByRole("searchbox", { name: "Search" }).fill(torque);
    await expect(row.first()).toBeVisible();
    // a link to this screen has the filters
    await expect(page).toHaveURL(new RegExp(`#text=${torque}&drive=.*&action=inject$`));
    const linked = page.url();
    await page.getByRole("searchbox", { name: "Search" }).fill("");
    await page.goto("about:blank");
    await page.goto(linked);
    await expect(page.getByRole("searchbox", { name: "Search" })).toHaveValue(torque);
    await expect(row).toHaveCount(1);
    // and one that is followed while it is open
    await page.evaluate(() => {
      location.hash = "#text=no+such+text";
    });
    await expect(page.getByText("No matching records.")).toBeVisible();
    await page.goBack();
    await expect(page.getByRole("searchbox", { name: "Search" })).toHaveValue(torque);
    await expect(row).toHaveCount(1);
    const file = async (name: string) => {
      const [download] = await Promise.all([
        page.waitForEvent("download"),
        page.getByRole("link", { name, exact: true }).click(),
      ]);
      return readFileSync(await download.path());
    };
    const csv = (await file("Export CSV")).toString();
    expect(csv.split("\r\n")[0]).toBe(
      "time,who,drive,name,action,value,changes,result,serial,engine_us,epoch,claimed_name,address",
    );
    expect(csv).toContain(`load=${torque}Nm`);
    const lines = (await file("Export JSON Lines")).toString().trim().split("\n");
    expect(JSON.parse(lines.at(-1) ?? "")).toMatchObject({ action: "inject", result: "done" });
    // the frames of the last minute, as Wireshark reads them
    const frames = await file("Save the frames of the last minute");
    const folder = mkdtempSync(join(tmpdir(), "profidrive-traffic-"));
    writeFileSync(join(folder, "a.pcapng"), frames);
    expect(frameCount(join(folder, "a.pcapng"))).toBeGreaterThan(20);
    // and those around one event, which are some of them
    const [around] = await Promise.all([
      page.waitForEvent("download"),
      row.getByRole("link", { name: /^Save the frames around this event/ }).click(),
    ]);
    await around.saveAs(join(folder, "b.pcapng"));
    expect(around.suggestedFilename()).toMatch(/^frames-from-\d+\.pcapng$/);
    expect(frameCount(join(folder, "b.pcapng"))).toBeGreaterThan(5);
    rmSync(folder, { recursive: true });
    expect(wrong.filter((text) => !/40[45]/.test(text))).toEqual([]);
  });
});

function frameCount(file: string): number {
  const printed = execFileSync("tshark", ["-n", "-r", file, "-T", "fields", "-e", "frame.number"], {
    encoding: "utf8",
    stdio: ["ignore", "pipe", "ignore"],
  });
  return printed.trim().split("\n").length;
}

async function upload(page: Page, file: string | { name: string; mimeType: string; buffer: Buffer }): Promise<void> {
  await page.getByLabel("Select a capture").first().setInputFiles(file);
}

test("captures have the frames that tshark counts", async ({ entered: page }) => {
  await page.getByRole("link", { name: "Capture" }).click();
  const files = readdirSync(captures).filter((name) => name.endsWith(".pcapng"));
  expect(files.length).toBeGreaterThan(3);
  for (const name of files) {
    await upload(page, join(captures, name));
    const count = frameCount(join(captures, name));
    await expect(page.locator("[data-frames]"), name).toHaveAttribute("data-frames", String(count));
  }
});

test("a damaged capture says where, a foreign file says what it is, and the server goes on", async ({
  entered: page,
}) => {
  await page.getByRole("link", { name: "Capture" }).click();
  const whole = readFileSync(join(captures, "pnet-profinetpy-full.pcapng"));
  const cut = whole.subarray(0, whole.length - 7);
  await upload(page, { name: "../../etc/x.pcap", mimeType: "application/octet-stream", buffer: cut });
  await expect(page.getByText(/ends in the middle of a block that begins at octet \d+/)).toBeVisible();
  await expect(page.getByRole("table", { name: "What happened in the capture" })).toBeVisible();
  await upload(page, { name: "a.pcap", mimeType: "text/html", buffer: Buffer.from("<img src=x onerror=alert(1)>") });
  await expect(page.getByText(/not a capture file/)).toBeVisible();
  await expect(page.getByRole("button", { name: /^STOP/ })).toBeVisible();
});

test("the fault of the demo is in only trouble, and a parameter marks its octets", async ({ entered: page }) => {
  const folder = mkdtempSync(join(tmpdir(), "profidrive-demo-"));
  const file = join(folder, "demo.pcapng");
  execFileSync(program, ["demo", "--fast", "--pcap", file], { stdio: "ignore" });
  await page.getByRole("link", { name: "Capture" }).click();
  await upload(page, file);
  await page
    .getByRole("cell", { name: /^parameter:/ })
    .first()
    .waitFor();
  const job = page.getByRole("row").filter({ has: page.getByRole("cell", { name: /^parameter:/ }) });
  await job.first().getByRole("button").click();
  const field = page.locator(".tree button[data-field=PNU]").first();
  await field.click();
  const marked = page.locator(".hex .octet.marked");
  await expect(marked).toHaveCount(2);
  const shown = (await marked.allTextContents()).join("");
  await expect(field).toContainText(String(Number.parseInt(shown, 16)));
  await page.getByRole("checkbox", { name: "Only trouble" }).check();
  await expect(page.getByRole("row").filter({ hasText: /fault/i }).first()).toBeVisible();
  await expect(page.getByText("States of the drives")).toBeVisible();
  rmSync(folder, { recursive: true });
});
