import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { type Browser, chromium, type Page } from "@playwright/test";
import { alone, end, expect, idOf, idOfStation, pictures, rows, serve, test, watch } from "./bench";
import { wire } from "./bench/wire";
import {
  enable,
  ends,
  enter,
  open,
  operate,
  options,
  rest,
  sent,
  setpoint,
  shaft,
  speed,
  stays,
  turning,
  turningBy,
  underControl,
  withLateBeats,
  write,
} from "./moving";

/** Of a STOP: its frame went out, and when. */
const SENT = /STOP \d is confirmed\. axis-1: OFF3 sent at \d\d:\d\d:\d\d\.\d{3} UTC\./;

test("a newcomer takes control, enables, jogs, and releases", async ({ page }) => {
  await alone(async (server) => {
    const wrong = watch(page);
    const id = await open(page, server.url, "axis-1");
    const pad = page.getByRole("group", { name: /^Jog buttons/ });
    const place = await pad.boundingBox();
    // while it is taken it is not that of another page
    await page.evaluate(() => {
      const claims: string[] = [];
      Object.assign(window, { claims });
      new MutationObserver(() => {
        const claim = /[^.]*(has control of this drive|hands the drive over)/.exec(
          document.body.textContent ?? "",
        )?.[0];
        if (claim !== undefined) claims.push(claim);
      }).observe(document.body, { subtree: true, childList: true, characterData: true });
    });
    await underControl(page, async () => {
      await enable(page);
      expect(await pad.boundingBox()).toEqual(place);
      // a telegram of speed has no position: the one that was read stays
      const position = page.locator(".control-values .value").filter({ hasText: "Position" });
      await expect(position).toContainText(/\d\.\d{3}/);
      await expect(page.getByText("IN CONTROL")).toBeVisible();
      expect(await page.evaluate(() => (window as unknown as { claims: string[] }).claims)).toEqual([]);
      await expect(page.getByRole("button", { name: "STOP axis-1" })).toBeVisible();
      await turning(page, server.origin, id);
      await expect(page.locator("main").getByText("Torque on, moving")).toBeVisible();
      await page.mouse.up();
      await rest(page, server.origin, id, performance.now());
      await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
      // by a key, with the focus on the pad
      await page.getByRole("button", { name: "+20 rpm" }).focus();
      for (const other of ["Alt", "Control", "Meta"]) {
        await page.keyboard.down(other);
        await page.keyboard.down("ArrowLeft");
        expect(await page.evaluate(() => document.querySelectorAll(".jog[aria-pressed=true]").length)).toBe(0);
        await page.keyboard.up("ArrowLeft");
        await page.keyboard.up(other);
      }
      await page.keyboard.down("ArrowLeft");
      await expect.poll(async () => speed(page, server.origin, id), { intervals: [5] }).toBeLessThan(-15);
      await page.keyboard.up("ArrowLeft");
      await rest(page, server.origin, id, performance.now());
      await page.getByRole("button", { name: "Disable" }).click();
      await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
      await page.getByRole("button", { name: "Release" }).click({ timeout: 5000 });
    });
    await expect(page.getByText("Not under control")).toBeVisible();
    await expect(page.getByText("IN CONTROL")).toHaveCount(0);
    // the picture is last: nothing that is checked waits for it while the axis turns
    await underControl(page, async () => {
      await enable(page);
      await turning(page, server.origin, id);
      await page.screenshot({ path: join(pictures, "control-jog.png") });
    });
    expect(wrong).toEqual([]);
  });
});

test("STOP of any page stops the axis, and nothing moves before it is reset", async ({ page, browser }) => {
  await alone(async (server) => {
    const id = await open(page, server.url, "axis-1");
    await enable(page);
    const other = await (await (browser as Browser).newContext()).newPage();
    await enter(other, server.viewUrl);
    await turning(page, server.origin, id);
    const pressed = Date.now();
    const since = performance.now();
    await other.getByRole("button", { name: "STOP axis-1" }).click();
    const time = await rest(page, server.origin, id, since);
    console.log(`STOP of another page: at rest after ${time.toFixed(0)} ms, with the click`);
    await expect(page.getByText(/STOP 1 was pressed by session 2/)).toBeVisible();
    await expect(other.getByText(/STOP 1 was pressed by this session/)).toBeVisible();
    await expect(other.getByRole("alert").filter({ hasText: SENT })).toBeVisible();
    // the time is that of the frame, by the clock of this computer
    const [, at = ""] =
      /at (\S+) UTC/.exec((await other.getByRole("alert").filter({ hasText: SENT }).textContent()) ?? "") ?? [];
    const left = Date.parse(`${new Date(pressed).toISOString().slice(0, 11)}${at}Z`);
    expect(left).toBeGreaterThanOrEqual(pressed - 1);
    expect(left).toBeLessThanOrEqual(Date.now());
    await stays(page, server.origin, id);
    expect(Math.abs(await speed(page, server.origin, id))).toBeLessThan(0.5);
    await page.mouse.up();
    // the frame has what Control has, and not what was read before
    const frame = page.locator(".frame");
    await expect(frame.getByText("Power stage off", { exact: true })).toBeVisible();
    await expect(frame).toContainText(/ZSW1 0x[0-9A-F]{4}.*\D\u2212?0(\.0)? ?rpm/);
    await expect(page.getByRole("button", { name: "Enable" })).toBeDisabled();
    await expect(page.getByRole("button", { name: "+20 rpm" })).toBeDisabled();
    await expect(other.getByRole("button", { name: "Reset STOP" })).toBeDisabled();
    await page.getByRole("button", { name: "Reset STOP" }).click();
    await expect(page.getByText(/STOP 1 was pressed/)).toHaveCount(0);
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
    await turning(page, server.origin, id);
    // the space bar, while a button is held
    await page.keyboard.press("Space");
    await rest(page, server.origin, id, performance.now());
    await expect(page.getByText(/STOP 2 was pressed by this session/)).toBeVisible();
    await page.mouse.up();
    await other.context().close();
  });
});

