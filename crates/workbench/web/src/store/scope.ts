/** The worker of the Scope: what it records, and what it shows. Views read the signals and call the functions. */
import { batch, effect, signal } from "@preact/signals";
import { download } from "../parts/download";
import type { Trigger } from "../scope/acquisition";
import type { Header } from "../scope/block";
import type { Frame, FromWorker, Status, ToWorker, Wanted } from "../scope/protocol";
import workerAddress from "../scope/scope.worker?worker&url";
import { t } from "../text";
import { whenRestarted } from "./store";

/** What a person chose for a drive. */
export interface Layout {
  /** Signals: `@speed` for what each drive has, else a name; a bit of a word with its number behind a point: `@status.3`. */
  signals: string[];
  /** Time of the picture, in us. */
  span: number;
  trigger: Trigger;
  /** What is read beside words and speeds. */
  parameters: string[];
  /** Signals that are the difference of two others, as they are kept in a layout. */
  maths: { a: string; b: string }[];
  wanted: Wanted;
  /** Whether a hidden page records. */
  background: boolean;
}

export const MOST_SIGNALS = 16;
export const SPANS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 300, 600].map((seconds) => seconds * 1e6);

const USUAL: Layout = {
  signals: ["@speed_set", "@speed"],
  span: 10e6,
  trigger: { mode: "off", condition: { kind: "edge", signal: "@speed", edge: "rising", level: 10 }, pre: 0.2 },
  parameters: [],
  maths: [],
  wanted: "auto",
  background: false,
};

export const layout = signal<Layout>(USUAL);
export const status = signal<Status | null>(null);
export const frame = signal<Frame | null>(null);
/** The same a few times a second, for people. */
export const shown = signal<Frame | null>(null);
/** Cursors A and B, as parts of the picture. */
export const cursors = signal<[number, number] | null>(null);
/** What became of the last file, in words. */
export const said = signal<{ text: string; failed: boolean; unrecorded?: boolean } | null>(null);
export const overlaid = signal(false);
/** The step that is waited for: of which drive. */
export const step = signal<{ drive: string; done: boolean; order: number } | null>(null);

/** Messages to the worker so far. */
let sent = 0;
let worker: Worker | null = null;
let drive: string | null = null;
let pixels = 800;
/** A file or the test signal is shown. */
let other = false;
/** Time between two values that people read, in ms. */
const READ = 150;
let waitsForReaders = false;
let saved: ((text: string) => void) | null = null;

/** Text as an address of a script: the policy of the page lets only this worker pass. */
function scriptAddress(): string | URL {
  const factory = (
    globalThis as unknown as {
      trustedTypes?: {
        createPolicy(
          name: string,
          rules: { createScriptURL(address: string): string },
        ): {
          createScriptURL(address: string): string;
        };
      };
    }
  ).trustedTypes;
  if (factory === undefined) return workerAddress;
  return factory
    .createPolicy("workbench", {
      createScriptURL(address) {
        if (address !== workerAddress) throw new TypeError("not the worker of this page");
        return address;
      },
    })
    .createScriptURL(workerAddress);
}

