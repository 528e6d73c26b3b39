import { readFileSync } from "node:fs";
import { alone, expect, idOf, openScreen as open, rows, test, watch } from "./bench";
import { MANY, synthetic, unknown } from "./synthetic";

test("a value is reviewed, written, verified, saved, and seen by a second page", async ({ page, browser }) => {
  await alone(async (server) => {
    const wrong = watch(page);
    const id = await open(page, server, "axis-1", "parameters");
    const other = await (await browser.newContext()).newPage();
    await other.goto(server.viewUrl);
    await rows(other);
    await other.goto(`${server.origin}/drives/${encodeURIComponent(id)}/parameters`);
    for (const one of [page, other]) {
      await one.getByRole("searchbox").fill("DRV.ACC");
      await expect(one.getByRole("row", { name: "DRV.ACC p2108" })).toBeVisible();
      await expect(one.locator(".parameters-table tbody th").first()).toContainText("DRV.ACC");
    }
    const field = page.getByRole("textbox", { name: "Value of DRV.ACC", exact: true });
    await expect(field).toHaveValue("3000");
    const seen = other.getByRole("row", { name: "DRV.ACC p2108" });
    await expect(seen).toContainText("3000");
    await expect(other.getByRole("textbox")).toHaveCount(0);
    await field.fill("8000 rpm/s");
    const review = page.getByRole("region", { name: "Changes" });
    await expect(review).toContainText("3000 \u2192 8000 rpm/s");
    await expect(seen).toContainText("3000");
    // by the keyboard: Enter leads to the button, however many rows are between
    await field.press("Enter");
    await expect(review.getByRole("button", { name: "Apply 1" })).toBeFocused();
    await page.keyboard.press("Enter");
    await expect(review).toContainText("written and verified");
    // the button is gone, and the focus is where it was
    await expect(review).toBeFocused();
    await expect(page.getByRole("row", { name: "DRV.ACC p2108" })).toContainText("to be saved");
    await page.getByRole("combobox", { name: "Show" }).selectOption("unsaved");
    await expect(page.locator("[data-key]")).toHaveCount(1);
    // other pages show it, too, and so does one that is loaded again
    await expect(seen).toContainText("to be saved");
    await other.reload();
    await expect(seen).toContainText("to be saved");
    await expect(page.locator("p", { hasText: "Last change by this server" })).toContainText("3000");
    await expect(review).toContainText("lost at the next power cycle");
    await expect(seen).toContainText("8000", { timeout: 5000 });
    await expect(field).toHaveValue("8000");
    await review.getByRole("button", { name: "Save in the drive" }).click();
    await expect(review).toContainText("Save all values in the drive, by DRV.NVSAVE");
    await expect(review).not.toContainText("no memory for it");
    await review.getByRole("button", { name: "Apply 1" }).click();
    await expect(review).toContainText("saved in the drive");
    await expect(page.getByText("No matching parameters.")).toBeVisible();
    await page.getByRole("combobox", { name: "Show" }).selectOption("all");
    await expect(review).not.toContainText("lost at the next power cycle");
    await field.fill("4000");
    await review.getByRole("button", { name: "Apply 1" }).click();
    await review.getByRole("button", { name: "Undo" }).click();
    await expect(review).toContainText("Undone");
    await expect(field).toHaveValue("8000");
    await expect(other.getByText(/Values were written\. axis-1/).or(other.getByText(/Previous values/))).toBeVisible();
    expect(wrong).toEqual([]);
    await other.context().close();
  });
});

test("what was typed for a drive waits while another one is shown", async ({ page }) => {
  await alone(async (server) => {
    await open(page, server, "axis-1", "parameters");
    const drive = page.getByRole("combobox", { name: "Drive" });
    const field = page.getByRole("textbox", { name: "Value of DRV.ACC", exact: true });
    const review = page.getByRole("region", { name: "Changes" });
    await page.getByRole("searchbox").fill("DRV.ACC");
    await field.fill("400");
    await expect(review).toContainText("3000 \u2192 400 rpm/s");
    await drive.selectOption("axis-2");
    await expect(field).toHaveValue("3000");
    await expect(review.getByRole("button", { name: "Apply" })).toHaveCount(0);
    await drive.selectOption("axis-1");
    await expect(field).toHaveValue("400");
    await expect(review).toContainText("3000 \u2192 400 rpm/s");
  });
});

