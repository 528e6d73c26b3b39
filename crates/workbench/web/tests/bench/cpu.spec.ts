/**
 * What a server with 64 drives costs, that are virtual and in another process at the end of a cable. Not a part of `make test`:
 * tools/web-bench.
 */
import { readFileSync } from "node:fs";
import { type Browser, expect, type Page, test } from "@playwright/test";
import { end, type Running, serve } from "../bench";
import { Verdicts } from "./verdict";
import { wire } from "./wire";

const DRIVES = Number(process.env.DRIVES ?? 64);
/** For how long processor time is counted, s. */
const SECONDS = Number(process.env.SECONDS ?? 60);
const PAGES = 3;
/** Update time of the cyclic connections, s. */
const CYCLE = 0.016;
/** Axes that one control socket may have. */
const AXES = 8;
/** Ticks of the clock by which a process is counted, in a second. */
const TICKS = 100;
/** What it may cost of one core, in parts of a hundred: without and with cyclic connections. */
const READING = 15;
const CYCLIC = 30;

/** Processor time of a process with all its threads, in s. */
function time(pid: number | undefined): number {
  const stat = readFileSync(`/proc/${pid}/stat`, "utf8");
  // the name, which is in brackets, may have blanks
  const fields = stat.slice(stat.lastIndexOf(")") + 2).split(" ");
  return (Number(fields[11]) + Number(fields[12])) / TICKS;
}

/** Returns which part of a core a server needs, in parts of a hundred. */
async function load(page: Page, server: Running): Promise<number> {
  const [before, since] = [time(server.process.pid), performance.now()];
  await page.waitForTimeout(SECONDS * 1000);
  return ((time(server.process.pid) - before) * 100_000) / (performance.now() - since);
}

async function open(browser: Browser, url: string): Promise<Page> {
  const page = await (await browser.newContext()).newPage();
  await page.goto(url);
  await expect(page.getByRole("row")).toHaveCount(DRIVES + 1, { timeout: 30_000 });
  await expect(page.getByText("no controller is connected")).toHaveCount(DRIVES, { timeout: 60_000 });
  return page;
}

async function ids(page: Page): Promise<string[]> {
  const { stations } = (await (await page.request.get(new URL("/api/v1/stations", page.url()).href)).json()) as {
    stations: { id: string }[];
  };
  return stations.map(({ id }) => id);
}

/** Takes control of all drives by sockets of this page, and sends their beats. Returns how many were taken. */
async function takeAll(page: Page, drives: string[]): Promise<number> {
  return page.evaluate(
    async ({ drives, most }) => {
      let taken = 0;
      // one socket after the other: 64 connections at once would keep this computer from its beats
      for (let first = 0; first < drives.length; first += most) {
        const part = drives.slice(first, first + most);
        await new Promise<void>((resolve) => {
          const socket = new WebSocket(`ws://${location.host}/api/v1/control`, "profidrive.control.1");
          const send = (message: object) => socket.send(JSON.stringify(message));
          let answers = 0;
          let beats = 0;
          socket.onopen = () => {
            for (const [n, drive] of part.entries()) {
              send({ type: "take", n: n + 1, drive, purpose: "speed", limit: 300, checks: true });
            }
            setInterval(() => {
              beats += 1;
              send({ type: "beat", n: beats, t: performance.now(), held: null });
            }, 50);
          };
          socket.onmessage = ({ data }) => {
            const { type } = JSON.parse(data) as { type: string };
            if (type !== "lease" && type !== "refused") return;
            if (type === "lease") taken += 1;
            answers += 1;
            if (answers === part.length) resolve();
          };
        });
      }
      return taken;
    },
    { drives, most: AXES },
  );
}

interface Half {
  direction: string;
  timing: { cycle: number; frames: number; lost: number } | null;
}

/** Frames of all drives, and those that are missing by their counters, in a direction. */
async function counted(page: Page, drives: string[], direction: string): Promise<{ frames: number; lost: number }> {
  const all = { frames: 0, lost: 0 };
  for (const id of drives) {
    const path = `/api/v1/drives/${encodeURIComponent(id)}/telegram`;
    let timing: Half["timing"] | undefined;
    const cycle = async () => {
      const answer = await page.request.get(new URL(path, page.url()).href);
      const { halves } = (await answer.json()) as { halves: Half[] };
      timing = halves.find((half) => half.direction === direction)?.timing;
      return timing?.cycle;
    };
    // of the first frames there is no timing
    await expect.poll(cycle, `${id} ${direction}`).toBeCloseTo(CYCLE, 3);
    all.frames += timing?.frames ?? 0;
    all.lost += timing?.lost ?? 0;
  }
  return all;
}

test("processor time of the server", async ({ browser }) => {
  test.setTimeout((2 * SECONDS + 240) * 1000);
  const cable = wire(DRIVES);
  const server = await serve("-i", "bench-here", "--listen", "127.0.0.1:0");
  try {
    const pages: Page[] = [];
    for (let number = 0; number < PAGES; number += 1) pages.push(await open(browser, server.url));
    const [page] = pages as [Page];
    await page.bringToFront();
    const reading = await load(page, server);
    const verdicts = new Verdicts();
    const more = `${DRIVES} drives, ${PAGES} pages, ${SECONDS} s`;
    verdicts.most("server CPU, reading at 1 Hz", reading, READING, "% of a core", more);
    const drives = await ids(page);
    expect(await takeAll(page, drives)).toBe(DRIVES);
    await expect
      .poll(async () => {
        const answer = await page.request.get(`${server.origin}/api/v1/server`);
        return ((await answer.json()) as { controlled: string[] }).controlled.length;
      })
      .toBe(DRIVES);
    const before = await counted(page, drives, "output");
    const cyclic = await load(page, server);
    const after = await counted(page, drives, "output");
    const [frames, lost] = [after.frames - before.frames, after.lost - before.lost];
    verdicts.most(`server CPU, cyclic at ${CYCLE * 1000} ms`, cyclic, CYCLIC, "% of a core", more);
    // all of them had their connections all the time
    verdicts.least("frames of the server", frames, Math.ceil((0.9 * DRIVES * SECONDS) / CYCLE), "frames", "", 0);
    verdicts.most("frames that the server missed", lost, 0, "frames", "", 0);
    verdicts.end();
  } finally {
    await end(server);
    cable.end();
  }
});
