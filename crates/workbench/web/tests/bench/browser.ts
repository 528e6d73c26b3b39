/** Processes of a browser, and one at the other end of a cable. */
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { chmodSync, existsSync, readFileSync, readlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { type Browser, chromium, type LaunchOptions } from "@playwright/test";
import { pictures } from "../bench";

/** Returns the processes in which this browser has its pages, with their workers. */
export async function renderers(browser: Browser): Promise<number[]> {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  await session.detach();
  return processInfo.filter(({ type }) => type === "renderer").map(({ id }) => id);
}

/** Returns how much memory a process has, in MiB; what it shares with others is divided among them. */
export function memory(pid: number): number {
  const octets = /^Pss:\s+(\d+) kB/m.exec(readFileSync(`/proc/${pid}/smaps_rollup`, "utf8"))?.[1];
  return Number(octets) / 1024;
}

/** A browser in a network of its own, with a cable to this one. */
export interface Remote {
  browser: Browser;
  /** The address of this end of the cable. */
  address: string;
  /** Pulls the cable, or plugs it in. */
  cable(plugged: boolean): void;
  end(): Promise<void>;
}

const network = (pid: number | "self") => readlinkSync(`/proc/${pid}/ns/net`);

/** Starts a browser at the other end of a cable. */
export async function remote(options: LaunchOptions): Promise<Remote> {
  // a process that does nothing has the other network
  const other: ChildProcess = spawn("unshare", ["--net", "sleep", "infinity"], { stdio: "ignore" });
  const pid = other.pid ?? 0;
  while (!existsSync(`/proc/${pid}/ns/net`) || network(pid) === network("self")) {
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
  const run = (...words: string[]) => execFileSync(words[0] ?? "", words.slice(1), { stdio: "inherit" });
  const there = (...words: string[]) => run("nsenter", `--net=/proc/${pid}/ns/net`, "ip", ...words);
  run("ip", "link", "add", "page-here", "type", "veth", "peer", "name", "page-there", "netns", String(pid));
  run("ip", "addr", "add", "192.168.97.1/24", "dev", "page-here");
  run("ip", "link", "set", "page-here", "up");
  there("link", "set", "lo", "up");
  there("addr", "add", "192.168.97.2/24", "dev", "page-there");
  there("link", "set", "page-there", "up");
  const program = join(pictures, "browser-there");
  writeFileSync(program, `#!/bin/sh\nexec nsenter --net=/proc/${pid}/ns/net "${options.executablePath}" "$@"\n`);
  chmodSync(program, 0o755);
  const browser = await chromium.launch({ ...options, executablePath: program });
  return {
    browser,
    address: "192.168.97.1",
    cable: (plugged) => run("ip", "link", "set", "page-here", plugged ? "up" : "down"),
    async end() {
      await browser.close();
      run("ip", "link", "del", "page-here");
      other.kill("SIGKILL");
    },
  };
}