test("what cannot be written is said beside the rest, and nothing is written", async ({ page }) => {
  await alone(async (server) => {
    await open(page, server, "axis-1", "parameters");
    const search = page.getByRole("searchbox");
    const review = page.getByRole("region", { name: "Changes" });
    const apply = review.getByRole("button", { name: "Apply" });
    await search.fill("p1005");
    const field = page.getByRole("textbox").first();
    const name = (await field.getAttribute("aria-label")) ?? "";
    await expect(field).toHaveValue(/\d/);
    await field.fill("0.5 rpm");
    // between two values that the drive can have: both are named
    await expect(review.locator(".fault").first()).toContainText(/0.*1/);
    await expect(apply).toBeDisabled();
    await expect(review).toContainText("Nothing is written as long as a value cannot be written.");
    await search.fill("DRV.DEC");
    await page.getByRole("textbox", { name: "Value of DRV.DEC", exact: true }).fill("2000");
    await expect(apply).toBeDisabled();
    await search.fill("p1005");
    await page.getByRole("textbox", { name, exact: true }).press("Escape");
    await expect(review).toContainText("DRV.DEC");
    await expect(apply).toBeEnabled();
    // a reload with edits is asked about, and nothing was sent
    const sent: string[] = [];
    page.on("request", (request) => {
      if (request.url().endsWith("/apply")) sent.push(request.url());
    });
    const asked = page.waitForEvent("dialog");
    await page.evaluate(() => setTimeout(() => location.reload(), 0));
    const dialog = await asked;
    expect(dialog.type()).toBe("beforeunload");
    await dialog.dismiss();
    await expect(page.getByRole("region", { name: "Changes" })).toContainText("2000");
    const id = await idOf(page, "axis-1");
    const answer = await page.request.get(`${server.origin}/api/v1/drives/${encodeURIComponent(id)}/values/DRV.DEC`);
    expect(((await answer.json()) as { parameters: { text: string }[] }).parameters[0]?.text).not.toBe("2000");
    expect(sent).toEqual([]);
    await review.getByRole("button", { name: "Discard" }).click();
    await expect(review).toContainText("Edit a value");
  });
});

test("one name of three that cannot be written holds up all of them", async ({ page }) => {
  await alone(async (server) => {
    // a list that is wrong about one parameter: the server still knows better
    await page.route("**/api/v1/drives/*/parameters", async (route) => {
      const answer = await route.fetch();
      const list = (await answer.json()) as { parameters: { name: string; access: string }[] };
      for (const one of list.parameters) if (one.name === "IL.FB") one.access = "read, write";
      await route.fulfill({ response: answer, json: list });
    });
    const id = await open(page, server, "axis-1", "parameters");
    const search = page.getByRole("searchbox");
    const review = page.getByRole("region", { name: "Changes" });
    const wanted = { "DRV.ACC": "8000", "IL.FB": "1", "DRV.DEC": "2000" };
    for (const [name, value] of Object.entries(wanted)) {
      await search.fill(name);
      await page.getByRole("textbox", { name: `Value of ${name}`, exact: true }).fill(value);
    }
    await expect(review).toContainText("IL.FB (r2216) is read-only");
    await expect(review.getByRole("button", { name: "Apply 3" })).toBeDisabled();
    await expect(review).toContainText("Nothing is written as long as a value cannot be written.");
    const path = `${server.origin}/api/v1/drives/${encodeURIComponent(id)}/values/DRV.ACC,DRV.DEC`;
    const answer = (await (await page.request.get(path)).json()) as { parameters: { text: string }[] };
    for (const { text } of answer.parameters) expect(text).toBe("3000");
  });
});

test("a value that another program has changed meanwhile is not overwritten", async ({ page }) => {
  await alone(async (server) => {
    const id = await open(page, server, "axis-1", "parameters");
    await page.getByRole("searchbox").fill("DRV.ACC");
    await page.getByRole("textbox", { name: "Value of DRV.ACC", exact: true }).fill("8000");
    const review = page.getByRole("region", { name: "Changes" });
    await expect(review.getByRole("button", { name: "Apply 1" })).toBeEnabled();
    await page.evaluate(async (id) => {
      const post = async (path: string, body: unknown) => {
        const headers = { "Content-Type": "application/json" };
        const answer = await fetch(`/api/v1/${path}`, { method: "POST", headers, body: JSON.stringify(body) });
        return (await answer.json()) as { id: number };
      };
      const changes = [{ parameter: "DRV.ACC", value: "5000" }];
      const plan = await post(`drives/${encodeURIComponent(id)}/plans`, { changes, save: false });
      await post(`plans/${plan.id}/apply`, {});
    }, id);
    await review.getByRole("button", { name: "Apply 1" }).click();
    await expect(review).toContainText("was 3000 rpm/s, is 5000 rpm/s");
    await expect(review).toContainText("5000 \u2192 8000 rpm/s");
  });
});

