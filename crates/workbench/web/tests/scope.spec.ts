import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { alone, expect, idOf, openScreen as open, pictures, test, watch } from "./bench";

async function inject(page: Page, drive: string, event: string, seconds: number | null): Promise<void> {
  const done = await page.evaluate(async (body) => {
    const headers = { "Content-Type": "application/json" };
    return (await fetch("/api/v1/plant/inject", { method: "POST", headers, body })).status;
  }, JSON.stringify({ drive, event, seconds }));
  expect(done).toBe(200);
}

/** Takes control of the drive on the page and turns it. */
async function turn(page: Page): Promise<void> {
  await page.getByRole("button", { name: "Take control" }).click();
  await expect(page.getByText(/This page has control/)).toBeVisible();
  await page.getByRole("button", { name: "Enable" }).click();
  await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
  await page.getByRole("tab", { name: "Velocity" }).click();
  await page.getByRole("button", { name: "Turn at this speed" }).click();
  await expect(page.locator("main").getByText("Torque on, moving")).toBeVisible();
}

/** The numbers of the table of a signal, by their titles. */
async function measured(page: Page, signal: string): Promise<Record<string, number>> {
  const titles = await page.locator(".scope thead th").allTextContents();
  const cells = await page.getByRole("row", { name: signal, exact: false }).locator("td").allTextContents();
  return Object.fromEntries(
    titles.slice(1).map((title, place) => [title, Number((cells[place] ?? "").replace("\u2212", "-"))]),
  );
}

/** Presses a button that saves a file; returns its lines without the time of day. */
async function saved(page: Page, name: string): Promise<string[]> {
  const download = page.waitForEvent("download");
  await page.getByRole("button", { name, exact: true }).click();
  const text = readFileSync(await (await download).path(), "utf8");
  return text
    .trim()
    .split("\n")
    .map((line) => {
      const [time, , ...rest] = line.split(",");
      return [time, ...rest].join(",");
    });
}

test("the axes of a picture have the colours of the system where they are forced", async ({ page }) => {
  await alone(async (server) => {
    await page.emulateMedia({ forcedColors: "active", colorScheme: "dark" });
    await page.addInitScript(() => localStorage.setItem("profidrive.theme", "light"));
    await open(page, server, "press-1", "scope");
    await expect(page.locator(".plots canvas").first()).toBeVisible();
    // of the numbers beside the first axis: how much they differ from what is behind them
    const contrast = () =>
      page
        .locator(".plots canvas")
        .first()
        .evaluate((one: HTMLCanvasElement) => {
          const probe = document.body.appendChild(document.createElement("i"));
          probe.style.color = "Canvas";
          const behind = Number(/\d+/.exec(getComputedStyle(probe).color)?.[0]);
          probe.remove();
          const { data } = one.getContext("2d")?.getImageData(0, 0, 60, one.height) ?? { data: [] };
          const reds = Array.from(data).filter((_, at) => at % 4 === 0 && (data[at + 3] ?? 0) > 200);
          return Math.max(0, ...reds.map((red) => Math.abs(red - behind)));
        });
    await expect.poll(contrast).toBeGreaterThan(150);
  });
});

