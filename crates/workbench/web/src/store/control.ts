/** The control socket of this page: what it has under control, its beats, and STOP. Nothing else sends a beat. */
import { batch, signal } from "@preact/signals";
import type { StopFrame } from "../api";
import { t } from "../text";
import { pause, whenBack } from "./socket";
import { access, heard, isOfBuild } from "./store";

const PROTOCOL = "profidrive.control.1";
/** Time between two beats, in ms. */
const BEAT = 50;
/** Without an echo of a beat for so long, in ms, an axis of this page is not as it is shown; control has ended. */
const MISSED = 200;
const ENDED = 1000;
/** The same of an axis that another page moves: for it there is the sign of life of the socket, each 250 ms. */
const QUIET = 500;
/** A socket without any message for this time is opened again, in ms. */
const DEAD = 3000;
/** Round trips that are kept, and which of them may be how slow for a jog, in ms. */
const TRIPS = 100;
export const SLOW = 100;
/** How long what an axis did is kept for the small plot, in ms. */
const TRACK = 5000;

/** How STOP stops an axis: by its quick stop, or along its ramp. */
export type StopBy = "off3" | "off1" | "off2";

/** How an axis is that a page has. */
export interface Axis {
  drive: string;
  lease: number;
  holder: string;
  /** What that one is called by its own words; nothing verifies it. */
  claimed_name: string | null;
  /** Who waits for it; `accepted` once it is on its way to that one. */
  wanted: { request: number; by: string; claimed_name: string | null; accepted: boolean; seconds: number } | null;
  /** Whether it has moved since its page has it, and whether its direction was confirmed then. */
  moved: boolean;
  confirmed: boolean;
  purpose: "speed" | "position";
  stop_by: StopBy;
  phase: "taking" | "off" | "enabled" | "moving" | "stopping" | "releasing";
  busy: boolean;
  /** The words as they are sent and as they came; nothing before the first. */
  stw1: number | null;
  zsw1: number | null;
  speed: number | null;
  speed_set: number | null;
  unit: string;
  position: number | null;
  reached: boolean;
  homed: boolean | null;
  travel_ended: boolean;
  /** Why it stopped by itself: its stable name, and in words. */
  trouble: { kind: string; text: string } | null;
  lost: boolean;
}

/** An axis at a time of the clock of this page, in ms. */
export type Tracked = { time: number } & Pick<Axis, "drive" | "speed" | "position">;

/** Why a command was not carried out. */
export interface Said {
  text: string;
  failed: boolean;
}

/** Whether the socket is open. */
export const connected = signal(false);
/** Whether what it brought last is too old to be shown as current. */
export const old = signal(false);
/** Whether this page had control when its socket was lost. */
export const ended = signal(false);
/** Why this page may not take control; nothing where it may. */
export const refusal = signal<string | null>(null);
export const axes = signal<readonly Axis[]>([]);
/** The leases of this page, by drive. */
export const leases = signal<ReadonlyMap<string, number>>(new Map());
/** What the session of this page is called in the log. */
export const session = signal<string | null>(null);
export const epoch = signal(0);
export const stopped = signal(false);
/** A STOP: who pressed it, and what became of it at each axis. */
export interface Stopping {
  epoch: number;
  by: string;
  claimed_name: string | null;
  /** Whether a frame with it went to each axis that it stops. */
  confirmed: boolean;
  axes: StopFrame[];
}
/** The last one. */
export const lastStop = signal<Stopping | null>(null);
/** What became of the last command of each drive. */
export const said = signal<ReadonlyMap<string, Said>>(new Map());
/** The drives that this page takes, or waits for, with the number of its command. */
export const taking = signal<ReadonlyMap<string, number>>(new Map());
/** Round trip that 99 of the last 100 beats keep to, in ms; nothing before there are ten. */
export const trip = signal<number | null>(null);
/** The last answer to a beat of this page: which one, whether it came in time, and when, by the clock of this page in ms. */
export const pulse = signal<{ n: number; fresh: boolean; at: number } | null>(null);
/** When the last beat came too late, by that clock. */
export const late = signal(Number.NEGATIVE_INFINITY);
/** The button that is held: its drive, and the number of its command. */
export const held = signal<{ drive: string; n: number } | null>(null);
/** What the axes of this page did in the last seconds; a telegram has a speed, a position or both. */
export const track = signal<readonly Tracked[]>([]);
/** What became of the last STOP of this page. `unsent`: the workbench has it, and no frame went to some axis. */
export const stopState = signal<"" | "sent" | "confirmed" | "unsent" | "unconfirmed" | "answered">("");
/** The answer to a STOP that was sent by a request, in words. */
export const stopText = signal("");

