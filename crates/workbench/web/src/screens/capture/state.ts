/** The capture that is shown: what the server has of it, and which part of that. */
import { signal } from "@preact/signals";
import {
  type CaptureReport,
  type Captures,
  type EventPage,
  type FramePage,
  type FrameReport,
  request,
} from "../../api";
import { t } from "../../text";

/** Rows of a page. */
export const ROWS = 100;
/** Time between two looks at a capture that is read, in ms. */
const LOOK = 300;
/** The largest capture, in octets, and the time for it, in ms. */
const LARGEST = 256 * 2 ** 20;
const UPLOAD = 300_000;
/** States that the time line shows. */
const STATES = 1000;

/** The captures of the server; `null` before they were listed. */
export const captures = signal<CaptureReport[] | null>(null);
export const current = signal<CaptureReport | null>(null);
export const view = signal<"events" | "frames">("events");
export const filter = signal({ trouble: false, device: "", begin: "", end: "" });
export const from = signal(0);
export const events = signal<EventPage | null>(null);
export const frames = signal<FramePage | null>(null);
export const states = signal<EventPage["events"]>([]);
export const frame = signal<FrameReport | null>(null);
export const range = signal<[number, number]>([0, 0]);
export const failure = signal("");
export const sending = signal("");
export const wantedFrame = signal("");

export async function tried(work: () => Promise<void>): Promise<void> {
  try {
    failure.value = "";
    await work();
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
}

export async function list(): Promise<void> {
  captures.value = (await request<Captures>("captures")).captures;
}

/** Shows a capture, again and again until it was read. */
export async function open(id: number): Promise<void> {
  current.value = await request<CaptureReport>(`captures/${id}`);
  frame.value = null;
  from.value = 0;
  while (current.value?.id === id && !current.value.ended) {
    await new Promise((resolve) => setTimeout(resolve, LOOK));
    const next: CaptureReport = await request<CaptureReport>(`captures/${id}`);
    if (current.value?.id !== id) return;
    current.value = next;
  }
  await list();
  const found = await request<EventPage>(`captures/${id}/events?states=true&most=${STATES}`);
  states.value = found.events;
  await load();
}

export async function load(): Promise<void> {
  const id = current.value?.id;
  if (id === undefined) return;
  if (view.value === "frames") {
    frames.value = await request<FramePage>(`captures/${id}/frames?from=${from.value + 1}&most=${ROWS}`);
    return;
  }
  const { trouble, ...rest } = filter.value;
  const wanted = Object.entries(rest).filter(([, value]) => value !== "");
  const query = new URLSearchParams([
    ...wanted,
    ["from", String(from.value)],
    ["most", String(ROWS)],
    ["trouble", String(trouble)],
  ]);
  events.value = await request<EventPage>(`captures/${id}/events?${query}`);
}

export async function upload(file: File): Promise<void> {
  await tried(async () => {
    if (file.size > LARGEST) throw new Error(t("capture.large"));
    sending.value = file.name;
    try {
      const headers = { "Content-Type": "application/octet-stream" };
      const signal = AbortSignal.timeout(UPLOAD);
      const begun = await request<CaptureReport>("captures", { method: "POST", headers, body: file, signal });
      sending.value = "";
      await open(begun.id);
    } finally {
      sending.value = "";
    }
  });
}

export async function show(number: number): Promise<void> {
  const id = current.value?.id;
  if (id === undefined) return;
  await tried(async () => {
    frame.value = await request<FrameReport>(`captures/${id}/frames/${number}`);
    range.value = [0, 0];
  });
}

export function change(more: Partial<typeof filter.value>): void {
  filter.value = { ...filter.value, ...more };
  from.value = 0;
  void tried(load);
}
