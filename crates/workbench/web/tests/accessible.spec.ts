import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import type { Locator, Page } from "@playwright/test";
import { alone, expect, pictures, rows, test } from "./bench";
import { open, operate, options, underControl } from "./moving";
import { screens } from "./screens";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

test("what is chosen is seen with the colours of the system", async ({ entered: page }) => {
  await page.emulateMedia({ forcedColors: "active" });
  const outlined = (of: Locator) => of.evaluate((one) => getComputedStyle(one).outlineStyle);
  expect(await outlined(page.locator("nav a[aria-current]"))).toBe("solid");
  await page.keyboard.press("Control+k");
  await page.keyboard.type("axis");
  expect(await outlined(page.locator(".palette [role=option][aria-selected=true]"))).toBe("solid");
});

for (const theme of ["light", "dark", "contrast"] as const) {
  // longer words take the room that they take, in whatever colours
  for (const lang of theme === "light" ? ["", "?lang=xx"] : [""]) {
    test(`axe finds nothing: ${theme} ${lang}`, async ({ entered: page }) => {
      // 18 screens, most of them twice
      test.setTimeout(120_000);
      if (theme === "contrast") await page.getByRole("combobox", { name: "Theme" }).selectOption("contrast");
      else await page.emulateMedia({ colorScheme: theme });
      for (const [name, path] of await screens(page)) {
        // without longer words they were looked at
        if (lang !== "" && name.endsWith("-none")) continue;
        await page.goto(path + lang);
        await expect(page.locator("main h1")).toBeVisible();
        await expect(page.locator(".bars")).toHaveCount(0, { timeout: 30_000 });
        await expect(page.getByRole("option").filter({ hasText: "axis-1" }).first()).toBeAttached();
        await expect(page.getByText(/(Connecting|Waiting for the first values) \.\./)).toHaveCount(0);
        // by the protocol of the browser, which the policy of the page does not bind
        await page.evaluate(axe);
        // its layout is that of the others
        const sizes = [[1366, 768] as const, ...(theme === "contrast" ? [] : [[768, 950] as const])];
        for (const [width, height] of sizes) {
          await page.setViewportSize({ width, height });
          await page.screenshot({ path: join(pictures, `${name}-${theme}${lang ? "-long" : ""}-${width}.png`) });
          // other colours are looked at once, the layout with one of them
          if (theme === "dark" && width < 1000) continue;
          expect(await violations(page), `${name} ${width}`).toEqual([]);
        }
      }
    });
  }
}

/** What axe finds on the page as it is. */
async function violations(page: Page): Promise<unknown[]> {
  return page.evaluate(async () => {
    const { axe } = window as unknown as { axe: { run(): Promise<{ violations: unknown[] }> } };
    return (await axe.run()).violations;
  });
}

for (const theme of ["light", "dark"] as const) {
  test(`axe finds nothing in control, after STOP, in dialogs and in what is unfolded: ${theme}`, async ({ page }) => {
    await alone(async (server) => {
      await page.emulateMedia({ colorScheme: theme });
      await open(page, server.url, "axis-1");
      await expect(page.getByRole("button", { name: "Take control" })).toBeEnabled();
      await page.evaluate(axe);
      await options(page);
      expect(await violations(page), "options").toEqual([]);
      await underControl(page, async () => {
        await operate(page);
        expect(await violations(page), "in control").toEqual([]);
        // axe has not kept the page from its beats
        await expect(page.getByText("IN CONTROL")).toBeVisible({ timeout: 1000 });
        await expect(page.getByRole("button", { name: "Release" })).toBeVisible({ timeout: 1000 });
        await page.keyboard.press("Control+Space");
        await expect(page.getByText(/STOP \d+ was pressed by this session/)).toBeVisible();
      });
      expect(await violations(page), "after STOP").toEqual([]);
      for (const [key, dialog] of [
        ["Control+k", page.locator(".palette")],
        ["?", page.getByRole("dialog", { name: "Keys" })],
      ] as const) {
        await page.keyboard.press(key);
        await expect(dialog).toBeVisible();
        expect(await violations(page), key).toEqual([]);
        await page.keyboard.press("Escape");
        await expect(dialog).toHaveCount(0);
      }
      for (const screen of ["Telegram", "State machine", "Virtual drives"]) {
        await page.getByRole("link", { name: screen, exact: true }).click();
        await expect(page.locator("main h1")).toBeVisible();
        await expect(page.locator(".bars")).toHaveCount(0);
        for (const summary of await page.locator("main summary").all()) await summary.click();
        await expect(page.locator("main details[open]").first()).toBeVisible();
        expect(await violations(page), screen).toEqual([]);
      }
    });
  });
}

