/** Brings what the workbench knows to the page. */
import { batch } from "@preact/signals";
import {
  Refused,
  request,
  type Server,
  type Shaft,
  type Station,
  type Stations,
  type StopFrame,
  type Stopped,
} from "../api";
import { label } from "../parts/format";
import { t, utc } from "../text";
import { isOver, listenForControl, runControl } from "./control";
import { name } from "./name";
import { noteFaults } from "./seen";
import { type Incoming, Live } from "./socket";
import {
  access,
  events,
  failure,
  happened,
  heard,
  isOfBuild,
  listen,
  now,
  paused,
  received,
  restarts,
  searched,
  searching,
  server,
  shafts,
  stations,
  type Track,
  topics,
  tracks,
} from "./store";

/** Values of a topic in a second, at most. */
const RATE = 10;
const SHAFT_RATE = 10;
const CLOCK_PERIOD = 250;
/** How often the page looks whether the workbench is silent, in ms. */
const LISTEN = 50;
/** Pause before a workbench that does not answer is tried again, in ms. */
const AGAIN = 1000;
/** Time for a search, in ms. */
const SEARCH = 20_000;
/** What is kept of a value, in ms. */
const TRACK = 60_000;
/** Events that are kept, of all drives. */
const EVENTS = 100;

/** Takes the token out of the address and begins a session with it, or goes on with the one there is. */
export async function enter(): Promise<void> {
  const token = new URLSearchParams(location.hash.slice(1)).get("token");
  if (token !== null) {
    // a token that stays in the address ends in bookmarks and pictures
    history.replaceState(null, "", location.pathname + location.search);
  }
  await enterWith(token);
}

async function enterWith(token: string | null): Promise<void> {
  try {
    if (token !== null) {
      const headers = { "Content-Type": "application/json" };
      await request("session", { method: "POST", headers, body: JSON.stringify({ token, name: name.value }) });
    }
    server.value = await request<Server>("server");
    access.value = { kind: "in" };
    run();
  } catch (error) {
    if (error instanceof Refused) {
      const reason =
        error.status === 401 && token === null ? t("login.text") : t("login.refused", { reason: error.message });
      access.value = { kind: "out", reason, silent: false };
      return;
    }
    access.value = { kind: "out", reason: t("login.silent"), silent: true };
    // the token is in the address no more: whoever reloads the page would have to look for it
    setTimeout(() => void enterWith(token), AGAIN);
  }
}

/** What stays open: the socket, after the page was let in. */
let live: Live | null = null;

/** Subscribes to a topic while a screen is shown; for `useEffect`. */
export function want(topic: string, rate: number): () => void {
  return live?.want(topic, rate) ?? (() => {});
}

/** Returns what became of a STOP at an axis, in words. */
function stopOf({ drive, by, state, sent_unix_ms }: StopFrame): string {
  const station = stations.value?.find((one) => one.id === drive);
  const name = station ? label(station) : drive;
  if (state !== "sent") return t(`stop.axis.${state}`, { name });
  if (by === null || by === undefined) return t("stop.axis.off", { name });
  const time = sent_unix_ms === null ? "" : utc(new Date(sent_unix_ms), 3);
  return t("stop.axis.sent", { name, by: by.toUpperCase(), time });
}

/** Returns what became of a STOP, in words. `beside`: it stops a drive too that no controller has. */
export function stopText(number: number, confirmed: boolean, axes: readonly StopFrame[], beside: boolean): string {
  if (axes.length === 0) return t(beside ? "stop.received" : "stop.done", { number });
  const list = axes.map(stopOf).join("; ");
  return t(confirmed ? "stop.axes" : "stop.axes.unconfirmed", { number, axes: list });
}

function run(): void {
  runControl();
  setInterval(() => {
    now.value = performance.now();
  }, CLOCK_PERIOD);
  setInterval(() => {
    if (listen(isOver())) listenForControl();
  }, LISTEN);
  live = new Live({
    message: receive,
    refused: () => {
      access.value = { kind: "out", reason: t("login.ended"), silent: false };
    },
    other: isOfBuild,
  });
  live.want("network", RATE);
  if (server.value?.simulation) {
    live.want("plant", SHAFT_RATE);
  }
}

