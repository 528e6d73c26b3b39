/** What the page shows. Only `live.ts` writes, views read. */
import { computed, signal } from "@preact/signals";
import type { Server, Shaft, Station } from "../api";

/** Whether this browser is let in. */
export type Access = { kind: "entering" } | { kind: "in" } | { kind: "out"; reason: string };

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
/** When the workbench answered last, by that clock. */
export const answered = signal(performance.now());

/** Without an answer for this time the connection is lost, in ms. */
const LOST = 3000;
/** Seconds without an answer of the workbench; `null` while it answers. */
export const silent = computed(() => {
  const silence = now.value - answered.value;
  return silence > LOST ? silence / 1000 : null;
});

/** Returns the present age of something that had an age when it came, in s. */
export function aged(then: number | null): number | null {
  return then === null ? null : then + Math.max(0, now.value - received.value) / 1000;
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