/** What is old or lost, as styles have it. */
const PLACES = [".control-values.stale", "main.stale", ".frame .line.stale", ".shell.lost"];

/** Notes when the page shows its values as old and when as lost, in ms after the last message, and what it claims then. */
async function noteLoss(page: Page): Promise<void> {
  await page.addInitScript((places) => {
    let last = 0;
    const notes: Record<string, number> = {};
    Object.assign(window, { notes });
    window.WebSocket = class extends WebSocket {
      constructor(...how: ConstructorParameters<typeof WebSocket>) {
        super(...how);
        this.addEventListener("message", () => {
          last = performance.now();
          for (const name of Object.keys(notes)) delete notes[name];
        });
      }
    };
    new MutationObserver(() => {
      for (const name of places) {
        if (!(name in notes) && document.querySelector(name) !== null) notes[name] = performance.now() - last;
      }
      // what cannot be known by then
      const claims = /No telegram|No controller|Not under control|STOP not available|controls no axis|WRITE/;
      const claim = claims.exec(document.body?.textContent ?? "")?.[0];
      if (claim !== undefined) notes[claim] ??= performance.now() - last;
    }).observe(document, { subtree: true, childList: true, characterData: true, attributes: true });
  }, PLACES);
}

test("with a server that hangs values are grey within 0.5 s, and after 1 s none of before is shown", async ({
  page,
  browser,
}) => {
  await alone(async (server) => {
    const other = await (await browser.newContext()).newPage();
    for (const one of [page, other]) await noteLoss(one);
    const id = await open(page, server.url, "axis-1");
    await enable(page);
    await enter(other, server.viewUrl);
    await other.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await turning(page, server.origin, id);
    const shown = (of: Page) => of.locator(".control-values .main.number");
    for (const one of [page, other]) {
      await expect(shown(one)).toContainText(/[12]\d/);
      await expect(one.locator(".control-values")).not.toHaveClass(/stale/);
    }
    server.process.kill("SIGSTOP");
    // the page that has control misses the answers to its beats, one that watches the signs of life of the control socket; the last
    // message may have come up to one of them later by the other socket
    for (const [one, soonest, latest, lost] of [
      [page, 100, 500, 700],
      [other, 240, 1000, 1000],
    ] as const) {
      await expect(one.locator(".shell")).toHaveClass(/lost/, { timeout: 3000 });
      await expect(shown(one)).toHaveText("\u2013");
      await expect(one.getByRole("button", { name: "STOP cannot reach" })).toBeVisible();
      await expect(one.locator(".frame .line.stale")).toHaveText("\u2013STW1 \u2013ZSW1 \u2013\u2013 rpm\u2013");
      const notes = await one.evaluate(() => (window as unknown as { notes: Record<string, number> }).notes);
      console.log(JSON.stringify(notes));
      expect(notes[".control-values.stale"]).toBeGreaterThan(soonest);
      expect(notes[".control-values.stale"]).toBeLessThan(latest);
      expect(notes["main.stale"]).toBeGreaterThanOrEqual(500);
      expect(notes["main.stale"]).toBeLessThan(1000);
      // control counts from the answer to a beat, and both are lost at once
      expect(notes[".shell.lost"]).toBeGreaterThanOrEqual(lost);
      // an image that comes late on a computer with much to do is no other limit
      expect(notes[".shell.lost"]).toBeLessThan(1500);
      expect(Object.keys(notes).filter((name) => !PLACES.includes(name))).toEqual([]);
      await expect(one.locator("body")).not.toContainText(
        /No telegram|No controller|Not under control|controls no axis/,
      );
    }
    await expect(page.locator(".band.lost")).toContainText(
      "Control has ended: the workbench or the drive itself stops the axis.",
    );
    await expect(other.locator(".band.lost")).toContainText("Nothing on this page is current.");
    await page.mouse.up();
    await other.context().close();
  });
});

test("after its server has ended a page that had control claims nothing of axis, telegram and controller", async ({
  page,
}) => {
  await alone(async (server) => {
    await noteLoss(page);
    await open(page, server.url, "axis-1");
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
    await expect(page.locator(".frame")).toContainText("Telegram");
    await end(server);
    await expect(page.getByRole("button", { name: "STOP cannot reach" })).toBeVisible();
    const notes = await page.evaluate(() => (window as unknown as { notes: Record<string, number> }).notes);
    expect(Object.keys(notes).filter((name) => !PLACES.includes(name))).toEqual([]);
  });
});