function receive(message: Incoming): void {
  heard();
  if (message.type === "hello") isOfBuild(message.build);
  if (message.type === "event") {
    happened.value = message;
    return;
  }
  if (message.type !== "snapshot") {
    return;
  }
  if (message.topic === "network") {
    take(message.data as Stations);
  } else if (message.topic === "plant") {
    const { drives } = message.data as { drives: Shaft[] };
    shafts.value = new Map(drives.map((shaft) => [shaft.id, shaft]));
  } else {
    const next = new Map(topics.value);
    next.set(message.topic, { received: performance.now(), data: message.data });
    topics.value = next;
  }
}

/** Lets the workbench search for stations now. */
export async function searchNow(): Promise<void> {
  searching.value = true;
  try {
    take(await request<Stations>("stations/scan", { method: "POST", signal: AbortSignal.timeout(SEARCH) }));
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
  searching.value = false;
}

function take(report: Stations): void {
  // an answer to a request may be older than what came meanwhile
  if (report.restarts < (restarts.value ?? 0)) return;
  batch(() => {
    if (restarts.value !== null && report.restarts !== restarts.value) forget();
    restarts.value = report.restarts;
    note(stations.value ?? [], report.stations);
    for (const station of report.stations) noteFaults(station);
    stations.value = report.stations;
    received.value = performance.now();
    now.value = received.value;
    searched.value = report.age;
    paused.value = report.paused;
    failure.value = report.failure?.message ?? null;
    tracks.value = extended(tracks.value, report.stations);
  });
}

/** Forgets the drives of a plant that is no more. */
function forget(): void {
  stations.value = null;
  shafts.value = new Map();
  tracks.value = new Map();
  topics.value = new Map();
  events.value = [];
}

/** Notes what is different from before. */
function note(before: Station[], after: Station[]): void {
  const known = new Map(before.map((station) => [station.id, station]));
  const fresh = after.flatMap((station) => {
    const old = known.get(station.id)?.status;
    const status = station.status;
    if (!old || !status || (old.cause === status.cause && old.state_text === status.state_text)) {
      return [];
    }
    const state = status.state_text ?? "";
    const text = old.cause === status.cause ? state : `${status.sentence}${state && ` (${state})`}`;
    return [{ time: new Date(), drive: station.id, text }];
  });
  if (fresh.length > 0) {
    events.value = [...fresh, ...events.value].slice(0, EVENTS);
  }
}

/** Returns the tracks with the values of a new report. */
function extended(all: ReadonlyMap<string, Track>, report: Station[]): Map<string, Track> {
  const next = new Map<string, Track>();
  const time = performance.now();
  for (const { id, status, age } of report) {
    const values = {
      speed: status?.speed_actual,
      set: status?.speed_set,
      position: status?.position,
      bus: status?.bus_voltage,
      current: status?.current,
      torque: status?.torque,
      temperature: status?.temperature,
      motor: status?.motor_temperature,
      following: status?.following_error,
    };
    for (const [name, quantity] of Object.entries(values)) {
      const key = `${id} ${name}`;
      const old = all.get(key) ?? { times: [], values: [] };
      const from = old.times.findIndex((then) => then > time - TRACK);
      const kept = from < 0 ? { times: [], values: [] } : old;
      const track = { times: kept.times.slice(Math.max(0, from)), values: kept.values.slice(Math.max(0, from)) };
      const at = time - (age ?? 0) * 1000;
      // a status that was shown before is no new value
      if (quantity && at > (track.times.at(-1) ?? Number.NEGATIVE_INFINITY) + 100) {
        track.times.push(at);
        track.values.push(quantity.value);
      }
      if (track.times.length > 0) {
        next.set(key, track);
      }
    }
  }
  return next;
}

/** Stops every axis that the server controls, where the control socket is not open. Returns what became of it, in words. */
export async function stop(beside: boolean): Promise<string> {
  try {
    const stopped = await request<Stopped>("stop", { method: "POST", keepalive: true });
    return stopText(stopped.stops, stopped.confirmed, stopped.frames, beside);
  } catch {
    return t("stop.failed");
  }
}

/** Time for the stop of a drive that no controller has, in ms: more than the server gives it for its ramp. */
const RAMP = 75_000;

/** Stops a drive that no controller has. Returns what became of it, in words. */
export async function stopBeside(station: Station): Promise<string> {
  const name = label(station);
  try {
    const signal = AbortSignal.timeout(RAMP);
    const path = `drives/${encodeURIComponent(station.id)}/stop`;
    await request(path, { method: "POST", keepalive: true, signal });
    return t("stop.beside.done", { name });
  } catch (error) {
    // the words of a browser are no help
    return error instanceof Refused
      ? t("stop.beside.failed", { name, reason: error.message })
      : t("stop.beside.unknown", { name });
  }
}