test("pictures do not pile up before a page that is busy", async ({ entered: page }) => {
  await page.addInitScript(() => {
    const seen = { frames: 0, obeyed: 0 };
    const Real = Worker;
    class Counted extends Real {
      constructor(address: string | URL, options?: WorkerOptions) {
        super(address, options);
        Object.assign(window, { seen, worker: this });
        this.addEventListener("message", ({ data }) => {
          if (data.type === "frame") seen.frames += 1;
          if (data.type === "status") seen.obeyed = data.obeyed;
        });
      }
    }
    Object.assign(window, { Worker: Counted });
  });
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/scope`);
  await page.getByRole("combobox", { name: "Source" }).selectOption("test");
  await expect(page.getByText(/test signal, \d+/)).toBeVisible();
  const piled = await page.evaluate(async () => {
    const { seen, worker } = window as unknown as { seen: { frames: number; obeyed: number }; worker: Worker };
    const before = seen.frames;
    for (const until = performance.now() + 1000; performance.now() < until; );
    // what was sent meanwhile comes before the answer to this
    const asked = seen.obeyed;
    worker.postMessage({ type: "visible", visible: true });
    while (seen.obeyed <= asked) await new Promise((resolve) => setTimeout(resolve));
    return seen.frames - before;
  });
  // 30 in a second would have been made
  expect(piled).toBeLessThan(8);
});

test("each frame of an axis under control is a row, a cut cable a gap, and cursors measure what the table says", async ({
  page,
}) => {
  await alone(async (server) => {
    const wrong = watch(page);
    const id = await open(page, server, "axis-1", "control");
    await turn(page);
    await page.getByRole("link", { name: "Scope" }).click();
    await expect(page.getByText(/cyclic 16 ms, 6\d\.\d Hz, telegram \d+/)).toBeVisible();
    await expect.poll(async () => (await measured(page, "NIST_A")).Max).toBeGreaterThan(19);
    expect((await measured(page, "NSOLL_A")).Max).toBeCloseTo(20, 0);
    // cursors measure what runs, too
    await page.keyboard.press("c");
    await expect.poll(async () => (await measured(page, "NIST_A")).A).toBeGreaterThan(19);
    await page.keyboard.press("c");

    // shorter than the data hold time of the connection, 112 ms: after that it is lost
    await inject(page, id, "cable=pulled", 0.06);
    await expect(page.locator(".source .warn")).toHaveText(/^\d+ lost$/);
    const count = Number(((await page.locator(".source .warn").textContent()) ?? "").split(" ")[0]);
    await page.keyboard.press("r");
    await expect(page.getByText("Stopped", { exact: true })).toBeVisible();
    const all = (await saved(page, "Save CSV")).slice(1).map((line) => line.split(","));
    expect(all.filter((fields) => fields[2] === "true")).toHaveLength(count);
    // as many as the cycle and the times around the gap say
    const first = all.findIndex((fields) => fields[2] === "true");
    const around = Number(all[first + count]?.[0]) - Number(all[first - 1]?.[0]);
    expect(Math.round(around / 0.016) - 1).toBe(count);
    expect(count).toBeGreaterThanOrEqual(2);
    expect(count).toBeLessThanOrEqual(6);

    await page.getByText("Bits of ZSW1").click();
    await page.getByRole("checkbox", { name: /^2 / }).check();
    await expect(page.locator(".plots canvas")).toHaveCount(2);
    await page.keyboard.press("c");
    await page.getByRole("slider", { name: "Cursor A" }).fill("0.01");
    await page.getByRole("slider", { name: "Cursor B" }).fill("0.04");
    await expect(page.getByText(/B - A 300 ms/)).toBeVisible();
    const lines = await saved(page, "Save CSV between cursors");
    const at = (lines[0] ?? "").split(",").findIndex((title) => title.startsWith("NIST_A"));
    const rows = lines.slice(1).map((line) => line.split(","));
    const values = rows.filter((fields) => fields[2] === "false").map((fields) => Number(fields[at]));
    const table = await measured(page, "NIST_A");
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    // the table has one decimal: a shown number may be off by 0.05, and a difference of two of them by twice that
    const near = (shown: number | undefined, expected: number, rounded: number) =>
      expect(Math.abs((shown ?? Number.NaN) - expected)).toBeLessThan(0.05 * rounded + 0.001);
    near(table.Mean, mean, 1);
    near(table.Max, Math.max(...values), 1);
    near(table["Peak to peak"], Math.max(...values) - Math.min(...values), 1);
    near(table["B - A"], (table.B ?? 0) - (table.A ?? 0), 3);
    await page.getByRole("combobox", { name: "Time" }).selectOption({ label: "1 s" });
    await page.mouse.move(0, 0);
    await page.screenshot({ path: join(pictures, "scope-cursors.png") });
    // the picture as a file
    const download = page.waitForEvent("download");
    await page.getByRole("button", { name: "Save picture" }).click();
    const picture = readFileSync(await (await download).path());
    expect(picture.subarray(1, 4).toString()).toBe("PNG");
    expect(picture.length).toBeGreaterThan(5000);
    expect(wrong).toEqual([]);
  });
});

test("a single shot waits for a fault and keeps what was before it", async ({ page }) => {
  await alone(async (server) => {
    const id = await open(page, server, "axis-1", "scope");
    await expect(page.getByText(/acyclic, measured \d+\.\d Hz/)).toBeVisible();
    await page.getByRole("combobox", { name: "Event" }).selectOption("fault");
    await page.getByRole("combobox", { name: "Time" }).selectOption({ label: "1 s" });
    // what is before the trigger is recorded
    await expect.poll(async () => (await measured(page, "speed")).Max).toBeCloseTo(0, 0);
    await expect.poll(async () => (await saved(page, "Save CSV")).length, { intervals: [50] }).toBeGreaterThan(15);
    await page.keyboard.press("s");
    await expect(page.getByText("Waiting for the trigger ..")).toBeVisible();
    await inject(page, id, "fault=439", null);
    await expect(page.getByText("Stopped", { exact: true })).toBeVisible();
    await page.keyboard.press("c");
    await page.getByRole("slider", { name: "Cursor A" }).fill("0");
    await page.getByRole("slider", { name: "Cursor B" }).fill("1");
    await expect(page.getByText(/^A \u2212200 ms, B 800 ms/)).toBeVisible();
    const lines = (await saved(page, "Save CSV between cursors")).map((line) => line.split(","));
    const word = (lines[0] ?? []).indexOf("ZSW1");
    const at = lines.slice(1).findIndex((fields) => (Number(fields[word]) & 8) !== 0);
    const [begin, fault, last] = [lines[1], lines[at + 1], lines.at(-1)].map((fields) => Number(fields?.[0]));
    expect((fault ?? 0) - (begin ?? 0)).toBeGreaterThan(0.1);
    expect(((fault ?? 0) - (begin ?? 0)) / ((last ?? 0) - (begin ?? 0))).toBeLessThan(0.3);
  });
});

test("a file is opened with the same numbers after the page was loaded again", async ({ page }) => {
  await alone(async (server) => {
    await open(page, server, "press-1", "scope");
    await expect(page.getByText(/acyclic, measured \d+\.\d Hz/)).toBeVisible();
    await expect(page.getByText("Controller: plc-1").first()).toBeVisible();
    await page.getByRole("textbox", { name: "Parameter" }).fill("VBUS.VALUE");
    await page.getByRole("button", { name: "Add" }).click();
    await expect(page.getByRole("row", { name: "VBUS.VALUE" })).toBeVisible();
    // a difference of two signals is a signal, of what is recorded too
    await page.getByRole("region", { name: "Difference" }).getByRole("button", { name: "Calculate" }).click();
    const difference = page.getByRole("row", { name: / - / });
    await expect(difference).toContainText(/\d/);
    await page.getByRole("button", { name: /^Remove .* - / }).click();
    await expect(difference).toHaveCount(0);
    await page.getByRole("textbox", { name: "Parameter" }).fill("NO.SUCH");
    await page.getByRole("button", { name: "Add" }).click();
    await expect(page.getByRole("listitem").filter({ hasText: "NO.SUCH" })).toContainText(/no|not/);
    await expect.poll(async () => (await measured(page, "VBUS.VALUE")).Max).toBeGreaterThan(100);
    await page.keyboard.press("r");
    await expect(page.getByText("Stopped", { exact: true })).toBeVisible();
    const before = await saved(page, "Save CSV");
    await page.reload();
    // the choice is that of before
    await expect(page.getByRole("row", { name: "VBUS.VALUE" })).toBeVisible();
    const content = before.map((line, place) => line.replace(",", place === 0 ? ",wall," : ",,"));
    const file = { name: "run.csv", mimeType: "text/csv", buffer: Buffer.from(`${content.join("\n")}\n`) };
    await page.getByLabel("Open CSV").setInputFiles(file);
    await expect(page.getByRole("heading", { name: "Scope run.csv" })).toBeVisible();
    await expect(page.getByText("The file run.csv was opened.")).toBeVisible();
    expect(await saved(page, "Save CSV")).toEqual(before);
    await page.getByRole("button", { name: "Keep as overlay" }).click();
    await page.getByLabel("Open CSV").setInputFiles({ ...file, name: "<img src=x>.csv", buffer: Buffer.from("a,b\n") });
    await expect(page.getByRole("status").filter({ hasText: "line 1" })).toBeVisible();
    // back to the drive
    await page.keyboard.press("r");
    await expect(page.getByText(/acyclic, measured \d+\.\d Hz/)).toBeVisible();
    await page.screenshot({ path: join(pictures, "scope-overlay.png") });
  });
});

test("a spike of one sample in 600,000 is visible", async ({ entered: page }) => {
  const id = await idOf(page, "axis-1");
  await page.goto(`/drives/${encodeURIComponent(id)}/scope`);
  const lines = ["t,wall,drive,gap,NIST_A [rpm]"];
  for (let row = 0; row < 600_000; row += 1) {
    lines.push(`${row / 1000},,x,false,${row === 300_000 ? 100 : 0}`);
  }
  const file = join(pictures, "long.csv");
  writeFileSync(file, `${lines.join("\n")}\n`);
  await page.getByLabel("Open CSV").setInputFiles(file);
  await expect(page.getByRole("heading", { name: "Scope long.csv" })).toBeVisible();
  await expect.poll(async () => (await measured(page, "NIST_A")).Max).toBe(100);
  await expect
    .poll(() =>
      page.evaluate(() => {
        const canvas = document.querySelector<HTMLCanvasElement>(".plots canvas");
        const pen = canvas?.getContext("2d");
        if (!canvas || !pen) return 0;
        // the upper half, where nothing but the spike is drawn in the colour of the signal
        const { data, width } = pen.getImageData(0, 0, canvas.width, canvas.height / 2);
        const columns = new Set<number>();
        for (let at = 0; at < data.length; at += 4) {
          const [red, green, blue] = [data[at] ?? 0, data[at + 1] ?? 0, data[at + 2] ?? 0];
          if (red < 90 && green > 90 && green < 160 && blue > 150) columns.add((at / 4) % width);
        }
        return columns.size;
      }),
    )
    .toBeGreaterThan(0);
});

test("the layout is a file that another drive takes, and a foreign file changes nothing", async ({ entered: page }) => {
  const go = async (drive: string) => page.goto(`/drives/${encodeURIComponent(await idOf(page, drive))}/scope`);
  await go("press-1");
  const signals = page.getByRole("region", { name: "Signals", exact: true });
  const chosen = () => signals.locator("input:checked").count();
  await expect.poll(chosen).toBeGreaterThan(0);
  await page.getByRole("combobox", { name: "Time" }).selectOption("60000000");
  const download = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save layout" }).click();
  const file = await download;
  expect(file.suggestedFilename()).toBe("press-1-layout.json");
  const kept = JSON.parse(readFileSync(await file.path(), "utf8")) as { span: number; signals: string[] };
  expect(kept.signals.length).toBeGreaterThan(0);
  await go("axis-1");
  await expect(page.getByRole("combobox", { name: "Time" })).not.toHaveValue("60000000");
  const open = page.getByLabel("Open layout");
  await open.setInputFiles({ name: "x.json", mimeType: "application/json", buffer: Buffer.from("[1, 2]") });
  await expect(page.getByText("x.json is not a layout of the Scope.")).toBeVisible();
  await expect(page.getByRole("combobox", { name: "Time" })).not.toHaveValue("60000000");
  await open.setInputFiles(await file.path());
  await expect(page.getByRole("combobox", { name: "Time" })).toHaveValue("60000000");
  await expect.poll(chosen).toBe(kept.signals.length);
});