test("parameters are found by their words and reached by keys", async ({ entered: page }) => {
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/parameters`);
  await expect(page.locator("[data-key]").first()).toBeVisible();
  await page.keyboard.press("/");
  await page.keyboard.type("acceleration ramp");
  await expect(page.getByText(/^\d+ of \d+$/)).toBeVisible();
  await page.getByRole("searchbox").fill("nothing like it");
  await expect(page.getByText("No matching parameters.")).toBeVisible();
  expect(new URL(page.url()).hash).toBe("#q=nothing+like+it");
  await page.getByRole("searchbox").fill("");
  await page.getByRole("combobox", { name: "Group" }).selectOption("DRV");
  await page.getByRole("button", { name: "Favourite DRV.ACC", exact: true }).click();
  await page.getByRole("combobox", { name: "Group" }).selectOption("All groups");
  await page.getByRole("combobox", { name: "Show" }).selectOption("favourites");
  await expect(page.locator("[data-key]")).toHaveCount(1);
  await page.getByRole("button", { name: "Favourite DRV.ACC", exact: true }).click();
  await page.getByRole("combobox", { name: "Show" }).selectOption("all");
  await page.getByRole("searchbox").fill("");
  await page.getByRole("region", { name: "Parameters" }).focus();
  const first = await page.locator("[data-key]").first().getAttribute("data-key");
  await page.keyboard.press("End");
  await expect.poll(() => page.locator("[data-key]").first().getAttribute("data-key")).not.toBe(first);
  // rows out of sight are not made
  expect(await page.locator("[data-key]").count()).toBeLessThan(60);
  await expect(page.locator("[data-key]").last()).toContainText(/\d/);
});

test("settings are backed up, compared, restored as a plan, and downloaded", async ({ page }) => {
  await alone(async (server) => {
    const wrong = watch(page);
    await open(page, server, "pump-1", "compare");
    await page.getByRole("button", { name: "Back up pump-1" }).click();
    const right = page.getByRole("combobox", { name: "Right" });
    await expect(right).toHaveValue(/^file pump-1-/);
    const download = page.waitForEvent("download");
    await page.getByRole("link", { name: "Download" }).click();
    expect((await download).suggestedFilename()).toMatch(/^pump-1-.*\.backup$/);
    const compare = page.getByRole("button", { name: "Compare", exact: true });
    await compare.click();
    await expect(page.getByText("Both have the same settings.")).toBeVisible();
    await page.getByRole("link", { name: "Parameters" }).click();
    await page.getByRole("searchbox").fill("3-41");
    await page.getByRole("textbox").first().fill("7");
    await page.getByRole("region", { name: "Changes" }).getByRole("button", { name: "Apply 1" }).click();
    await expect(page.getByText("written and verified")).toBeVisible();
    await page.getByRole("link", { name: "Compare" }).click();
    await compare.click();
    await expect(page.getByText("Differences: 1")).toBeVisible();
    const csv = page.waitForEvent("download");
    await page.getByRole("button", { name: "Export CSV" }).click();
    expect(readFileSync(await (await csv).path(), "utf8")).toMatch(/^Number,Name,pump-1,pump-1-.*\r\n3-41,/);
    // Overview counts the same
    await page.getByRole("link", { name: "Overview" }).click();
    await expect(page.getByText(/ago, 1 setting differs from it/)).toBeVisible();
    await page.getByRole("link", { name: "Compare", exact: true }).click();
    // with the file as base the drive is what was changed
    await page.getByRole("combobox", { name: "Base" }).selectOption(await right.inputValue());
    await compare.click();
    await expect(page.getByRole("cell", { name: "changed on the left" })).toBeVisible();
    await page.getByRole("combobox", { name: "Base" }).selectOption("");
    await page.getByRole("checkbox", { name: /^Take / }).check();
    await page.getByRole("button", { name: "Plan to restore 1 from the file" }).click();
    const review = page.getByRole("region", { name: "Changes" });
    await expect(review).toContainText("7 \u2192");
    await review.getByRole("button", { name: "Apply 1" }).click();
    await expect(review).toContainText("The previous values are in pump-1-");
    await compare.click();
    await expect(page.getByText("Both have the same settings.")).toBeVisible();
    // values as delivered: 7 is no longer among what differs, and 5 is taken back
    await page.getByRole("link", { name: "Parameters" }).click();
    await page.getByRole("searchbox").fill("3-41");
    await page.getByRole("textbox").first().fill("5");
    await page.getByRole("region", { name: "Changes" }).getByRole("button", { name: "Apply 1" }).click();
    await expect(page.getByText("written and verified")).toBeVisible();
    await page.getByRole("link", { name: "Compare" }).click();
    const delivered = await right.locator("option", { hasText: "pump-1 as delivered" }).getAttribute("value");
    await right.selectOption(delivered);
    await compare.click();
    const ramp = page.getByRole("row").filter({ has: page.getByRole("cell", { name: "3-41", exact: true }) });
    await expect(ramp).toContainText("5");
    await ramp.getByRole("checkbox").check();
    await page.getByRole("button", { name: "Plan to restore 1 as delivered" }).click();
    await expect(review).toContainText("5 \u2192");
    await review.getByRole("button", { name: "Apply 1" }).click();
    await expect(review).toContainText("written and verified");
    await compare.click();
    await expect(ramp).toHaveCount(0);
    // name and address are among what differs only where that is chosen
    await page.getByRole("combobox", { name: "Left" }).selectOption({ label: "axis-1" });
    await right.selectOption({ label: "axis-2" });
    await compare.click();
    const network = page.getByRole("checkbox", { name: "Network settings (2)" });
    await expect(network).toBeVisible();
    await expect(page.getByRole("row", { name: "name of station" })).toHaveCount(0);
    await network.check();
    await expect(page.getByRole("row", { name: "name of station" })).toContainText("axis-2");
    await expect(page.getByRole("row", { name: "IP address" })).toBeVisible();
    await network.uncheck();
    await right.selectOption(delivered);
    // of another kind of drive: both are named
    const left = page.getByRole("combobox", { name: "Left" });
    await left.selectOption({ label: "axis-1" });
    await compare.click();
    await expect(page.getByRole("alert").filter({ hasText: "VLT" })).toContainText("AKD");
    expect(wrong.filter((text) => !text.includes("400"))).toEqual([]);
  });
});

test("a narrow list of parameters ends with its last row", async ({ entered: page }) => {
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/parameters`);
  const table = page.getByRole("region", { name: "Parameters" });
  await expect(page.locator("[data-key]").first()).toBeVisible();
  for (const width of [1366, 768]) {
    await page.setViewportSize({ width, height: 900 });
    // rows that are out of sight have the height of those that are made
    await table.evaluate((one) => one.scrollTo(0, one.scrollHeight));
    await expect(page.getByRole("row").last()).toBeInViewport({ ratio: 0.9 });
    const gap = await table.evaluate((one) => {
      const rows = [...one.querySelectorAll("tr.parameter")];
      const height = (rows[5]?.getBoundingClientRect().height ?? 0) * Number(one.querySelector("table")?.ariaRowCount);
      return Math.abs(height - one.scrollHeight) / height;
    });
    expect(gap, `${width}`).toBeLessThan(0.01);
  }
});