/** How often each way to end a hold is tried. */
const HOLDS = Number(process.env.HOLDS ?? 3);

test("a hold ends by each of its ways, with setpoint 0 in the frames", async ({ page }) => {
  test.setTimeout(60_000 + HOLDS * 60_000);
  await alone(async (server) => {
    await withLateBeats(page);
    const id = await open(page, server.url, "axis-1");
    const take = page.getByRole("button", { name: "Take control" });
    const pressed = page.locator(".jog[aria-pressed=true]");
    await expect(take).toBeEnabled();
    for (const { name, hand, end, back, releases } of await ends(page)) {
      await test.step(name, async () => {
        for (let round = 0; round < HOLDS; round += 1) {
          await underControl(page, async () => {
            await hand.up();
            if (await take.isVisible()) await enable(page);
            await turningBy(page, server.origin, id, hand);
            // the frame that is read is not one of before the motion
            await expect.poll(() => setpoint(page, server.origin, id), { intervals: [20] }).not.toBe(0);
          });
          await end();
          await expect.poll(() => setpoint(page, server.origin, id), { message: name, intervals: [20] }).toBe(0);
          await back?.();
          await rest(page, server.origin, id, performance.now());
          // whatever ended it: what does not move the axis any more does not look pressed
          if (!releases) await expect(pressed).toHaveCount(0);
          await hand.up();
          if (releases) await expect(take).toBeEnabled();
        }
      });
    }
  });
});

test("a drive of another controller and a second page are refused in words", async ({ page, browser }) => {
  await alone(async (server) => {
    await open(page, server.url, "press-1");
    await expect(page.getByText("plc-1 controls this drive. Release the drive there first.")).toBeVisible();
    await expect(page.getByRole("button", { name: "Take control" })).toBeDisabled();
    const id = await idOf(page, "axis-1");
    await write(page, id, { "DRV.DEC": "10" });
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await enable(page);
    const other = await (await (browser as Browser).newContext()).newPage();
    await open(other, server.url, "axis-1", false);
    await expect(other.getByText("Session 1 has control of this drive.").first()).toBeVisible();
    await expect(other.locator("main").getByText("Torque on, at rest")).toBeVisible();
    // the frame names the session, and of its line nothing but a long product is cut
    const line = other.locator(".frame .line").first();
    await expect(line).toContainText("Controller: session 1");
    await expect(line.locator("[data-link]")).toBeVisible();
    const cut = () =>
      line
        .locator("> :not(:first-child)")
        .evaluateAll((all) =>
          all
            .filter((one) => one.scrollWidth > one.clientWidth)
            .map((one) => `${one.scrollWidth} ${one.clientWidth} ${one.textContent}`),
        );
    expect(await cut()).toEqual([]);
    expect(await line.evaluate((one) => one.scrollWidth > one.clientWidth)).toBe(false);
    // Overview, too, and where to go on
    const nav = other.getByRole("navigation");
    await nav.getByRole("link", { name: "Overview" }).click();
    await expect(other.locator(".why-not")).toContainText("Session 1 of this server controls this drive.");
    await other.locator(".why-not").getByRole("link", { name: "Open Control" }).click();
    const request = other.getByRole("button", { name: "Request control" });
    const waits = other.getByText("Waiting until session 1 hands the drive over.");
    const band = page.getByText("Session 2 requests control of axis-1.");
    // by the keyboard, and withdrawn by the same button
    await request.focus();
    await other.keyboard.press("Enter");
    await expect(waits).toBeVisible();
    await expect(band).toBeVisible();
    await other.keyboard.press("Enter");
    await expect(band).toHaveCount(0);
    await expect(request).toBeFocused();
    await expect(other.locator(".control > [role=status]")).toHaveText("");
    // a motion goes on, whatever is requested, and no button moves
    await page.getByRole("tab", { name: "Velocity" }).click();
    const turn = page.getByRole("button", { name: "Turn at this speed" });
    await turn.click();
    await expect.poll(() => speed(page, server.origin, id), { intervals: [5] }).toBeGreaterThan(19);
    const place = await turn.boundingBox();
    await request.click();
    await expect(band).toBeVisible();
    expect(await turn.boundingBox()).toEqual(place);
    await page.getByRole("button", { name: "Keep control" }).click();
    await expect(other.locator(".control > [role=status]")).toHaveText("session 1 keeps control of this drive");
    await expect(band).toHaveCount(0);
    expect(await speed(page, server.origin, id)).toBeGreaterThan(19);
    // on another screen, too: handed over along a ramp of two seconds, and had only after it
    await request.click();
    await page.getByRole("navigation").getByRole("link", { name: "Faults" }).click();
    await expect(band).toBeVisible();
    await page.screenshot({ path: join(pictures, "control-requested.png") });
    // what is left counts down on both pages; the frame has room for the whole product
    for (const one of [page, other]) {
      const left = one.getByText(/The request ends in \d+ s\./);
      const seconds = async () => Number(/\d+/.exec((await left.textContent()) ?? "")?.[0]);
      const first = await seconds();
      expect(first).toBeLessThanOrEqual(60);
      await expect.poll(seconds).toBeLessThan(first);
    }
    const product = page.locator(".frame .line bdi").first();
    await expect(product).toHaveText("Kollmorgen AKD");
    expect(await product.evaluate((one) => one.scrollWidth > one.clientWidth)).toBe(false);
    await page.getByRole("button", { name: "Stop and hand over" }).click();
    await expect.poll(() => speed(page, server.origin, id), { intervals: [5] }).toBeLessThan(19);
    await expect(other.getByText("The axis of session 1 stops, and is handed over.")).toBeVisible();
    expect(await speed(page, server.origin, id)).toBeGreaterThan(1);
    await expect(page.getByText("axis-1 stops, and is handed over to session 2.")).toBeVisible();
    await expect(other.getByText(/This page has control/)).toBeVisible({ timeout: 15_000 });
    expect(Math.abs(await speed(page, server.origin, id))).toBeLessThan(0.5);
    await expect(page.getByText(/This page has control/)).toHaveCount(0);
    await other.getByRole("button", { name: "Enable" }).click({ timeout: 10_000 });
    await expect(other.locator("main").getByText("Torque on, at rest")).toBeVisible();
    const tab = await other.context().newPage();
    await tab.goto(other.url());
    await expect(tab.getByText("Another page of this session has control of this drive.").first()).toBeVisible();
    await other.context().close();
    const third = await (await (browser as Browser).newContext()).newPage();
    await open(third, server.viewUrl, "axis-1", false);
    await expect(third.getByText("This session is view-only: it can stop axes, and takes no control.")).toBeVisible();
    await third.context().close();
  });
});