type Incoming =
  | { type: "hello"; build: string; who: string; epoch: number; stopped: boolean; refusal: string | null }
  | { type: "beat"; n: number; t: number; fresh: boolean }
  | { type: "accepted"; n: number }
  | { type: "refused"; n: number; kind: string; sentence: string; hint: string | null }
  | { type: "lease"; n: number; drive: string; lease: number }
  | { type: "axes"; axes: Axis[] }
  | ({ type: "stopped" } & Stopping)
  | { type: "reset"; epoch: number };

let socket: WebSocket | null = null;
let tries = 0;
let number = 0;
let beats = 0;
let last = 0;
let frame = 0;
let trips: number[] = [];
/** When a beat came back last, and when anything came. */
let echoed = 0;
let came = 0;
/** The pause before the socket is opened again. */
let waiting = 0;
/** Commands without an answer: of which drive. */
const pending = new Map<number, string>();

function send(message: object): boolean {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
}

/** Returns the axis that this page has of a drive. */
export function own(drive: string): Axis | undefined {
  const lease = leases.value.get(drive);
  return axes.value.find((axis) => axis.drive === drive && axis.lease === lease);
}

/** Returns the axis that any page of this server has of a drive. */
export function heldAxis(drive: string): Axis | undefined {
  return axes.value.find((axis) => axis.drive === drive && axis.phase !== "taking");
}

/** Returns how an axis is, as texts call it. */
export function phaseOf(axis: Axis): Axis["phase"] | "coasting" {
  return axis.phase === "stopping" && axis.stop_by === "off2" && stopped.value ? "coasting" : axis.phase;
}

/** Returns whether the power stage of an axis is on, and it does as commanded. */
export function operates(axis: Axis | undefined): boolean {
  return axis?.phase === "enabled" || axis?.phase === "moving";
}

/** When this server released a drive last, by the clock of this page in ms. */
const released = new Map<string, number>();
/** A reading takes no longer than this, in ms: one that ended so soon after a release may have begun before it. */
const READING = 1000;

/** Notes the axes that are not among those of now. */
function noteReleased(all: readonly Axis[]): void {
  for (const { drive } of axes.value) {
    if (!all.some((axis) => axis.drive === drive)) released.set(drive, performance.now());
  }
}

/** Returns whether a drive had this server as its controller when it was read, at a time of the clock of this page in ms. */
export function wasOwn(drive: string, read: number): boolean {
  return read < (released.get(drive) ?? Number.NEGATIVE_INFINITY) + READING;
}

function say(drive: string, text: string, failed: boolean): void {
  said.value = new Map(said.value).set(drive, { text, failed });
}

/** Sends beats while this page has an axis or wants one. By frames of the page: a page that is frozen or hidden has none. */
function beat(time: number): void {
  if (leases.value.size === 0 && pending.size === 0) {
    frame = 0;
    return;
  }
  frame = requestAnimationFrame(beat);
  if (time - last < BEAT - 8) return;
  last = time;
  beats += 1;
  send({ type: "beat", n: beats, t: performance.now(), held: held.value });
}

function begin(): void {
  if (frame === 0) echoed = performance.now();
  if (frame === 0) frame = requestAnimationFrame(beat);
}

function note(ms: number): void {
  trips = [...trips, ms].slice(-TRIPS);
  if (trips.length < 10) return;
  const sorted = [...trips].sort((a, b) => a - b);
  // of a hundred one may be slow
  trip.value = sorted[Math.ceil(sorted.length * 0.99) - 1] ?? null;
}

/** Where the move of each drive is to end, in turns, until it has ended. */
const targets = new Map<string, number>();
/** A move that ended so near to its target was not broken off, in turns. */
const NEAR = 0.01;

/** Says where a move was broken off: by STOP, by "Halt", or by anything else. */
function endMoves(before: readonly Axis[], mine: readonly Axis[]): void {
  for (const { drive, phase, position, reached } of mine) {
    const target = targets.get(drive);
    const was = before.find((axis) => axis.drive === drive)?.phase;
    const ended = (was === "moving" || was === "stopping") && (phase === "enabled" || phase === "off");
    if (target === undefined || position === null || !ended) continue;
    targets.delete(drive);
    if (reached || Math.abs(position - target) < NEAR) continue;
    say(drive, t("control.move.ended", { position: position.toFixed(3), target: target.toFixed(3) }), true);
  }
}

/** Sends a command for an axis of this page. Returns its number. */
function command(type: string, drive: string, more: object = {}): number {
  targets.delete(drive);
  number += 1;
  pending.set(number, drive);
  said.value = new Map([...said.value].filter(([of]) => of !== drive));
  const lease = leases.value.get(drive) ?? 0;
  if (!send({ type, n: number, drive, lease, epoch: epoch.value, ...more })) {
    pending.delete(number);
    say(drive, t("control.lost"), true);
  }
  begin();
  return number;
}