test("the keyboard reaches everything on each screen, with a visible focus", async ({ entered: page }) => {
  test.setTimeout(120_000);
  for (const [name, path] of await screens(page)) {
    if (name.includes("-")) continue;
    // the log may be long
    await page.goto(name === "log" ? `${path}#text=no+such+text` : path);
    await expect(page.locator("main h1"), name).toBeVisible();
    await expect(page.locator(".bars"), name).toHaveCount(0, { timeout: 30_000 });
    const count = await page.evaluate(() => {
      const reached = new Set<Element>();
      const ringless: string[] = [];
      // a list that makes its rows while one goes through them has a test of its own
      const wanted = () =>
        [
          ...document.querySelectorAll("a[href], button:enabled, select:enabled, input:enabled, textarea, summary"),
        ].filter((one) => one.checkVisibility() && !one.closest("[data-key], [tabindex='-1']"));
      document.addEventListener("focusin", ({ target }) => {
        const one = target as HTMLElement;
        reached.add(one);
        const { outlineStyle, outlineWidth } = getComputedStyle(one);
        if (outlineStyle === "none" || outlineWidth === "0px") ringless.push(one.outerHTML.slice(0, 120));
      });
      Object.assign(window, {
        walked: () => ({
          ringless,
          missed: wanted()
            .filter((one) => !reached.has(one))
            .map((one) => one.outerHTML.slice(0, 120)),
        }),
      });
      return wanted().length;
    });
    const walked = () =>
      page.evaluate(() => (window as unknown as { walked(): { ringless: string[]; missed: string[] } }).walked());
    for (let press = 0; press < count + 10; press += 1) await page.keyboard.press("Tab");
    // rows between, whose number is that of the list
    for (let press = 0; press < 100 && (await walked()).missed.length > 0; press += 1) {
      await page.keyboard.press("Tab");
    }
    expect(await walked(), name).toEqual({ ringless: [], missed: [] });
  }
});

test("keys lead to screens, drives and fields, and can be switched off", async ({ entered: page }) => {
  await page.keyboard.press("g");
  await page.keyboard.press("o");
  await expect(page.getByText("Select a drive to see why it does not run.")).toBeVisible();
  await page.keyboard.press("g");
  await page.keyboard.press("n");
  await expect(page.getByRole("heading", { name: "Network" })).toBeVisible();
  // the list of keys switches them off, but for STOP
  await page.keyboard.press("?");
  const keys = page.getByRole("dialog", { name: "Keys" });
  await expect(keys.getByRole("row", { name: "g n Network" })).toBeVisible();
  // the keys of STOP are in sight, wherever the focus is
  await expect(keys.getByRole("row", { name: "Ctrl+Space STOP, everywhere" })).toBeInViewport({ ratio: 1 });
  await keys.getByRole("checkbox").uncheck();
  await page.keyboard.press("Escape");
  await expect(keys).toHaveCount(0);
  await page.keyboard.press("Control+k");
  await page.keyboard.press("g");
  await page.keyboard.press("l");
  await expect(page.getByRole("heading", { level: 1, name: "Network" })).toBeVisible();
  await page.getByRole("button", { name: "Keys ?" }).press("Enter");
  await keys.getByRole("checkbox").check();
  await keys.getByRole("button", { name: "Close" }).click();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("axis-1");
  await expect(page.getByRole("option", { name: "axis-1: Overview" })).toHaveAttribute("aria-selected", "true");
  await page.keyboard.press("Enter");
  await expect(page.locator(".why-not")).toBeVisible();
  await page.keyboard.press("Control+k");
  await page.keyboard.type("log");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("heading", { level: 1, name: "Log" })).toBeVisible();
  await page.keyboard.press("/");
  await expect(page.getByRole("searchbox", { name: "Search" })).toBeFocused();
});

test("shortcuts react with the focus on a box and on a slider, not in a field", async ({ entered: page }) => {
  await page.getByRole("link", { name: "press-1" }).click();
  await page.getByRole("link", { name: "Scope", exact: true }).click();
  await page.getByRole("checkbox").first().focus();
  await page.keyboard.press("c");
  await page.getByRole("slider").first().focus();
  await page.keyboard.press("g");
  await page.keyboard.press("p");
  const search = page.getByRole("searchbox");
  await expect(search).toBeVisible();
  await search.focus();
  await page.keyboard.press("g");
  await page.keyboard.press("n");
  await expect(search).toHaveValue("gn");
});