test("a drive that may run on needs consent, and one with a fault says why it is not enabled", async ({ page }) => {
  await alone(async (server) => {
    const id = await open(page, server.url, "pump-1");
    const said = page.locator(".control > [role=status]");
    const take = page.getByRole("button", { name: "Take control" });
    await take.click();
    await expect(said).toContainText("8-04 is Off");
    await expect(said).toContainText('the box "The drive may run on" in "Options" accepts');
    await options(page);
    await page.getByRole("checkbox", { name: /The drive may run on/ }).check();
    await page.getByRole("textbox", { name: "Highest speed" }).fill("200");
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("position");
    const velocity = page.getByRole("tab", { name: "Velocity" });
    await velocity.click();
    // for this drive alone
    const summary = page.locator(".options summary");
    await expect(summary).toHaveText(/^Options: position, up to 200 rpm.*, may run on$/);
    const drives = page.getByRole("combobox", { name: "Drive", exact: true });
    await drives.selectOption({ label: "fan-1" });
    await expect(page.getByRole("heading", { level: 1, name: "Control fan-1" })).toBeVisible();
    await expect(summary).toHaveText(/^Options: speed, up to 300 rpm.*OFF3$/);
    await expect(velocity).toHaveAttribute("aria-selected", "false");
    await expect(page.getByRole("checkbox", { name: /The drive may run on/ })).not.toBeChecked();
    await drives.selectOption(id);
    await expect(summary).toHaveText(/^Options: position, up to 200 rpm.*, may run on$/);
    await expect(velocity).toHaveAttribute("aria-selected", "true");
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("speed");
    await enable(page);
    await expect(page.locator(".control .warn")).toContainText("When the connection is lost");
    await turning(page, server.origin, id);
    await page.mouse.up();
    await rest(page, server.origin, id, performance.now());
    // what was plotted of one axis is not shown as another's
    const curve = page.locator(".plot polyline");
    await expect(curve).not.toHaveAttribute("points", "");
    await drives.selectOption({ label: "fan-1" });
    await expect(page.getByRole("heading", { level: 1, name: "Control fan-1" })).toBeVisible();
    await expect(curve).toHaveAttribute("points", "");
    await expect(page.getByText("Round trip \u2013 ms")).toBeVisible();
    await drives.selectOption(id);
    await page.getByRole("button", { name: "Release" }).click();
    await expect(page.getByText("Not under control")).toBeVisible();
    // consent ends with the control it was given for, a limit does not
    await expect(summary).toHaveText(/up to 200 rpm.*OFF3$/);
    const other = await idOf(page, "fan-1");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(other)}/control`);
    await options(page);
    await page.getByRole("checkbox", { name: /The drive may run on/ }).check();
    await take.click();
    await expect(page.getByText(/This page has control/)).toBeVisible();
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(said).toContainText("reports a fault", { timeout: 30_000 });
  });
});

test("the first motion is slow, limits hold, and a move stops where STOP finds it", async ({ page }) => {
  await alone(async (server) => {
    const id = await open(page, server.url, "axis-1");
    // 12 rev
    await write(page, id, { "SWLS.LIMIT1": String(12 * 65_536), "SWLS.EN": "2" });
    await enable(page, true);
    await page.getByRole("tab", { name: "Move" }).click();
    const speedField = page.getByRole("textbox", { name: "Speed" });
    const distance = page.getByRole("textbox", { name: "Distance" });
    const go = page.getByRole("button", { name: "Move", exact: true });
    await speedField.fill("200");
    await distance.fill("10");
    await go.click();
    await expect(page.getByText(/the first motion is limited to a tenth/)).toBeVisible();
    // without a motion there is no direction to confirm
    const right = page.getByRole("button", { name: "The direction is correct" });
    await expect(right).toBeDisabled();
    await page.getByRole("tab", { name: "Jog" }).click();
    await turning(page, server.origin, id);
    await page.mouse.up();
    await rest(page, server.origin, id, performance.now());
    await right.click();
    await expect(right).toHaveCount(0);
    // a telegram of position has no speed: what was read stays, and the plot has the position
    const values = page.getByRole("region", { name: "Values" });
    await expect(values.locator(".value").first()).toHaveText(/^Speed \(read\).*\d\.\d/);
    await expect(values).toContainText(/Position of the last 5 s, scale .* to .* rev/);
    await expect(page.getByRole("button", { name: "Record the next step" })).toBeDisabled();
    await expect(page.getByText(/^The telegram of position mode has no set speed/)).toBeVisible();
    await page.screenshot({ path: join(pictures, "control-position.png") });
    await page.getByRole("tab", { name: "Move" }).click();
    await speedField.fill("301");
    await go.click();
    await expect(page.getByText(/above the limit of this page/)).toBeVisible();
    await speedField.fill("200");
    // not homed: the library says why, and what to do
    await page.getByRole("tab", { name: "Home" }).click();
    await page.getByRole("button", { name: "Home", exact: true }).click();
    await expect(page.getByText("Home position known")).toBeVisible();
    await page.getByRole("tab", { name: "Move" }).click();
    // past a software limit: refused with the limit, and no frame has another setpoint
    const all = () => sent(page, server.origin, id);
    const since = (await all()).at(-1)?.time ?? Number.NaN;
    await distance.fill("20");
    await go.click();
    await expect(page.locator(".control > [role=status]")).toContainText("is above the software limit of 12.000 rev");
    const after = async () => (await all()).filter(({ time }) => time >= since);
    await expect.poll(async () => (await after()).length).toBeGreaterThan(20);
    expect(new Set((await after()).map(({ data }) => data.toString("hex"))).size).toBe(1);
    await distance.fill("10");
    const from = (await shaft(page, server.origin, id)).position;
    await go.click();
    await expect.poll(async () => speed(page, server.origin, id), { intervals: [5] }).toBeGreaterThan(150);
    await expect(values.locator(".value").first()).toHaveText(/^Speed \(read\).*\d{3}\.\d/);
    await page.keyboard.press("Control+Space");
    await rest(page, server.origin, id, performance.now());
    await expect(page.getByRole("alert").filter({ hasText: SENT })).toBeVisible();
    // the message has where it rests and where it was to go, and there it stays
    const said = page.locator(".control > [role=status]");
    await expect(said).toHaveText(/^The move ended at \d\.\d{3} rev, before its target at 10\.\d{3} rev\.$/);
    const stands = Number(/at (\d\.\d{3}) rev/.exec((await said.textContent()) ?? "")?.[1]);
    const where = async () => (await shaft(page, server.origin, id)).position - from;
    expect(await where()).toBeCloseTo(stands, 1);
    const held = await where();
    await page.getByRole("button", { name: "Reset STOP" }).click();
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
    expect(await where()).toBeCloseTo(held, 2);
  });
});

test("a speed that is stored in the drive is within the highest speed of the session, or refused in words", async ({
  page,
}) => {
  // control is taken three times, and on a computer with much to do each time once more
  test.setTimeout(120_000);
  // a page that has confirmed the direction, and a server that does not know
  let forward = false;
  let confirmed = false;
  await page.routeWebSocket("**/api/v1/control", (socket) => {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      const confirms = String(message).includes('"confirm"');
      confirmed ||= confirms;
      if (forward || !confirms) server.send(message);
    });
    server.onMessage((message) => {
      const text = String(message);
      const pretends = confirmed && !forward;
      socket.send(pretends ? text.replaceAll('"confirmed":false', '"confirmed":true') : text);
    });
  });
  await alone(async (server) => {
    const id = await open(page, server.url, "axis-1");
    await options(page);
    await page.getByRole("textbox", { name: "Highest speed" }).fill("100");
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("position");
    await page.getByRole("checkbox", { name: /Set the operating mode/ }).check();
    await page.getByRole("textbox", { name: "Speed rpm", exact: true }).fill("5");
    const said = page.locator(".control > [role=status]");
    const tab = (name: string) => page.getByRole("tab", { name }).click();
    const home = page.getByRole("button", { name: "Home", exact: true });
    /** Takes the drive, jogs it as slowly as a first motion has to be, confirms the direction, and homes it. */
    const homing = async () => {
      await operate(page);
      await tab("Jog");
      await turning(page, server.origin, id, "+5 rpm", 3);
      await page.mouse.up();
      await rest(page, server.origin, id, performance.now());
      await page.getByRole("button", { name: "The direction is correct" }).click();
      await tab("Home");
      await home.click();
    };
    const release = async () => {
      await page.getByRole("button", { name: "Release" }).click();
      await expect(page.getByText("Not under control")).toBeVisible();
    };
    await underControl(page, homing);
    await expect(said).toContainText("it waits until the direction of a first motion, at 10 rpm at most, is confirmed");
    await release();
    forward = true;
    // as delivered the axis is homed where it stands: nothing turns, whatever speed is stored
    await underControl(page, homing);
    await expect(page.getByText("Home position known")).toBeVisible();
    await tab("Task");
    await page.getByRole("button", { name: "Start the task" }).click();
    await expect(said).toContainText(/is stored in the drive and cannot be read now: .*limit of 100 rpm/);
    await expect(said).toContainText("Set a limit of the drive itself that is as low");
    await release();
    await write(page, id, { "HOME.MODE": "4", "HOME.V": "600" });
    await underControl(page, homing);
    await expect(said).toContainText(/600 rpm, the speed that is stored in the drive, .*limit of 100 rpm/);
    await expect(said).toContainText("Store a lower speed in the drive, or take control with a higher limit");
    expect(Math.abs(await speed(page, server.origin, id))).toBeLessThan(0.5);
  });
});

test("each kind of motion says why it is off, and a drive without an address why it is not taken", async ({ page }) => {
  await alone(async (server) => {
    const axis = await open(page, server.url, "axis-1");
    const why = page.locator("#motion-why");
    const tab = (name: string) => page.getByRole("tab", { name }).click();
    await expect(page.getByText("Plot of the last 5 s, while this page has control")).toBeVisible();
    await tab("Velocity");
    await expect(why).toHaveText("Take control first.");
    await options(page);
    await page.getByRole("combobox", { name: "Control mode" }).selectOption("position");
    await page.getByRole("checkbox", { name: /Set the operating mode/ }).check();
    await page.getByRole("button", { name: "Take control" }).click();
    for (const name of ["Move", "Home", "Task"]) {
      await tab(name);
      await expect(why).toHaveText("Enable the axis first.");
    }
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(why).toHaveText('Confirm the direction first: jog, then "The direction is correct".');
    await expect(page.getByRole("button", { name: "Start the task" })).toBeDisabled();
    await tab("Jog");
    await turning(page, server.origin, axis);
    await page.mouse.up();
    await page.getByRole("button", { name: "The direction is correct" }).click();
    await tab("Task");
    await expect(why).toHaveText("It uses the speed that the task has in the drive.");
    await page.getByRole("textbox", { name: "Motion task" }).fill("1.5");
    await expect(why).toHaveText("The task is not a whole number.");
    await tab("Home");
    await expect(page.getByText("It uses the homing speed that is stored in the drive.")).toBeVisible();
    await expect(why).toHaveText("");
    await tab("Move");
    await page.getByRole("textbox", { name: "Distance" }).fill("far");
    await expect(why).toHaveText("Distance: not a number.");
    const nameless = await page.request.get(`${server.origin}/api/v1/stations`);
    const { stations } = (await nameless.json()) as { stations: { id: string; ip: string | null }[] };
    const id = stations.find(({ ip }) => ip === null)?.id ?? "";
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await expect(page.getByText('It has no IP address. Give it one with "Name .." on Network.')).toBeVisible();
    await expect(page.getByRole("button", { name: "Take control" })).toBeDisabled();
  });
});

test("a fault ends the motion, and after it is acknowledged nothing starts by itself", async ({ page }) => {
  await alone(async (server) => {
    const id = await open(page, server.url, "axis-1");
    await enable(page);
    await page.getByRole("tab", { name: "Velocity" }).click();
    await page.getByRole("button", { name: "Turn at this speed" }).click();
    await expect.poll(async () => speed(page, server.origin, id), { intervals: [5] }).toBeGreaterThan(15);
    const inject = (event: string) =>
      page.evaluate(
        async (body) => {
          const headers = { "Content-Type": "application/json" };
          await fetch("/api/v1/plant/inject", { method: "POST", headers, body });
        },
        JSON.stringify({ drive: id, event, seconds: null }),
      );
    await inject("fault=439");
    await rest(page, server.origin, id, performance.now());
    await page.getByRole("button", { name: "Acknowledge" }).click();
    await expect(page.locator("main").getByText("Power stage off")).toBeVisible();
    await stays(page, server.origin, id);
    expect(Math.abs(await speed(page, server.origin, id))).toBeLessThan(0.5);
    await page.getByRole("button", { name: "Enable" }).click();
    await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
  });
});

test("a page that is frozen, hidden, closed or killed, and a network that is cut, stop the axis", async ({
  browser,
}) => {
  // control is taken five times
  test.setTimeout(120_000);
  await alone(async (server) => {
    const watcher = await (await browser.newContext()).newPage();
    await watcher.goto(server.viewUrl);
    await rows(watcher);
    const id = await idOf(watcher, "axis-1");
    const measure = async (name: string, end: (page: Page) => Promise<void>) => {
      const context = await browser.newContext();
      const page = await context.newPage();
      await open(page, server.url, "axis-1", false);
      await enable(page);
      await turning(page, server.origin, id);
      // how soon is measured by a benchmark (bench/gone.spec.ts)
      const since = performance.now();
      await end(page);
      const time = await rest(watcher, server.origin, id, since);
      console.log(`${name}: at rest after ${time.toFixed(0)} ms`);
      // and control ends, so that another page can take it
      await expect
        .poll(async () => {
          const answer = await watcher.request.get(`${server.origin}/api/v1/server`);
          return ((await answer.json()) as { controlled: string[] }).controlled.length;
        })
        .toBe(0);
      await context.close();
    };
    await measure("the main thread of the page hangs", async (page) => {
      const hang = page.evaluate(() => {
        const until = performance.now() + 3000;
        while (performance.now() < until);
      });
      hang.catch(() => {});
    });
    await measure("the page is hidden", async (page) => {
      await page.evaluate(() => {
        Object.defineProperty(document, "hidden", { value: true });
        document.dispatchEvent(new Event("visibilitychange"));
      });
    });
    await measure("the tab is closed", async (page) => {
      void page.close();
    });
    await measure("the network is cut", async (page) => {
      await page.context().setOffline(true);
    });
    await measure("the renderer crashes", async (page) => {
      const session = await page.context().newCDPSession(page);
      session.send("Page.crash").catch(() => {});
    });
    await watcher.context().close();
  });
});

test("a browser that is killed while a button is held stops the axis", async ({ browser }, testInfo) => {
  await alone(async (server) => {
    const watcher = await (await browser.newContext()).newPage();
    await watcher.goto(server.viewUrl);
    await rows(watcher);
    const id = await idOf(watcher, "axis-1");
    const doomed = await chromium.launchServer({ ...testInfo.project.use.launchOptions });
    const page = await (await (await chromium.connect(doomed.wsEndpoint())).newContext()).newPage();
    await open(page, server.url, "axis-1", false);
    await enable(page);
    await turning(page, server.origin, id);
    const since = performance.now();
    doomed.process().kill("SIGKILL");
    const time = await rest(watcher, server.origin, id, since);
    console.log(`the browser is killed: at rest after ${time.toFixed(0)} ms`);
    await watcher.context().close();
  });
});

// the drive is in another process, at the other end of a cable: nothing but itself can stop it
for (const signal of ["SIGKILL", "SIGSTOP"] as const) {
  test(`a server that ends by ${signal} leaves the axis to the watchdog of the drive`, async ({ page }) => {
    const cable = wire(1);
    const server = await serve("-i", "bench-here", "--listen", "127.0.0.1:0");
    try {
      await page.goto(server.url);
      await expect(page.getByRole("row", { name: "axis-1" })).toContainText("no controller is connected", {
        timeout: 30_000,
      });
      const id = await idOfStation(page, "axis-1");
      await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
      const take = page.getByRole("button", { name: "Take control" });
      await expect(take).toBeDisabled();
      for (const line of [
        "I see the axis",
        "The travel range is clear of people and things",
        "I can reach the emergency stop",
      ]) {
        await page.getByRole("checkbox", { name: line }).check();
      }
      await take.click();
      await expect(page.getByText(/This page has control/)).toBeVisible();
      // what was seen was seen before this control, and not before the next
      await page.getByRole("button", { name: "Release" }).click();
      await expect(page.getByText("Not under control")).toBeVisible();
      await expect(page.getByRole("checkbox", { name: "I see the axis" })).not.toBeChecked();
      await expect(take).toBeDisabled();
      for (const line of ["I see the axis", "The travel range", "I can reach"]) {
        await page.getByRole("checkbox", { name: line }).check();
      }
      await take.click();
      await expect(page.getByText(/This page has control/)).toBeVisible();
      await page.getByRole("button", { name: "Enable" }).click();
      await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
      await page.getByRole("tab", { name: "Velocity" }).click();
      await page.getByRole("button", { name: "Turn at this speed" }).click();
      await expect(page.locator("main").getByText("Torque on, moving")).toBeVisible();
      const since = performance.now();
      server.process.kill(signal);
      const fault = await cable.happens("fault F702", since);
      const off = await cable.happens("-> S1 switching on inhibited", since);
      console.log(`${signal} of the server: F702 after ${fault.toFixed(0)} ms, off after ${off.toFixed(0)} ms`);
      await expect(page.getByText(/Connection to the workbench lost/)).toBeVisible();
      await expect(page.getByText("IN CONTROL")).toHaveCount(0);
    } finally {
      await end(server);
      cable.end();
    }
  });
}

test("a server that ends serves until its axes rest, and ends their ramps by a quick stop at a second signal", async ({
  page,
}) => {
  const file = join(pictures, "slow.toml");
  writeFileSync(file, '[[drive]]\nname = "slow"\nip = "192.168.77.30/24"\nparameters = { "DRV.DEC" = "2rpm/s" }\n');
  const server = await serve("--plant", file, "--listen", "127.0.0.1:0");
  const ended = new Promise<number | null>((resolve) => server.process.once("exit", resolve));
  try {
    await page.goto(server.url);
    await expect(page.getByRole("row", { name: "slow" })).toContainText("no controller is connected");
    const id = await idOf(page, "slow");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await enable(page);
    await page.getByRole("tab", { name: "Velocity" }).click();
    await page.getByRole("button", { name: "Turn at this speed" }).click();
    await expect.poll(() => speed(page, server.origin, id)).toBeGreaterThan(19);
    server.process.kill("SIGINT");
    // along its ramp, of ten seconds, and pages are served meanwhile
    await expect.poll(() => speed(page, server.origin, id)).toBeLessThan(18);
    expect(server.process.exitCode).toBeNull();
    // signals within a second are one: of its ramp that is 2 rpm
    await expect.poll(() => speed(page, server.origin, id)).toBeLessThan(15);
    const before = await speed(page, server.origin, id);
    expect(before).toBeGreaterThan(8);
    const since = performance.now();
    server.process.kill("SIGINT");
    expect(await ended).toBe(0);
    const took = performance.now() - since;
    console.log(`second signal at ${before.toFixed(1)} rpm: ended after ${took.toFixed(0)} ms`);
    expect(took).toBeLessThan((before / 2) * 1_000);
  } finally {
    await end(server);
  }
});

test("STOP lets an axis coast where that is chosen, a travel ends a motion, and beats are shown", async ({ page }) => {
  await alone(async (server) => {
    const wrong = watch(page);
    const id = await open(page, server.url, "axis-1");
    await options(page);
    await page.getByRole("combobox", { name: "STOP reaction" }).selectOption("off2");
    const travel = page.getByRole("textbox", { name: /^Longest travel/ });
    await travel.fill("far");
    await expect(page.getByRole("button", { name: "Take control" })).toBeDisabled();
    await travel.fill("0.5");
    // the chosen stop and the travel are in sight with the options folded, and of this drive alone
    const summary = page.locator(".options summary");
    const chosen = "Options: speed, up to 300 rpm, travel up to 0.5 rev, STOP: power stage off, OFF2: coasts";
    await expect(summary).toHaveText(chosen);
    const outside = () =>
      page.locator(".steps > section").evaluateAll((all) =>
        all.flatMap((section) => {
          const { right } = section.getBoundingClientRect();
          return [...section.querySelectorAll("select, input, p, label")]
            .filter((one) => one.getBoundingClientRect().right > right)
            .map((one) => one.outerHTML);
        }),
      );
    expect(await outside()).toEqual([]);
    await page.screenshot({ path: join(pictures, "control-options.png") });
    const drives = page.getByRole("combobox", { name: "Drive", exact: true });
    await drives.selectOption({ label: "axis-2" });
    await expect(summary).toHaveText("Options: speed, up to 300 rpm, any travel, STOP: quick stop, OFF3");
    await drives.selectOption(id);
    await expect(summary).toHaveText(chosen);
    await expect(page.getByText("No beats: this page has no control.")).toBeVisible();
    await enable(page);
    await expect(page.getByText(/^STOP switches its power stage off \(OFF2\)/)).toBeVisible();
    await expect(page.getByText("Beats arrive in time.")).toBeVisible();
    // the line of STOP says how it stops this axis, that it is no safety function, and its keys: all of it whole
    const why = page.locator(".frame .why");
    await expect(why).toContainText("(power stage off, OFF2: coasts). Not a safety function. STOP: Space");
    const cut = () => why.locator("*").evaluateAll((all) => all.map((one) => one.scrollWidth > one.clientWidth));
    expect(await cut()).toEqual([false, false, false]);
    await page.screenshot({ path: join(pictures, "control-frame.png") });
    await page.getByRole("tab", { name: "Velocity" }).click();
    const go = page.getByRole("button", { name: "Turn at this speed" });
    await go.click();
    await expect(page.getByText("Halted at the end of the travel of this session. It can go back.")).toBeVisible();
    await expect.poll(() => speed(page, server.origin, id)).toBeLessThan(0.5);
    await expect(page.locator("main").getByText("Torque on, at rest")).toBeVisible();
    // not on
    await go.click();
    await expect(page.getByText(/would leave the travel of this session, 0.5 rev/)).toBeVisible();
    await page.getByRole("textbox", { name: "Speed" }).fill("-20");
    await go.click();
    await expect.poll(() => speed(page, server.origin, id)).toBeLessThan(-15);
    // it coasts for a short time: whenever this looks, it was shown
    const coasts = "Coasts, nothing brakes it";
    await page.locator("main").evaluate((main, coasts) => {
      const look = () => main.textContent?.includes(coasts) && Object.assign(window, { coasts });
      new MutationObserver(look).observe(main, { subtree: true, childList: true, characterData: true });
    }, coasts);
    await page.getByRole("button", { name: /^STOP axis-1/ }).click();
    await expect.poll(() => page.evaluate(() => (window as unknown as { coasts?: string }).coasts)).toBe(coasts);
    await expect(page.locator("main").getByText("Power stage off", { exact: true })).toBeVisible();
    // who pressed STOP has no trouble with it
    await expect(page.locator(".control .warn, .control .fault")).toHaveCount(0);
    expect(wrong).toEqual([]);
  });
});