test("a parameter of which nothing is known is one row with its octets, and the others work as before", async ({
  page,
}) => {
  await alone(async (server) => {
    const wrong = watch(page);
    await unknown(
      page,
      new Map([
        [4711, { text: "305419896", value: 305_419_896, raw: 305_419_896, hex: "12 34 56 78" }],
        [4712, { text: "DE AD BE EF", value: "DE AD BE EF", raw: null, hex: "DE AD BE EF", format: 0x7f }],
      ]),
    );
    await open(page, server, "axis-1", "parameters");
    const search = page.getByRole("searchbox");
    await search.fill("471");
    const of = (number: number) => page.locator(`[data-key="${number}"]`);
    await expect(of(4711)).toHaveCount(1);
    await expect(of(4711)).toContainText("305419896 (0x12345678)");
    await expect(of(4712)).toHaveCount(1);
    await expect(of(4712)).toContainText("cannot decode 0xDEADBEEF");
    // none of their words is cut, and nothing can be typed into them
    for (const number of [4711, 4712]) {
      await expect(of(number).getByRole("textbox")).toHaveCount(0);
      const cut = await of(number)
        .locator("td")
        .evaluateAll((all) =>
          all
            .filter((one) => one.scrollWidth > one.clientWidth)
            .map((one) => `${one.textContent} ${one.scrollWidth} ${one.clientWidth}`),
        );
      expect(cut, `${number}`).toEqual([]);
    }
    await of(4711).getByRole("button").last().click();
    await expect(page.locator(".details").getByRole("heading", { name: "4711" })).toBeVisible();
    // in one view with others, which are read, edited and written
    await search.fill("");
    await page.getByRole("region", { name: "Parameters" }).focus();
    await page.keyboard.press("End");
    await expect(of(4712)).toBeVisible();
    await expect(page.locator("[data-key] td bdi").filter({ hasText: /\d/ }).first()).toBeVisible();
    await search.fill("DRV.ACC");
    const field = page.getByRole("textbox", { name: "Value of DRV.ACC", exact: true });
    await expect(field).toHaveValue("3000");
    await field.fill("4000");
    const review = page.getByRole("region", { name: "Changes" });
    await review.getByRole("button", { name: "Apply 1" }).click();
    await expect(review).toContainText("written and verified");
    expect(wrong).toEqual([]);
    // a reading may be on its way when the server ends
    await page.unrouteAll({ behavior: "ignoreErrors" });
  });
});

