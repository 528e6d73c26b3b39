/** What the page shows. Only `live.ts` writes, views read. */
import { batch, signal } from "@preact/signals";
import type { Server, Shaft, Station } from "../api";

/** Whether this browser is let in. */
export type Access =
  | { kind: "entering" }
  | { kind: "in" }
  /** `silent`: nothing answers yet, and the page tries again by itself. */
  | { kind: "out"; reason: string; silent: boolean };

export const access = signal<Access>({ kind: "entering" });
export const server = signal<Server | null>(null);

/** The stations as they came last; `null` before the first answer. */
export const stations = signal<Station[] | null>(null);
/** When they came, by the clock of this page in ms. */
export const received = signal(0);
/** Time since the last search when they came, s; `null` before the first. */
export const searched = signal<number | null>(null);
/** Whether this page waits for a search. */
export const searching = signal(false);
/** Whether the time of the plant stands still, so that no drive answers. */
export const paused = signal(false);
export const failure = signal<string | null>(null);

/** Where the shafts of virtual drives are, by the identity of the drive. */
export const shafts = signal<ReadonlyMap<string, Shaft>>(new Map());

/** The clock of this page in ms, a few times a second: ages are made of it. */
export const now = signal(performance.now());
/** When the workbench sent something last, by either socket and by that clock. */
let answered = performance.now();

/** The workbench sends a sign of life each 250 ms. Without any for so long, in ms, nothing is current any more; the connection is lost. */
const QUIET = 500;
const LOST = 1000;
/** A page that did nothing for this time, in ms, has messages that it has not looked at. */
const ASLEEP = 500;

/** Whether the workbench has missed a sign of life: what is shown may be old. */
export const quiet = signal(false);
/** Whole seconds without a sign of life of the workbench; `null` while the connection is not lost. */
export const silent = signal<number | null>(null);

/** Notes that the workbench sent something. */
export function heard(): void {
  answered = performance.now();
  batch(() => {
    quiet.value = false;
    silent.value = null;
  });
}

let looked = performance.now();

/**
 * Looks how long the workbench has been silent; the page calls it all the time. Returns whether it could have heard something.
 * `over`: its axes are given up. They do not go before the word of the loss is there.
 */
export function listen(over: boolean): boolean {
  const time = performance.now();
  const awake = time - looked < ASLEEP;
  looked = time;
  if (!awake) return false;
  const silence = time - answered;
  batch(() => {
    quiet.value = silence > QUIET;
    silent.value = silence > (over ? QUIET : LOST) ? Math.floor(silence / 1000) : null;
  });
  return true;
}

/** Returns the present age of something that had an age when it came, in s. */
export function aged(then: number | null): number | null {
  return then === null ? null : then + Math.max(0, now.value - received.value) / 1000;
}

/** The build of the server that this page came from. */
let build: string | null = null;
/** Whether the server is another one than the page was made for: then the page has to be loaded again. */
export const outdated = signal(false);

/** Notes the build that a server says of itself. */
export function isOfBuild(now: string): void {
  build ??= now;
  outdated.value = now !== build;
}

/** One value over time. */
export interface Track {
  times: number[];
  values: number[];
}
/** How many plants were started in the place of the first one; `null` before that is known. */
export const restarts = signal<number | null>(null);

/** Calls `forget` when another plant was started: what a screen keeps is of drives that are no more. */
export function whenRestarted(forget: () => void): void {
  let before = restarts.peek();
  restarts.subscribe((count) => {
    if (before !== null && count !== before) forget();
    before = count;
  });
}

/** Values of the last minute, by drive and name. */
export const tracks = signal<ReadonlyMap<string, Track>>(new Map());

/** Something that changed while this page was open. */
export interface Happened {
  time: Date;
  drive: string;
  text: string;
}
/** The newest first. */
export const events = signal<Happened[]>([]);

/** A value of another topic, and when it came by the clock of this page, in ms. */
export interface Held {
  received: number;
  data: unknown;
}
/** What came last of the topics that screens subscribe to. */
export const topics = signal<ReadonlyMap<string, Held>>(new Map());

/** What happened last, of what each page shows. */
export interface Happening {
  n: number;
  kind:
    | "stop"
    | "reset"
    | "take"
    | "release"
    | "acknowledge"
    | "inject"
    | "restart"
    | "clock"
    | "write"
    | "restore"
    | "undo"
    | "blink"
    | "name"
    | "ip"
    | "log";
  drive: string | null;
  /** Who did it, as in the log. */
  who: string;
  /** What that one is called by its own words; nothing verifies it. */
  claimed_name?: string;
  text: string;
  /** Whether it was wanted and not done. */
  failed: boolean;
}
export const happened = signal<Happening | null>(null);