/** How an axis is taken. */
export interface Taking {
  purpose: "speed" | "position";
  /** Highest speed, rpm. */
  limit: number;
  /** How far the axis may go from where it is taken, in turns both ways; `null` for any way. */
  travel: number | null;
  set_mode: boolean;
  may_run_on: boolean;
  /** What a real machine needs was confirmed. */
  checks: boolean;
  stop_by: StopBy;
}

/** Takes a drive, at once or when the page that has it hands it over. */
export function take(drive: string, how: Taking, wait: boolean): void {
  const n = command("take", drive, { ...how, wait });
  if (pending.has(n)) taking.value = new Map(taking.value).set(drive, n);
}

/** Waits for a drive no more. */
export function withdraw(drive: string): void {
  const n = taking.value.get(drive);
  if (n !== undefined) isAnswered(n);
  send({ type: "release", drive });
}

function isAnswered(n: number): void {
  pending.delete(n);
  taking.value = new Map([...taking.value].filter(([, one]) => one !== n));
}

export function release(drive: string): void {
  letGo();
  send({ type: "release", drive });
}

/** Answers the page that waits for a drive of this one. Its motion goes on until the drive is handed over. */
function answer(type: "hand_over" | "keep", { drive, lease, wanted }: Axis): void {
  number += 1;
  pending.set(number, drive);
  send({ type, n: number, drive, lease, epoch: epoch.value, request: wanted?.request });
}

export const keep = (axis: Axis) => answer("keep", axis);
export function handOver(axis: Axis): void {
  letGo();
  answer("hand_over", axis);
}

export const enable = (drive: string) => command("enable", drive);
export const disable = (drive: string) => command("disable", drive);
export const acknowledge = (drive: string) => command("acknowledge", drive);
export const home = (drive: string) => command("home", drive);
export const task = (drive: string, n: number) => command("task", drive, { number: n });
export const velocity = (drive: string, speed: number) => command("velocity", drive, { speed });
export function move(drive: string, turns: number, relative: boolean, speed: number): void {
  const from = relative ? own(drive)?.position : 0;
  command("move", drive, { turns, relative, speed });
  if (typeof from === "number") targets.set(drive, from + turns);
}

export const confirmDirection = (drive: string) => command("confirm", drive);

export function halt(drive: string): void {
  send({ type: "halt", drive, lease: leases.value.get(drive) ?? 0 });
}

/** Jogs while the button is held: until `letGo`. */
/** The command whose jog was seen to move its axis. */
let moving = 0;

export function hold(drive: string, speed: number): void {
  const n = command("jog", drive, { t: performance.now(), speed, rtt: trip.value });
  held.value = { drive, n };
}

/** The button is up, or it is not visible any more. */
export function letGo(): void {
  const before = held.value;
  if (before === null) return;
  // beside the beats, which say so too
  halt(before.drive);
  held.value = null;
}

export function reset(): void {
  number += 1;
  pending.set(number, "");
  send({ type: "reset", n: number, epoch: epoch.value });
}

let presses = 0;

/**
 * Sends STOP by the socket, which no other request can hold up; where it is not open, or does not confirm it, by a request.
 * Whichever way it goes, the page reports at once that it was sent, and after 500 ms that nothing confirms it.
 */
export async function pressStop(byRequest: () => Promise<string>): Promise<void> {
  // first: whatever is drawn comes behind it
  const bySocket = send({ type: "stop" });
  letGo();
  presses += 1;
  const press = presses;
  batch(() => {
    stopText.value = "";
    stopState.value = "sent";
  });
  const ask = async () => {
    const text = await byRequest();
    if (press !== presses || stopState.value === "confirmed" || stopState.value === "unsent") return;
    batch(() => {
      stopText.value = text;
      stopState.value = "answered";
    });
  };
  setTimeout(() => {
    if (stopState.value !== "sent" || press !== presses) return;
    stopState.value = "unconfirmed";
    // a connection that is open may be dead all the same; two STOPs are as good as one
    if (bySocket) void ask();
  }, 500);
  if (!bySocket) await ask();
}

function forget(): void {
  batch(() => {
    for (const drive of leases.value.keys()) say(drive, t("control.ended"), true);
    if (leases.value.size > 0) ended.value = true;
    connected.value = false;
    leases.value = new Map();
    // the server releases them by itself
    noteReleased([]);
    axes.value = [];
    held.value = null;
    taking.value = new Map();
    trip.value = null;
    pulse.value = null;
  });
  trips = [];
  pending.clear();
}