function send(message: ToWorker): void {
  if (worker === null) {
    worker = new Worker(scriptAddress(), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => receive(data);
    document.addEventListener("visibilitychange", visible);
  }
  sent += 1;
  worker.postMessage(message);
}

function visible(): void {
  send({ type: "visible", visible: !document.hidden || layout.value.background });
}

function receive(message: FromWorker): void {
  switch (message.type) {
    case "status": {
      const before = status.value;
      status.value = message;
      const known = message.header !== null || message.reason !== null;
      if (sought !== null && message.obeyed >= sought.order && known) showTime(message, sought.at);
      if (JSON.stringify(before?.header) !== JSON.stringify(message.header)) {
        if (other && chosen().length === 0) chooseFirst();
        calculate();
        show();
      }
      const waited = step.value;
      // a report from before the order is not of this step
      if (waited !== null && !waited.done && message.obeyed >= waited.order && !message.running) {
        step.value = { ...waited, done: true };
        if (!entered) close();
      }
      return;
    }
    case "frame":
      frame.value = message;
      send({ type: "drawn" });
      if (!waitsForReaders) {
        waitsForReaders = true;
        setTimeout(() => {
          waitsForReaders = false;
          shown.value = frame.value;
        }, READ);
      }
      return;
    case "saved":
      saved?.(message.text);
      saved = null;
      return;
    case "failed":
      said.value = { text: t("scope.file.failed", { reason: message.text }), failed: true };
  }
}

/** The time of day that is to be shown, in ms since 1970, once the worker has obeyed so many messages. */
let sought: { at: number; order: number } | null = null;
/** Which part of the picture is before the time that was sought. */
const BEFORE_TIME = 0.6;

/** Shows a time of what is recorded, or says that it is not. */
function showTime({ header, kept, pauses }: Status, at: number): void {
  sought = null;
  const time = header === null || header.unix_ms === 0 ? null : header.t_us + (at - header.unix_ms) * 1000;
  const within = (span: { from: number; to: number }) => time !== null && time >= span.from && time <= span.to;
  const there = time !== null && kept !== null && within(kept) && !pauses.some(within);
  const clock = `${new Date(at).toISOString().slice(11, 19)} UTC`;
  said.value = { text: t(there ? "scope.at" : "scope.at.none", { time: clock }), failed: false, unrecorded: !there };
  if (!there) return;
  const from = time - BEFORE_TIME * layout.value.span;
  stop();
  move(from, from + layout.value.span);
}

/** Shows what is recorded of a time of day in ms since 1970, as far as it is. */
export function seek(at: number): void {
  sought = { at, order: sent };
}

/** Records the next fault, and stops. */
export function recordFault(): void {
  said.value = null;
  change({ trigger: { ...layout.value.trigger, condition: { kind: "fault" } } });
  single();
}

/** Signals of a file that has none of those that were chosen. */
const FIRST = 8;

function chooseFirst(): void {
  const columns = status.value?.header?.columns ?? [];
  const numbers = columns.filter((column) => column.type !== "u32").map(keyOf);
  layout.value = { ...layout.value, signals: numbers.slice(0, FIRST) };
}

const key = (id: string) => `profidrive.scope.${id}`;

function stored(id: string): Layout {
  return parseLayout(localStorage.getItem(key(id)) ?? "{}") ?? USUAL;
}

/** Reads a layout that this page or a person has written; nothing where it is none. */
export function parseLayout(text: string): Layout | null {
  try {
    const found: unknown = JSON.parse(text);
    if (typeof found !== "object" || found === null || Array.isArray(found)) return null;
    const whole = { ...USUAL, ...(found as Partial<Layout>) };
    const { signals, parameters, maths, span, trigger } = whole;
    const texts = (list: unknown) => Array.isArray(list) && list.every((one) => typeof one === "string");
    const pairs = Array.isArray(maths) && maths.every((one) => typeof one?.a === "string" && typeof one.b === "string");
    const fits = texts(signals) && texts(parameters) && pairs && SPANS.includes(span);
    return fits && typeof trigger?.condition?.kind === "string" && typeof trigger.pre === "number" ? whole : null;
  } catch {
    return null;
  }
}

/** How a difference is kept in a layout. */
export function differenceKey({ a, b }: Layout["maths"][number]): string {
  return `@${a}-${b}`;
}

/** What the worker calculates, as it was sent last. */
let calculated = "";

/** Lets the worker calculate what the layout has, of the columns that come. */
function calculate(): void {
  const header = status.value?.header ?? null;
  const maths = layout.value.maths.flatMap((one) => {
    const [a, b] = [find(header, one.a), find(header, one.b)];
    return a && b ? [{ key: differenceKey(one).slice(1), a: a.column.name, b: b.column.name }] : [];
  });
  const text = JSON.stringify(maths);
  if (text === calculated) return;
  calculated = text;
  send({ type: "calculate", maths });
}

/** A signal of a layout in what comes: its column, and its bit. */
export interface Found {
  key: string;
  column: Header["columns"][number];
  bit: number | null;
}

/** Returns the signal of a layout, where it is there. */
export function find(header: Header | null, wanted: string): Found | null {
  const [, name, bit] = /^(.*?)(?:\.(\d+))?$/.exec(wanted) ?? [];
  const of = (text: string | undefined) =>
    header?.columns.find((column) =>
      text?.startsWith("@") ? column.role !== "" && `@${column.role}` === text : column.name === text,
    );
  // names of parameters have points too
  const whole = of(wanted);
  if (whole) return { key: wanted, column: whole, bit: null };
  const column = of(name);
  return column?.type === "u32" && bit !== undefined ? { key: wanted, column, bit: Number(bit) } : null;
}

/** The signals that are shown. */
export function chosen(): Found[] {
  const header = status.value?.header ?? null;
  return layout.value.signals.flatMap((wanted) => find(header, wanted) ?? []);
}

/** How a column is kept in a layout. */
export function keyOf(column: Header["columns"][number]): string {
  return column.role === "" ? column.name : `@${column.role}`;
}

/** The trigger with the names of what comes. */
function trigger(): Trigger {
  const { condition, ...rest } = layout.value.trigger;
  if (condition.kind !== "edge" && condition.kind !== "bit") return { ...rest, condition };
  const found = find(status.value?.header ?? null, condition.signal);
  return { ...rest, condition: { ...condition, signal: found?.column.name ?? condition.signal } };
}

/** Lets the worker show what is chosen. */
export function show(width = pixels): void {
  pixels = width;
  if (worker === null) return;
  const columns = [...new Set(chosen().map(({ column }) => column.name))];
  send({ type: "show", columns, pixels, span: layout.value.span, cursors: cursors.value });
}

effect(() => {
  cursors.value;
  show();
});

function subscribe(): void {
  if (drive === null) return;
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const address = `${scheme}://${location.host}/api/v1/live`;
  const { parameters, wanted } = layout.value;
  send({ type: "open", drive, address, parameters: [...parameters].sort(), wanted });
}

/** Changes what a person chose, and keeps it. */
export function change(more: Partial<Layout>): void {
  const before = layout.value;
  layout.value = { ...before, ...more };
  if (drive !== null) localStorage.setItem(key(drive), JSON.stringify(layout.value));
  if (more.parameters || more.wanted) {
    other = false;
    subscribe();
  }
  if (more.maths) calculate();
  if (more.trigger) send({ type: "trigger", trigger: trigger() });
  if (more.background !== undefined) visible();
  show();
}

/** Receives the samples of a drive. What is there of it already stays. */
function open(id: string): void {
  if (drive === id && !other && receiving) return;
  const fresh = drive !== id;
  receiving = true;
  other = false;
  batch(() => {
    if (fresh) {
      drive = id;
      layout.value = stored(id);
      status.value = null;
      frame.value = null;
      shown.value = null;
      cursors.value = null;
      overlaid.value = false;
      said.value = null;
      if (step.value?.drive !== id) step.value = null;
    }
  });
  visible();
  subscribe();
  if (fresh) {
    send({ type: "overlay", keep: false });
    send({ type: "run" });
    send({ type: "trigger", trigger: trigger() });
  }
  show();
}

whenRestarted(() => {
  if (drive === null || other) return;
  status.value = null;
  frame.value = null;
  shown.value = null;
  overlaid.value = false;
  step.value = null;
  send({ type: "overlay", keep: false });
  send({ type: "forget" });
});

let receiving = false;
/** Whether the screen of the Scope is open. */
let entered = false;

function close(): void {
  receiving = false;
  send({ type: "close" });
}

/** The screen of the Scope is open. */
export function enter(id: string): void {
  entered = true;
  open(id);
}

/** It is open no more. */
export function leave(): void {
  entered = false;
  if (step.value === null || step.value.done) close();
}

/** Time for the way from one screen to the next, in ms. */
const WAY = 1000;

/** The screen with the step is open no more: only that of the Scope waits for it on. */
export function leaveStep(): void {
  setTimeout(() => {
    if (entered || step.value === null || step.value.done) return;
    step.value = null;
    close();
  }, WAY);
}

export function run(): void {
  step.value = null;
  said.value = null;
  if (other && drive !== null) {
    other = false;
    layout.value = stored(drive);
    subscribe();
  }
  send({ type: "run" });
  send({ type: "trigger", trigger: trigger() });
}

export function stop(): void {
  send({ type: "stop" });
}

/** Records the next event of the trigger and stops. */
export function single(): void {
  step.value = null;
  const usual = trigger();
  send({ type: "single", trigger: usual });
}

/** The time before a step, as a part of the picture. */
const BEFORE = 0.2;

/** Records the next step of the set speed of a drive, and stops. */
export function recordStep(id: string, span: number): void {
  open(id);
  layout.value = { ...layout.value, span };
  localStorage.setItem(key(id), JSON.stringify(layout.value));
  show();
  step.value = { drive: id, done: false, order: sent + 1 };
  send({ type: "single", trigger: { mode: "single", condition: { kind: "change", role: "speed_set" }, pre: BEFORE } });
}

/** Gives up a step. */
export function giveUp(): void {
  step.value = null;
  send({ type: "run" });
}

/** Shows another part of a stopped recording. */
export function move(from: number, to: number): void {
  if (to > from) send({ type: "move", view: { from, to } });
}

export function overlay(keep: boolean): void {
  overlaid.value = keep;
  send({ type: "overlay", keep });
}

export function generate(): void {
  other = true;
  step.value = null;
  send({ type: "generate", columns: MOST_SIGNALS, rate: 1000 });
  layout.value = { ...layout.value, signals: Array.from({ length: MOST_SIGNALS }, (_, at) => `test ${at + 1}`) };
  show();
}

export async function load(file: File): Promise<void> {
  said.value = null;
  step.value = null;
  other = true;
  const text = await file.text();
  send({ type: "load", text, name: file.name });
  said.value = { text: t("scope.file.opened", { name: file.name }), failed: false };
}

/** The name of a file of a drive, with the time of day. */
export function fileName(label: string, ending: string): string {
  const time = new Date()
    .toISOString()
    .replace(/[-:]/g, "")
    .replace(/\.\d+Z$/, "Z");
  return `${label.replace(/[^\w.-]+/g, "-")}-${time}.${ending}`;
}

/** Writes the layout to a file, for another drive or browser. */
export function saveLayout(label: string): void {
  const text = `${JSON.stringify(layout.value, null, 2)}\n`;
  download(`${label.replace(/[^\w.-]+/g, "-")}-layout.json`, new Blob([text], { type: "application/json" }));
}

/** Takes the layout of a file. */
export async function loadLayout(file: File): Promise<void> {
  const found = file.size < 100_000 ? parseLayout(await file.text()) : null;
  const text = t(found === null ? "scope.layout.wrong" : "scope.layout.opened", { name: file.name });
  said.value = { text, failed: found === null };
  if (found !== null) change(found);
}

export function save(label: string, between: boolean): void {
  saved = (text) => download(fileName(label, "csv"), new Blob([text], { type: "text/csv" }));
  send({ type: "save", between, drive: label });
}
