import { effect, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { type LogPage, type LogTopic, request, type Troubles } from "../../api";
import { foreign, label, sentence } from "../../parts/format";
import { Bars, Loading } from "../../parts/Loading";
import { want } from "../../store/live";
import { named } from "../../store/name";
import { now, server, silent, stations, topics } from "../../store/store";
import { t } from "../../text";
import { type Record, rows } from "./rows";

/** Records of a page. */
const MOST = 100;
/** A new filter is used after this pause, in ms. */
const PAUSE = 250;

/** The actions that a filter offers. */
const ACTIONS = [
  "take",
  "release",
  "request_control",
  "hand_over",
  "keep",
  "enable",
  "disable",
  "confirm",
  "jog",
  "velocity",
  "move",
  "home",
  "task",
  "stop",
  "reset",
  "acknowledge",
  "inject",
  "restart",
  "clock",
  "write",
  "restore",
  "undo",
  "blink",
  "name",
  "ip",
  "request",
];

const NONE = { text: "", drive: "", action: "" };
const filter = signal(NONE);
const records = signal<Record[]>([]);
const before = signal<string | null>(null);
const troubles = signal<Troubles["troubles"]>([]);
const failure = signal("");
/** Whether the log was read. */
const isRead = signal(false);
/** Whether the list begins with the newest. */
const tail = signal(true);

function query(more: { [name: string]: string }): string {
  const all = Object.entries({ ...filter.value, ...more }).filter(([, value]) => value !== "");
  return new URLSearchParams(all).toString();
}

async function load(older: boolean): Promise<void> {
  const wanted = query({ most: String(MOST), before: older ? (before.value ?? "") : "" });
  try {
    const page = await request<LogPage>(`audit?${wanted}`);
    records.value = older ? [...records.value, ...page.records] : page.records;
    before.value = page.before;
    tail.value = !older;
    if (!older) troubles.value = (await request<Troubles>("troubles")).troubles;
    failure.value = "";
    isRead.value = true;
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
}

/** The filter is a part of the address, so that a link to this screen has it. */
function keepFilter(): () => void {
  const read = () => {
    const kept = new URLSearchParams(location.hash.slice(1));
    const names = ["text", "drive", "action"] as const;
    filter.value = { ...NONE, ...Object.fromEntries(names.map((name) => [name, kept.get(name) ?? ""])) };
    tail.value = true;
  };
  if (location.hash !== "") read();
  addEventListener("hashchange", read);
  const end = effect(() => {
    const hash = query({});
    history.replaceState(history.state, "", location.pathname + location.search + (hash && `#${hash}`));
  });
  return () => {
    removeEventListener("hashchange", read);
    end();
  };
}

/** The server keeps frames for this time, in ms. */
const KEPT = 60_000;
/** Frames before and after an event that belong to it, in ms. */
const BEFORE = 10_000;
const AFTER = 5000;

/** A link to the frames around an event, as long as the server has them. */
function Around({ at }: { at: number }) {
  // ages count by the other clock; this one makes it look again
  const age = now.value >= 0 ? Date.now() - at : 0;
  if (server.value?.source === "addresses" || age > KEPT) return null;
  const time = day(new Date(at).toISOString());
  return (
    <a
      class="small"
      href={`/api/v1/traffic?from=${at - BEFORE}&to=${at + AFTER}`}
      download
      aria-label={t("log.around.of", { time })}
    >
      {t("log.around")}
    </a>
  );
}

function who(record: Record): string {
  const of = named(record.who, record.claimed_name);
  return record.who === "token" ? t("frame.event.program") : t("frame.event.session", { who: of });
}

/** From which computer it came; records of older versions do not have that. */
function from(record: Record & { address?: string | null }): string {
  return record.address ? t("log.from", { address: foreign(record.address) }) : "";
}

function day(iso: string): string {
  return iso.replace("T", " ").replace("Z", "");
}

/** Shorter times from a request to its result are not shown, in ms. */
const LONG = 1000;

/** How long something took, where that was long. */
function took(requested: string | null, ended: string): string {
  const time = requested === null ? 0 : Date.parse(ended) - Date.parse(requested);
  return time < LONG ? "" : t("log.took", { seconds: (time / 1000).toFixed(1) });
}

function Records() {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
    <section class="scroll" tabIndex={0} aria-label={t("log.records")}>
      <table class="log-table">
        <caption class="unseen">{t("log.records")}</caption>
        <thead>
          <tr>
            <th scope="col">{t("log.time")}</th>
            <th scope="col">{t("log.who")}</th>
            <th scope="col">{t("log.drive")}</th>
            <th scope="col">{t("log.action")}</th>
            <th scope="col">{t("log.value")}</th>
            <th scope="col">{t("log.result")}</th>
          </tr>
        </thead>
        <tbody>
          {records.value.length === 0 && (
            <tr>
              <td colSpan={6} class="empty">
                {isRead.value || failure.value !== "" ? (
                  t(Object.values(filter.value).some((text) => text !== "") ? "log.empty" : "log.empty.all")
                ) : (
                  <Loading what={t("loading.log")} count={8} />
                )}
              </td>
            </tr>
          )}
          {rows(records.value).map(({ record, requested }, number) => (
            <tr key={`${record.time}${number}`} data-action={record.action}>
              <td class="number">{day(requested ?? record.time)}</td>
              <td>
                <bdi>{who(record)}</bdi>
                {from(record) && <bdi class="muted small"> {from(record)}</bdi>}
              </td>
              <td>
                <bdi>{foreign(record.name ?? record.drive ?? "\u2013")}</bdi>
              </td>
              <td>{foreign(record.action)}</td>
              <td class="long">
                <bdi>{sentence([record.value ?? "", ...record.changes].filter(Boolean).join("; "))}</bdi>
              </td>
              <td class="long">
                {record.result === null ? (
                  <span class="muted">{t("log.intent")}</span>
                ) : (
                  <bdi>{sentence(record.result)}</bdi>
                )}
                {took(requested, record.time) !== "" && (
                  <span class="muted small"> {took(requested, record.time)}</span>
                )}{" "}
                <Around at={Date.parse(record.time)} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function NetworkTroubles() {
  const newest = [...troubles.value].reverse().slice(0, 50);
  return (
    <section>
      <h2>{t("log.network")}</h2>
      {!isRead.value && failure.value === "" ? (
        <Bars count={3} />
      ) : newest.length === 0 ? (
        <p class="muted">{t("log.network.none")}</p>
      ) : (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
        <section class="scroll" tabIndex={0} aria-label={t("log.network")}>
          <table class="log-table">
            <caption class="unseen">{t("log.network")}</caption>
            <thead>
              <tr>
                <th scope="col">{t("log.time")}</th>
                <th scope="col">{t("machine.from")}</th>
                <th scope="col">{t("machine.to")}</th>
                <th scope="col">{t("log.result")}</th>
                <th scope="col">{t("faults.count")}</th>
              </tr>
            </thead>
            <tbody>
              {newest.map((one, number) => (
                <tr key={`${one.unix_ms}${number}`}>
                  <td class="number">{day(new Date(one.unix_ms).toISOString())}</td>
                  <td>
                    <bdi>{foreign(one.from)}</bdi>
                  </td>
                  <td>
                    <bdi>{foreign(one.to)}</bdi>
                  </td>
                  <td class="long">
                    <bdi>{sentence(one.text)}</bdi> <Around at={one.unix_ms} />
                  </td>
                  <td class="number">{one.count}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </section>
      )}
    </section>
  );
}

function set(more: Partial<typeof filter.value>): void {
  filter.value = { ...filter.value, ...more };
}

/** What people did by this server, and what went wrong on its network. */
export function Log() {
  useEffect(() => want("log", 4), []);
  useEffect(keepFilter, []);
  const count = (topics.value.get("log")?.data as LogTopic | undefined)?.records;
  const { text, drive, action } = filter.value;
  useEffect(() => {
    const timer = setTimeout(() => {
      // the list stays where a reader is
      if (tail.value || count === undefined) void load(false);
    }, PAUSE);
    return () => clearTimeout(timer);
  }, [count, text, drive, action]);
  const change = (more: Partial<typeof filter.value>) => {
    tail.value = true;
    set(more);
  };
  const wanted = query({});
  return (
    <article class="log">
      <div class="title">
        <h1>{t("log.title")}</h1>
        <label>
          <span class="muted small">{t("log.search")}</span>
          <input type="search" value={text} onInput={(event) => change({ text: event.currentTarget.value })} />
        </label>
        <label>
          <span class="muted small">{t("log.drive")}</span>
          <select value={drive} onChange={(event) => change({ drive: event.currentTarget.value })}>
            <option value="">{t("log.all")}</option>
            {(stations.value ?? []).map((station) => (
              <option key={station.id} value={station.id}>
                {label(station)}
              </option>
            ))}
          </select>
        </label>
        <label>
          <span class="muted small">{t("log.action")}</span>
          <select value={action} onChange={(event) => change({ action: event.currentTarget.value })}>
            <option value="">{t("log.all")}</option>
            {ACTIONS.map((one) => (
              <option key={one} value={one}>
                {one}
              </option>
            ))}
          </select>
        </label>
        <a href={`/api/v1/logs/log.csv?${wanted}`} download="log.csv">
          {t("log.csv")}
        </a>
        <a href={`/api/v1/logs/log.jsonl?${wanted}`} download="log.jsonl">
          {t("log.jsonl")}
        </a>
        {server.value?.source !== "addresses" && (
          <a href="/api/v1/traffic" download="last-minute.pcapng">
            {t("log.traffic")}
          </a>
        )}
      </div>
      {failure.value !== "" && <p class="fault">{failure.value}</p>}
      <div class={silent.value === null ? "" : "stale"}>
        <Records />
      </div>
      <p class="buttons">
        {!tail.value && (
          <button type="button" onClick={() => void load(false)}>
            {t("log.newest")}
          </button>
        )}
        {before.value !== null && (
          <button type="button" onClick={() => void load(true)}>
            {t("log.older")}
          </button>
        )}
        <span class="muted small">{t(tail.value ? "log.live" : "log.paused")}</span>
      </p>
      <NetworkTroubles />
    </article>
  );
}