function receive(message: Incoming): void {
  switch (message.type) {
    case "hello":
      isOfBuild(message.build);
      session.value = message.who;
      epoch.value = message.epoch;
      stopped.value = message.stopped;
      // of a STOP that was pressed meanwhile only the number is known
      if (lastStop.value?.epoch !== message.epoch) lastStop.value = null;
      refusal.value = message.refusal;
      connected.value = true;
      ended.value = false;
      tries = 0;
      return;
    case "beat":
      echoed = performance.now();
      pulse.value = { n: message.n, fresh: message.fresh, at: echoed };
      if (!message.fresh) late.value = echoed;
      note(performance.now() - message.t);
      return;
    case "accepted":
      pending.delete(message.n);
      return;
    case "refused": {
      const drive = pending.get(message.n) ?? "";
      isAnswered(message.n);
      if (held.value?.n === message.n) held.value = null;
      targets.delete(drive);
      const hint = message.hint === null ? "" : `. ${message.hint.charAt(0).toUpperCase()}${message.hint.slice(1)}`;
      say(drive, message.sentence + hint, true);
      return;
    }
    case "lease":
      isAnswered(message.n);
      leases.value = new Map(leases.value).set(message.drive, message.lease);
      track.value = track.value.filter((one) => one.drive !== message.drive);
      begin();
      return;
    case "axes":
      show(message.axes);
      return;
    case "stopped":
      batch(() => {
        epoch.value = message.epoch;
        stopped.value = true;
        held.value = null;
        lastStop.value = message;
        if (stopState.value !== "") stopState.value = message.confirmed ? "confirmed" : "unsent";
      });
      return;
    case "reset":
      stopped.value = false;
      stopState.value = "";
  }
}

/** Ends a hold whose motion has ended by itself: the button shows nothing that is not so, and has to be pressed again. */
function endHold(mine: readonly Axis[]): void {
  const hold = held.value;
  // before it is answered, what moves is of before
  if (hold === null || pending.has(hold.n)) return;
  const axis = mine.find(({ drive }) => drive === hold.drive);
  if (axis?.phase === "moving") {
    moving = hold.n;
  } else if (moving === hold.n) {
    letGo();
    if (axis?.trouble == null && !stopped.value) say(hold.drive, t("control.hold.ended"), true);
  }
}

function show(all: Axis[]): void {
  batch(() => {
    noteReleased(all);
    const before = axes.value;
    axes.value = all;
    const left = [...leases.value].filter(([drive, lease]) =>
      all.some((axis) => axis.drive === drive && axis.lease === lease),
    );
    if (left.length < leases.value.size) leases.value = new Map(left);
    const time = performance.now();
    const mine = all.filter(({ drive, lease }) => leases.value.get(drive) === lease);
    endMoves(before, mine);
    endHold(mine);
    const now = mine.map(({ drive, speed, position }) => ({ drive, time, speed, position }));
    if (now.length > 0) track.value = [...track.value.filter((one) => one.time > time - TRACK), ...now];
  });
}

function open(): void {
  const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/v1/control`;
  const opened = new WebSocket(address, PROTOCOL);
  socket = opened;
  came = performance.now();
  opened.onmessage = ({ data }) => {
    came = performance.now();
    heard();
    receive(JSON.parse(data) as Incoming);
    look();
  };
  opened.onclose = () => lost(opened);
}

/** Gives up a socket: nothing is restored, no lease and no motion. */
function lost(gone: WebSocket): void {
  if (socket !== gone) return;
  socket = null;
  gone.onmessage = null;
  gone.close();
  forget();
  if (access.value.kind === "in") {
    waiting = window.setTimeout(again, pause(tries, Math.random()));
    tries += 1;
  }
}

/** Opens the socket once more, at the end of a pause or before. */
function again(): void {
  if (waiting === 0) return;
  clearTimeout(waiting);
  waiting = 0;
  open();
}

/** Looks whether what is shown of the axes is old. Returns the time without an echo, in ms. */
function look(): number {
  const time = performance.now();
  const silence = leases.value.size > 0 ? time - echoed : 0;
  old.value = silence > MISSED || time - came > QUIET;
  return silence;
}

/** Returns whether the workbench has ended control by now, without beats. */
export function isOver(): boolean {
  return ended.value || look() > ENDED;
}

/** Gives up what is too old to be true; the page calls it all the time. */
export function listenForControl(): void {
  if (socket !== null && (look() > ENDED || performance.now() - came > DEAD)) lost(socket);
}

/** Opens the socket, and gives everything back when the page is not visible. */
export function runControl(): void {
  open();
  whenBack(again);
  const leave = () => {
    letGo();
    for (const drive of leases.value.keys()) release(drive);
    for (const drive of taking.value.keys()) withdraw(drive);
  };
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) leave();
  });
  addEventListener("pagehide", leave);
  addEventListener("blur", letGo);
  // a button that was drawn anew meanwhile would not notice it: whatever is let go anywhere ends the hold
  for (const up of ["pointerup", "pointercancel"]) addEventListener(up, letGo);
}
