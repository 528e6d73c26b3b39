/** A cable in the namespace of the tests, virtual drives of another process at its end, and the frames on it. */
import { type ChildProcess, execFileSync, spawn, spawnSync } from "node:child_process";
import { existsSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { pictures, program } from "../bench";

const ip = (...words: string[]) => execFileSync("ip", words, { stdio: "inherit" });

/** How long an event of the drives is waited for, ms. */
const HAPPENS = 10_000;

/** Drives at the end of a cable. */
export interface Wire {
  drives: ChildProcess;
  /** Waits for an event of the drives; returns after how many ms, by the clock of this process. */
  happens(text: string, since: number): Promise<number>;
  /** Kills the drives and removes the cable. */
  end(): void;
}

/** Puts so many virtual drives on a cable, axis-1, axis-2, .., whose shortest update time is so many ms. */
export function wire(count: number, least = 4): Wire {
  const file = join(pictures, "drives.toml");
  const rows = Array.from({ length: count }, (_, place) => {
    const number = place + 1;
    return `[[drive]]\nname = "axis-${number}"\nip = "192.168.98.${number + 10}/24"\nmin-cycle = "${least}ms"\n`;
  });
  writeFileSync(file, rows.join("\n"));
  ip("link", "add", "bench-here", "type", "veth", "peer", "name", "bench-there");
  ip("addr", "add", "192.168.98.1/24", "dev", "bench-here");
  ip("link", "set", "bench-here", "up");
  ip("link", "set", "bench-there", "up");
  const drives = spawn(program, ["simulate", "-i", "bench-there", file], { stdio: ["ignore", "pipe", "ignore"] });
  const seen: { text: string; time: number }[] = [];
  createInterface({ input: drives.stdout }).on("line", (text) => seen.push({ text, time: performance.now() }));
  return {
    drives,
    async happens(text, since) {
      for (const until = performance.now() + HAPPENS; performance.now() < until; ) {
        const found = seen.find((line) => line.time >= since && line.text.includes(text));
        if (found !== undefined) return found.time - since;
        await new Promise((resolve) => setTimeout(resolve, 5));
      }
      throw new Error(`the drives did not report "${text}" within ${HAPPENS} ms`);
    },
    end() {
      drives.kill("SIGKILL");
      ip("link", "del", "bench-here");
    },
  };
}

/** A cyclic frame: when it was on the cable (ms since 1970), from where to where, and its data without counter and status. */
export interface Frame {
  time: number;
  to: string;
  data: Buffer;
}

/** Records cyclic frames until `frames` is called. */
export async function record(): Promise<{ frames(): Promise<Frame[]> }> {
  const file = join(pictures, "bench.pcapng");
  rmSync(file, { force: true });
  const dumpcap = spawn(
    "dumpcap",
    ["-q", "-i", "bench-here", "-f", "ether proto 0x8892 or (vlan and ether proto 0x8892)", "-w", file],
    {
      stdio: "ignore",
    },
  );
  // its file has a head once it captures
  while (!existsSync(file) || statSync(file).size === 0) {
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  return {
    async frames() {
      // what is on its way to the file comes
      await new Promise((resolve) => setTimeout(resolve, 1500));
      const ended = new Promise((resolve) => dumpcap.once("exit", resolve));
      dumpcap.kill("SIGINT");
      await ended;
      return parse(readFileSync(file));
    },
  };
}

/** Reads the frames of a pcapng file of this computer, little endian, one interface: when they were on the cable (ms since 1970). */
export function* packets(file: Buffer): Generator<{ time: number; frame: Buffer }> {
  let unit = 1e3;
  for (let at = 0; at + 12 <= file.length; ) {
    const [type, length] = [file.readUInt32LE(at), file.readUInt32LE(at + 4)];
    if (length < 12) break;
    if (type === 1) {
      // option 9 is the resolution of times: a power of ten
      for (let option = at + 16; option + 4 <= at + length - 4; ) {
        const [code, size] = [file.readUInt16LE(option), file.readUInt16LE(option + 2)];
        if (code === 9) unit = 10 ** ((file[option + 4] ?? 6) - 3);
        if (code === 0) break;
        option += 4 + Math.ceil(size / 4) * 4;
      }
    } else if (type === 6) {
      const ticks = (BigInt(file.readUInt32LE(at + 12)) << 32n) | BigInt(file.readUInt32LE(at + 16));
      yield { time: Number(ticks) / unit, frame: file.subarray(at + 28, at + 28 + file.readUInt32LE(at + 20)) };
    }
    at += length;
  }
}

/** Returns the cyclic frames of a pcapng file. */
export function parse(file: Buffer): Frame[] {
  const frames: Frame[] = [];
  for (const { time, frame } of packets(file)) {
    const tagged = frame.readUInt16BE(12) === 0x8100 ? 4 : 0;
    const id = frame.readUInt16BE(14 + tagged);
    // cyclic data of class 1, and not discovery or alarms
    if (id >= 0x8000 && id < 0xfc00) {
      frames.push({
        time,
        to: frame.subarray(0, 6).toString("hex"),
        data: frame.subarray(16 + tagged, frame.length - 4),
      });
    }
  }
  return frames;
}

/** Place of the control word in the data to a virtual AKD with telegram 1: behind the states of its four submodules. */
const STW1 = 4;
/** Bits of the control word. OFF3 and ON are active where they are 0. */
const [ON, OFF3] = [1 << 0, 1 << 2];

/** What a frame with telegram 1 commands. */
export interface Commanded {
  /** The set speed, in steps of the telegram; only whether it is 0 matters here. */
  speed: number;
  on: boolean;
  quickStop: boolean;
}

export function commanded({ data }: Frame): Commanded {
  const word = data.readUInt16BE(STW1);
  return { speed: data.readInt16BE(STW1 + 2), on: (word & ON) !== 0, quickStop: (word & OFF3) === 0 };
}

/** Returns whether a drive was commanded to turn at that time. */
export function turned(frames: readonly Frame[], to: string, time: number): boolean {
  const before = frames.findLast((frame) => frame.to === to && frame.time < time);
  return before !== undefined && commanded(before).speed !== 0;
}

/** Returns the time of the first frame to a drive after `since` that commands this. */
export function first(
  frames: readonly Frame[],
  to: string,
  since: number,
  wanted: (of: Commanded) => boolean,
): number | null {
  const found = frames.find((frame) => frame.to === to && frame.time >= since && wanted(commanded(frame)));
  return found === undefined ? null : found.time;
}

/** Returns which value so many parts in a hundred are at most. */
export function percentile(values: readonly number[], percent: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.ceil((sorted.length * percent) / 100) - 1)] ?? Number.NaN;
}

/**
 * Lets this process run first, where root may: it stands for the hand of a user, which does not wait for a processor. What it starts
 * from then on does not.
 */
export function runFirst(): void {
  spawnSync("chrt", ["--rr", "--reset-on-fork", "--pid", "1", String(process.pid)], { stdio: "ignore" });
}

/** The clock of the frames, in ms since 1970. */
export function clock(): number {
  return performance.timeOrigin + performance.now();
}
