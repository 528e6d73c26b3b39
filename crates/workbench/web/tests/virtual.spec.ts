import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { alone, end, expect, idOf, pictures, program, rows, serve, test, watch } from "./bench";

test("an event injected into a virtual drive shows on its other screens at once", async ({ page }) => {
  const wrong = watch(page);
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    // it begins with the drive of the frame
    await page.getByRole("link", { name: "fan-1" }).click();
    await page.getByRole("link", { name: "Virtual drives" }).click();
    await expect(page.getByRole("button", { name: "Select fan-1" })).toHaveAttribute("aria-pressed", "true");
    await expect(page.getByRole("row", { name: "press-1" })).toContainText(/\d+\.\d/);
    await expect(page.getByRole("row", { name: "press-1" })).toContainText("25");
    await page.getByRole("button", { name: "Select axis-1" }).click();
    // beside it, on another page
    const overview = await page.context().newPage();
    await overview.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/overview`);
    const why = overview.locator(".why-not");
    await expect(why).toHaveAttribute("data-cause", "no-controller");
    await page.getByRole("button", { name: "STO on" }).click();
    await expect(why).toHaveAttribute("data-cause", "sto", { timeout: 5000 });
    await expect(overview.getByText("not met: Safe torque off (STO)")).toBeVisible();
    await overview.emulateMedia({ colorScheme: "dark" });
    await overview.screenshot({ path: join(pictures, "overview-sto-dark.png") });
    await expect(page.getByRole("status").filter({ hasText: "axis-1: sto=on" }).first()).toBeVisible();
    // what lasts is named in its row, and has a button that ends it
    const row = page.getByRole("row", { name: "axis-1" });
    await expect(row).toContainText("sto=on");
    await page.getByRole("button", { name: "End sto=on" }).click();
    await expect(row).not.toContainText("sto=on");
    await expect(why).toHaveAttribute("data-cause", "no-controller", { timeout: 5000 });
    await overview.close();
    await expect(page.getByText("No injected event is in effect.")).toBeVisible();
    await page.getByRole("combobox", { name: /^Fault/ }).selectOption("439");
    await page.getByRole("button", { name: "Until its cause is cleared" }).click();
    await expect(row).toContainText("F439");
    await expect(row).toContainText("fault=439!");
    // keys set the load step by step, and one event has it when they rest
    const loads: (string | null)[] = [];
    page.on("request", (request) => {
      if (request.url().endsWith("/plant/inject")) loads.push(request.postData());
    });
    const slider = page.getByRole("slider", { name: /^Load against the shaft/ });
    await slider.focus();
    for (let step = 0; step < 5; step += 1) await page.keyboard.press("ArrowRight");
    await expect(page.getByText("Load against the shaft: 0.5 Nm")).toBeVisible();
    await expect(row).toContainText("load=0.5Nm");
    await expect(row.getByRole("cell", { name: "0.50", exact: true })).toBeVisible();
    await expect(slider).toHaveValue("0.5");
    expect(loads).toHaveLength(1);
    await page.getByLabel("Any event").fill("load=0.2Nm");
    await page.getByRole("button", { name: "Inject" }).click();
    await expect(page.getByText("axis-1: load=0.2Nm").first()).toBeVisible();
    await page.getByLabel("Any event").fill("load=much");
    await page.getByRole("button", { name: "Inject" }).click();
    await expect(page.getByRole("status").filter({ hasText: "load" }).last()).toHaveClass("fault");
    await page.getByLabel("For seconds").fill("-3");
    await expect(page.getByText("A time is more than 0 s and at most a day.")).toBeVisible();
    await expect(page.getByRole("button", { name: "STO on" })).toBeDisabled();
    expect(wrong.filter((text) => !text.includes("400"))).toEqual([]);
  });
});

const LIFT = `
[[drive]]
name = "lift-1"
ip = "192.168.77.31/24"
travel = { negative-stop = "-5rev", positive-stop = "20rev" }

[[drive]]
name = "pump-2"
model = "vlt"
ip = "192.168.77.32/24"
parameters = { "9-22" = 102 }

[[drive]]
name = "pump-3"
model = "vlt"
ip = "192.168.77.33/24"
parameters = { "9-22" = 102 }

# reads 3-41
[[controller]]
drive = "pump-2"
telegram = 102
step = [{ at = "0s", words = [0x1155, 0, 0, 0] }]

# reads a parameter that there is not
[[controller]]
drive = "pump-3"
telegram = 102
step = [{ at = "0s", words = [0x17D0, 0, 0, 0] }]
`;

test("the ends of a way and a parameter channel are shown of drives that have them", async ({ page }) => {
  const file = join(pictures, "lift.toml");
  writeFileSync(file, LIFT);
  const server = await serve("--plant", file, "--listen", "127.0.0.1:0");
  const wrong = watch(page);
  try {
    await page.goto(server.url);
    await page.getByRole("link", { name: "Virtual drives" }).click();
    await expect(page.getByRole("row", { name: "lift-1" })).toContainText("stop -5.00, stop 20.00");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "pump-2"))}/telegram`);
    const channel = page.locator(".channel");
    const request = channel.getByRole("row", { name: /^Request/ });
    const reply = channel.getByRole("row", { name: /^Reply/ });
    await expect(request).toContainText("11 55");
    await expect(request).toContainText("3-41");
    // 3.00 s in steps of 10 ms, as the drive has it
    await expect(reply).toContainText("21 55");
    await expect(reply).toContainText("00 00 01 2C");
    await expect(reply).toContainText("(3-41) = 3 s");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(await idOf(page, "pump-3"))}/telegram`);
    await expect(request).toContainText("17 D0");
    await expect(reply).toContainText("77 D0");
    await expect(reply.locator(".fault")).toContainText("parameter number does not exist");
    expect(wrong).toEqual([]);
  } finally {
    await end(server);
  }
});

test("events that were injected become a plant file that repeats them", async ({ page }) => {
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "Virtual drives" }).click();
    await page.getByRole("button", { name: "Select axis-1" }).click();
    await page.getByRole("button", { name: "Record" }).click();
    await expect(page.getByRole("link", { name: "Save 0 events" })).toBeVisible();
    const one = page.getByRole("link", { name: "Save 1 event", exact: true });
    const clicks = [
      ["STO on", "sto=on"],
      ["STO off", "sto=off"],
      ["Pull the cable", "cable=pulled"],
      ["Plug the cable", "cable=plugged"],
    ] as const;
    for (const [name, event] of clicks) {
      await page.getByRole("button", { name, exact: true }).click();
      await expect(
        page
          .getByRole("status")
          .filter({ hasText: `axis-1: ${event}` })
          .first(),
      ).toBeVisible();
      if (name === "STO on") await expect(one).toBeVisible();
    }
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.getByRole("link", { name: "Save 4 events" }).click(),
    ]);
    const printed = execFileSync(program, ["simulate", "--virtual-time", await download.path(), "--for", "20s"], {
      encoding: "utf8",
    });
    const happened = printed.split("\n").filter((line) => line.includes("axis-1") && line.includes("! "));
    expect(happened.map((line) => line.split("! ")[1]?.trim())).toEqual(clicks.map(([, event]) => event));
  });
});

test("a plant is edited with the line of an error, restarted with another seed, and paused", async ({ page }) => {
  const wrong = watch(page);
  await alone(async (server) => {
    await page.goto(server.url);
    await rows(page);
    await page.getByRole("link", { name: "Virtual drives" }).click();
    const press = page.getByRole("row", { name: "press-1" });
    await page.getByRole("button", { name: "Select axis-1" }).click();
    await page.getByRole("button", { name: "STO on" }).click();
    await expect(page.getByRole("row", { name: "axis-1" })).toContainText("sto=on");
    // time stands still: the shaft that turns to and fro rests where it is, and goes on
    await page.getByRole("button", { name: "Pause" }).click();
    await expect(page.getByText("Paused.", { exact: true })).toBeVisible();
    const time = async () => {
      const answer = await page.request.get(`${server.origin}/api/v1/plant/drives`);
      return (await answer.json()) as { time: number; seed: number; paused: boolean };
    };
    const before = await time();
    expect([before.paused, before.seed]).toEqual([true, 7]);
    await expect.poll(async () => (await time()).time).toBe(before.time);
    // every page says so, also one that is opened now
    const other = await page.context().newPage();
    await other.goto(server.url);
    await expect(other.getByText("SIMULATION paused: no drive answers.")).toBeVisible();
    await other.close();
    await page.getByRole("button", { name: "Resume" }).click();
    await expect(page.getByText("SIMULATION: these drives are virtual")).toBeVisible();
    await expect.poll(async () => (await time()).time).toBeGreaterThan(before.time);
    // the file has nothing of what was injected, which would come again; what is not valid has its line
    await page.getByText("Plant file (without injected events)").first().click();
    const file = page.getByRole("textbox", { name: "Plant file (without injected events)" });
    await expect(file).toHaveValue(/model = "vlt"/);
    const text = await file.inputValue();
    const all = await (await page.request.get(`${server.origin}/api/v1/plant/scenario`)).text();
    const times = (plant: string) => plant.split("sto=on").length;
    expect(times(all)).toBe(times(text) + 1);
    await file.fill(text.replace('model = "vlt"', 'model = "vlx"'));
    await expect(page.getByText(/^Line \d+: .*vlx/)).toBeVisible();
    await expect(page.getByRole("button", { name: "Restart with this file" })).toBeDisabled();
    // edits stay when the section is folded, and go when they shall; an answer that is no file does not replace them
    const section = page.locator("details summary").filter({ hasText: "Plant file" });
    await section.click();
    await expect(file).toBeHidden();
    await section.click();
    await expect(file).toHaveValue(/vlx/);
    const again = page.getByRole("button", { name: "Read again" });
    await page.route("**/plant/scenario*", (route) => route.fulfill({ status: 500, json: { detail: "out of paper" } }));
    await again.click();
    await expect(page.getByText("out of paper")).toBeVisible();
    await expect(file).toHaveValue(/vlx/);
    await page.unroute("**/plant/scenario*");
    await again.click();
    await expect(file).toHaveValue(text);
    // each key counts: an empty field is no zero before what follows
    const seed = page.getByRole("textbox", { name: "Seed" });
    await seed.fill("");
    await seed.pressSequentially("0011");
    await expect(seed).toHaveValue("0011");
    await expect(file).toHaveValue(/^seed = 11$/m);
    const later = (await time()).time;
    // another page has its own edits of the same file
    const third = await page.context().newPage();
    await third.goto(`${server.origin}/virtual`);
    await third.getByText("Plant file (without injected events)").first().click();
    const theirs = third.getByRole("textbox", { name: "Plant file (without injected events)" });
    await expect(theirs).toHaveValue(/model = "vlt"/);
    await theirs.fill((await theirs.inputValue()).replaceAll('"fan-1"', '"fan-9"'));
    await page.getByRole("button", { name: "Restart with this file" }).click();
    await expect(page.getByText("Restarted: the plant runs from its beginning.")).toBeVisible();
    const now = await time();
    expect(now.seed).toBe(11);
    expect(now.time).toBeLessThan(later);
    await expect(page.getByRole("row", { name: "axis-1" })).not.toContainText("sto=on");
    // and the drives are read, and turn, as before
    await expect(press).toContainText("S4", { timeout: 30_000 });
    await page.getByRole("link", { name: "Network", exact: true }).click();
    expect(wrong.filter((text) => !text.includes("500"))).toEqual([]);
    await expect(page.getByRole("heading", { level: 1, name: "Network" })).toBeVisible();
    await rows(page);
    // which the other page does not replace unseen, and then only that one is shown
    await third.getByRole("button", { name: "Restart with this file" }).click();
    await expect(third.getByRole("status").filter({ hasText: /^another plant was started since/ })).toBeVisible();
    await expect(page.getByRole("status").filter({ hasText: /^Not done: 6 drives, seed 7: another/ })).toBeVisible();
    await third.getByRole("button", { name: "Restart anyway" }).click();
    await expect(third.getByText("Restarted: the plant runs from its beginning.")).toBeVisible();
    await expect(page.getByRole("row", { name: "fan-9" })).toContainText("Safe torque off");
    await expect(page.getByRole("row", { name: "fan-1" })).toHaveCount(0);
    await expect(page.getByText("No longer answers")).toHaveCount(0);
  });
});