test("on a touch screen STOP is at the lower right, and what is pressed is large", async ({ browser, demo }) => {
  const context = await browser.newContext({
    baseURL: demo.origin,
    hasTouch: true,
    isMobile: true,
    viewport: { width: 768, height: 1024 },
  });
  const page = await context.newPage();
  await page.goto(demo.url);
  await rows(page);
  for (const [name, path] of await screens(page)) {
    await page.goto(path);
    await expect(page.locator("main h1")).toBeVisible();
    const stop = page.getByRole("button", { name: /^STOP/ });
    const seen = await stop.evaluate((button) => {
      const { x, y, width, height, right, bottom } = button.getBoundingClientRect();
      const nav = document.querySelector("nav")?.getBoundingClientRect();
      return {
        hit: document.elementFromPoint(x + width / 2, y + height / 2) === button,
        corner: innerWidth - right < 16 && bottom <= (nav?.top ?? 0) && innerHeight - bottom < 100,
        bottom: Math.round(nav?.bottom ?? 0) === innerHeight && (nav?.top ?? 0) > innerHeight - 100,
        sideways: document.documentElement.scrollWidth > innerWidth,
      };
    });
    expect(seen, name).toEqual({ hit: true, corner: true, bottom: true, sideways: false });
    const ends = await page
      .locator("nav > a")
      .evaluateAll((all) => all.map((one) => one.getBoundingClientRect().right));
    expect(Math.max(...ends), `${name}: each screen is in sight`).toBeLessThanOrEqual(768);
    const small = await page
      .locator(
        "button:visible, select:visible, summary:visible, nav a:visible, .next-steps a:visible, input:not([type=checkbox]):visible",
      )
      .evaluateAll((all) =>
        all
          // rows of a table that was filled meanwhile are gone
          .filter((one) => one.isConnected && !one.closest(".tools .file, label.button"))
          .filter((one) => one.getBoundingClientRect().height < 44)
          .map((one) => one.outerHTML.slice(0, 120)),
      );
    expect(small, name).toEqual([]);
    if ((await page.locator(".pad").count()) > 0) {
      // the speed stays in sight, and the pad is above the screens
      const pad = page.locator(".pad");
      await pad.evaluate((one) => one.scrollIntoView({ block: "nearest" }));
      const speed = await page.locator(".control-values .main").first().boundingBox();
      const buttons = await pad.boundingBox();
      const nav = await page.locator("nav").boundingBox();
      expect(speed?.y).toBeGreaterThan((await page.locator(".top").boundingBox())?.height ?? 0);
      expect((buttons?.y ?? 0) + (buttons?.height ?? 0)).toBeLessThan(nav?.y ?? 0);
    }
  }
  await page.getByRole("button", { name: /^STOP/ }).tap();
  await expect(page.getByRole("alert")).toContainText("was received");
  // the notice is not above STOP, and STOP not above what it offers, with longer words either
  await page.getByRole("button", { name: /^STOP/ }).tap();
  await page.goto("/network?lang=xx");
  const reset = page.getByRole("button", { name: /Reset STOP/ });
  await expect(reset).toBeVisible();
  const [left, right] = [await reset.boundingBox(), await page.locator(".stop").boundingBox()];
  expect((left?.x ?? 0) + (left?.width ?? 0)).toBeLessThanOrEqual(right?.x ?? 0);
  await context.close();
});

test("a tablet and a phone have their screens at the lower end, a phone those that look", async ({ entered: page }) => {
  const links = page.locator("nav > a:visible");
  const offered = ["Network", "Overview", "Faults"];
  for (const [name, path] of await screens(page)) {
    await page.goto(path);
    await expect(page.locator("main h1")).toBeVisible();
    for (const [width, height] of [
      [768, 950],
      [600, 900],
    ] as const) {
      await page.setViewportSize({ width, height });
      const seen = await page.evaluate(() => {
        const nav = document.querySelector("nav")?.getBoundingClientRect();
        const stop = document.querySelector(".stop")?.getBoundingClientRect();
        const rows = [...document.querySelectorAll("tbody tr")].filter((row) => row.checkVisibility());
        return {
          below: nav?.bottom === innerHeight && nav.top > innerHeight - 100,
          corner: stop !== undefined && (nav?.right ?? 0) - stop.right < 16 && stop.bottom <= (nav?.top ?? 0),
          high: stop?.height === 64,
          rows: rows.every((row) => row.getBoundingClientRect().height >= 43),
        };
      });
      // the histogram is a picture made of rows
      const rows = name === "telegram" ? { ...seen, rows: true } : seen;
      expect(rows, `${name} ${width}`).toEqual({ below: true, corner: true, high: true, rows: true });
      if (width < 700) await expect(links).toHaveText(offered);
      else await expect(links).toHaveCount(12);
    }
    const needs = page.getByText("This screen is made for a width of 700 px");
    const whole = ["network", "overview", "faults"].includes(name.split("-")[0] ?? "");
    await expect(needs).toHaveCount(whole ? 0 : 1);
  }
  // nothing else leads to another screen
  await page.goto("/network");
  // what matters most is first, and in sight
  await expect(page.locator("thead th").filter({ hasText: /\w/ }).first()).toHaveText("Name");
  for (const [width, seen] of [
    [390, ["Name", "State"]],
    [768, ["Name", "State", "Actions"]],
  ] as const) {
    await page.setViewportSize({ width, height: 844 });
    for (const name of seen) {
      const box = await page.getByRole("columnheader", { name, exact: true }).boundingBox();
      expect((box?.x ?? width) + (box?.width ?? 0), `${name} at ${width}`).toBeLessThanOrEqual(width);
    }
  }
  await page.setViewportSize({ width: 600, height: 900 });
  await expect(page.getByRole("row", { name: "axis-2" })).toBeVisible();
  await page.getByRole("link", { name: "axis-2", exact: true }).click();
  await expect(page.locator(".why-not")).toBeVisible();
  const elsewhere = await page
    .locator("main a:visible")
    .evaluateAll((all) =>
      all.map((one) => one.getAttribute("href") ?? "").filter((to) => !/overview|faults|network/.test(to)),
    );
  expect(elsewhere).toEqual([]);
});
