/** Pages that read slowly must cost neither memory nor the beats of others. Not a part of `make test`: tools/web-bench. */
import { randomBytes } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { connect, type Socket } from "node:net";
import { expect, type Page, test } from "@playwright/test";
import { end, idOf, rows, serve } from "../bench";
import { Verdicts } from "./verdict";
import { percentile } from "./wire";

const CLIENTS = 16;
/** Octets that each of them reads in a second. */
const RATE = 1000;
const SECONDS = Number(process.env.SECONDS ?? 300);
/** What the server may need more, in MiB. */
const MEMORY = 128;
/** By how much the round trip of beats may grow, in ms. */
const TRIP = 5;

/** A text as a frame of a page. */
function frame(text: string): Buffer {
  const content = Buffer.from(text);
  const mask = randomBytes(4);
  const head = Buffer.from([0x81, 0x80 | 126, content.length >> 8, content.length & 0xff]);
  return Buffer.concat([head, mask, content.map((octet, place) => octet ^ (mask[place % 4] ?? 0))]);
}

/** Opens a socket that wants everything and reads little. */
async function slow(origin: string, cookie: string, id: string): Promise<Socket> {
  const { hostname, port, host } = new URL(origin);
  const socket = connect({ host: hostname, port: Number(port), highWaterMark: RATE } as never);
  await new Promise((resolve) => socket.once("connect", resolve));
  const key = randomBytes(16).toString("base64");
  socket.write(
    `GET /api/v1/live HTTP/1.1\r\nHost: ${host}\r\nOrigin: ${origin}\r\nCookie: ${cookie}\r\nConnection: Upgrade\r\n` +
      `Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: profidrive.live.1\r\nSec-WebSocket-Key: ${key}\r\n\r\n`,
  );
  await new Promise((resolve) => socket.once("readable", resolve));
  for (const topic of ["network", "plant", `drive/${id}/samples`, `drive/${id}/acyclic`]) {
    socket.write(frame(JSON.stringify({ type: "subscribe", topic, rate: 50, parameters: [], filler: "x".repeat(40) })));
  }
  socket.on("error", () => {});
  return socket;
}

const BUFFERS = ["/proc/sys/net/ipv4/tcp_rmem", "/proc/sys/net/ipv4/tcp_wmem"];

/**
 * Opens sockets between small buffers of the kernel, which would take in for minutes what is not read, so that the server has to
 * hold it back.
 */
async function narrow(open: () => Promise<void>): Promise<void> {
  const before = BUFFERS.map((file) => readFileSync(file, "utf8"));
  try {
    for (const file of BUFFERS) writeFileSync(file, "4096 8192 8192");
    await open();
  } finally {
    for (const [place, file] of BUFFERS.entries()) writeFileSync(file, before[place] ?? "");
  }
}

/** Octets that the server has sent to the end at this port and that it has not taken; nothing where the connection is no longer open. */
function waiting(port: number): number | null {
  const hex = port.toString(16).toUpperCase().padStart(4, "0");
  for (const line of readFileSync("/proc/net/tcp", "utf8").split("\n")) {
    const [, , there = "", state, queues = ""] = line.trim().split(/\s+/);
    if (there.endsWith(`:${hex}`) && state === "01") return Number.parseInt(queues.split(":")[0] ?? "", 16);
  }
  return null;
}

/** Resident memory of a process, in MiB. */
function memory(pid: number | undefined): number {
  const pages = /VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))?.[1];
  return Number(pages) / 1024;
}

/** Round trips as the page of an axis under control measures them, for so many seconds. */
async function trips(page: Page, seconds: number): Promise<number[]> {
  return page.evaluate(
    (time) =>
      new Promise<number[]>((resolve) => {
        const found: number[] = [];
        const timer = setInterval(() => {
          const text = document.querySelector(".control-values .small")?.textContent ?? "";
          const ms = Number(/(\d+) ms/.exec(text)?.[1]);
          if (Number.isFinite(ms)) found.push(ms);
        }, 250);
        setTimeout(() => {
          clearInterval(timer);
          resolve(found);
        }, time);
      }),
    seconds * 1000,
  );
}

test("16 pages that read 1 kB in a second", async ({ page, context }) => {
  test.setTimeout((SECONDS + 120) * 1000);
  const server = await serve("--demo", "--listen", "127.0.0.1:0");
  const clients: Socket[] = [];
  try {
    await page.goto(server.url);
    await rows(page);
    const id = await idOf(page, "axis-1");
    await page.goto(`${server.origin}/drives/${encodeURIComponent(id)}/control`);
    await page.getByRole("button", { name: "Take control" }).click();
    await expect(page.getByText(/This page has control/)).toBeVisible();
    const before = await trips(page, Math.min(20, SECONDS));
    const empty = memory(server.process.pid);
    const cookie = (await context.cookies()).map(({ name, value }) => `${name}=${value}`).join("; ");
    await narrow(async () => {
      for (let number = 0; number < CLIENTS; number += 1) clients.push(await slow(server.origin, cookie, id));
    });
    let octets = 0;
    const reading = setInterval(() => {
      for (const client of clients) octets += (client.read(RATE) as Buffer | null)?.length ?? 0;
    }, 1000);
    const during = await trips(page, SECONDS);
    const full = memory(server.process.pid);
    clearInterval(reading);
    const queues = clients.map((client) => (client.destroyed ? null : waiting(client.localPort ?? 0)));
    const [calm, busy] = [percentile(before, 99), percentile(during, 99)];
    const verdicts = new Verdicts();
    const what = `${CLIENTS} slow pages for ${SECONDS} s`;
    const open = queues.filter((queue) => queue !== null).length;
    const held = queues.filter((queue) => queue !== null && queue > 0).length;
    verdicts.least(`${what}, still connected`, open, CLIENTS, "pages", "", 0);
    verdicts.least(`${what}, with more than they read`, held, CLIENTS, "pages", `${octets} octets were read`, 0);
    const sizes = `${empty.toFixed(0)} -> ${full.toFixed(0)} MiB`;
    verdicts.most(`${what}, memory of the server grows by`, full - empty, MEMORY, "MiB", sizes);
    const round = `${calm} -> ${busy} ms`;
    verdicts.most(`${what}, p99 of the round trip of beats grows by`, busy - calm, TRIP, "ms", round);
    verdicts.end();
  } finally {
    for (const client of clients) client.destroy();
    await end(server);
  }
});