test("5,000 parameters are searched and scrolled by the keyboard alone", async ({ page, demo }) => {
  // some hundred keys, one after the other
  test.setTimeout(120_000);
  const wrong = watch(page);
  await synthetic(page);
  await page.goto(demo.url);
  await rows(page);
  await page.goto(`/drives/${encodeURIComponent(await idOf(page, "axis-1"))}/parameters`);
  const count = page.locator(".parameters .title > .muted");
  await expect(count).toHaveText(`${MANY} of ${MANY}`);
  const rowsMade = () => page.locator("[data-key]").count();
  const row = (name: string) => page.getByRole("row", { name });
  await page.keyboard.press("/");
  await page.keyboard.type("SYN.4321");
  await expect(count).toHaveText(`1 of ${MANY}`);
  await expect(row("SYN.4321 p24321").getByRole("textbox")).toHaveValue(String(4321 * 3));
  await page.keyboard.press("Control+a");
  await page.keyboard.press("Delete");
  await expect(count).toHaveText(`${MANY} of ${MANY}`);
  // by the tab key to the list, which scrolls by its keys
  const list = page.getByRole("region", { name: "Parameters" });
  for (let press = 0; press < 10; press += 1) {
    if (await list.evaluate((one) => one === document.activeElement)) break;
    await page.keyboard.press("Tab");
  }
  await expect(list).toBeFocused();
  await page.keyboard.press("End");
  await expect(row("SYN.5000")).toBeInViewport({ ratio: 0.9 });
  await expect(row("SYN.5000").getByRole("textbox")).toHaveValue(String(MANY * 3));
  // rows out of sight are not made
  expect(await rowsMade()).toBeLessThan(60);
  await page.keyboard.press("Home");
  await expect(row("SYN.0001")).toBeInViewport({ ratio: 0.9 });
  const top = () => list.evaluate((one) => one.scrollTop);
  const before = await top();
  await page.keyboard.press("PageDown");
  await expect.poll(top).toBeGreaterThan(before + 200);
  // the row that is seen first is read, and so is each that is reached with the tab key
  const place = Math.ceil((await top()) / 28) + 2;
  const name = `SYN.${String(place).padStart(4, "0")}`;
  await expect(row(name).getByRole("textbox")).toHaveValue(String(place * 3));
  await page.keyboard.press("Tab");
  const key = () => page.evaluate(() => document.activeElement?.closest("[data-key]")?.getAttribute("data-key"));
  expect(await key()).not.toBeUndefined();
  // further than all rows that are made at once: the list follows the focus, and no row is left out
  const seen: number[] = [];
  for (let press = 0; press < 3 * 50; press += 1) {
    const at = Number((await key())?.slice(1));
    if (at !== seen.at(-1)) seen.push(at);
    await page.keyboard.press("Tab");
  }
  expect(seen.length).toBeGreaterThan(45);
  expect(seen).toEqual(seen.map((_, step) => (seen[0] ?? 0) + step));
  // the row with the focus goes out of sight and keeps it: the next key goes on from there
  const focused = await key();
  await page.keyboard.press("PageDown");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("PageDown");
  await expect.poll(key).toBe(focused);
  expect(wrong).toEqual([]);
  await page.evaluate(() => fetch("/api/v1/session", { method: "DELETE" }));
});
