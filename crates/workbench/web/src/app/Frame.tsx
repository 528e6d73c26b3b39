import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { useLocation } from "preact-iso";
import type { LinkTopic, Station } from "../api";
import { capital, digits, foreign, label, product, sorted } from "../parts/format";
import { otherPage, ownerName, ownerShort, person, State } from "../parts/Reason";
import * as control from "../store/control";
import { axes, stopped as isStopped, lastStop, leases, refusal, reset, stopState } from "../store/control";
import { stop, stopBeside, stopText, want } from "../store/live";
import {
  aged,
  type Happening,
  happened,
  now,
  outdated,
  paused,
  quiet,
  server,
  silent,
  stations,
  topics,
} from "../store/store";
import { age, t } from "../text";
import { address, OF_DRIVE, recent, screenOf, stationOf } from "./selected";

/** The event that was read. */
const shown = signal(-1);
/** What this page did itself, and was done, is said for this time, in ms. */
const DONE = 5000;

/** Returns what happened last, in words. */
function event({ kind, drive, who, claimed_name, text, failed }: Happening): string {
  const station = stations.value?.find((one) => one.id === drive);
  const by = person(who, claimed_name);
  // a message of the library begins with the drive
  const named = station && !text.startsWith(`${label(station)}: `) ? `${label(station)}: ` : "";
  // the log says by its kind that it failed
  const what = t(failed && kind !== "log" ? "frame.event.failed" : `frame.event.${kind}`);
  // that it was done is what the first words say
  const words = `${what} ${named}${text}`.replace(/: done$/, "");
  return foreign(`${words}${who === "" ? "" : ` (${by})`}`, 300);
}

type Means = "parameter" | "control_word";

/** The stop of a drive that no controller has: by what, its requests without an answer, and what became of it, in words. */
interface Beside {
  means: Means;
  waiting: number;
  text: string;
}
/** Those of the last STOP of this page, and those before it that last, by drive. */
const besides = signal<ReadonlyMap<string, Beside>>(new Map());

/** Returns the stop of a drive while it lasts. */
function besideNow(station: Station | undefined): Beside | undefined {
  const beside = besides.value.get(station?.id ?? "");
  return beside?.waiting ? beside : undefined;
}

/** Returns how a drive is stopped that no controller has; `null` where STOP does not do that. */
export function besideOf(station: Station | undefined): Means | null {
  if (axes.value.some(({ drive }) => drive === station?.id)) return null;
  const means = station?.stop?.means;
  // while it is stopped this server is its controller: a second press is for the same stop
  return means === "parameter" || means === "control_word" ? means : (besideNow(station)?.means ?? null);
}

/** STOP, by whatever key or button: of each axis of this server, and of the selected drive where no controller has it. */
export async function pressStop(): Promise<void> {
  const station = stationOf(recent(location.pathname));
  const means = besideOf(station);
  besides.value = new Map([...besides.value].filter(([, { waiting }]) => waiting > 0));
  const beside = means !== null || besides.value.size > 0;
  const stopping = control.pressStop(() => stop(beside));
  if (station !== undefined && means !== null) {
    const { id } = station;
    const sent = t(`stop.beside.sent.${means}`, { name: label(station) });
    const note = (more: number, text: string) => {
      const waiting = (besides.value.get(id)?.waiting ?? 0) + more;
      besides.value = new Map(besides.value).set(id, { means, waiting, text: waiting > 0 ? sent : text });
    };
    note(1, sent);
    note(-1, await stopBeside(station));
  }
  await stopping;
}

/** Returns what became of the drives that no controller has, in words. A reset takes away what has ended. */
function becameBeside(): string {
  const all = [...besides.value.values()].filter(({ waiting }) => waiting > 0 || stopState.value !== "");
  return all.map(({ text }) => text).join(" ");
}

/** Returns what became of the last STOP of this page, in words. */
function became(): string {
  const last = lastStop.value;
  switch (stopState.value) {
    case "sent":
      return t("stop.sent");
    case "unconfirmed":
      return t("stop.unconfirmed");
    case "confirmed":
    case "unsent":
      return last === null ? "" : stopText(last.epoch, last.confirmed, last.axes, besides.value.size > 0);
    case "answered":
      return control.stopText.value;
    default:
      return "";
  }
}

/** Returns who pressed STOP, in words. */
function pressed(): string {
  const last = lastStop.value;
  if (last === null) return t("frame.stopped.before", { epoch: control.epoch.value });
  return t("frame.stopped", { epoch: last.epoch, by: person(last.by, last.claimed_name) });
}

/** Returns the numbers of the faults that a drive reports. */
function faults(status: NonNullable<Station["status"]>): string {
  if (status.faults.length === 0) return t("frame.fault.none");
  return status.faults.map((fault) => `F${fault.number}`).join(", ");
}

/** Values older than this are grey, in s. */
const STALE = 3;

function Selector() {
  const { path, route } = useLocation();
  const id = recent(path) ?? "";
  const all = sorted(stations.value ?? []);
  const known = id === "" || all.some((station) => station.id === id);
  return (
    <label class="selector">
      <span class="muted">{t("frame.drive")}</span>
      <select
        value={id}
        onChange={(event) => {
          const here = screenOf(path);
          const screen = OF_DRIVE.find((one) => one === here) ?? "overview";
          route(address(event.currentTarget.value, screen) + location.search);
        }}
      >
        <option value="" disabled hidden>
          {t("frame.none")}
        </option>
        {!known && <option value={id}>{foreign(id)}</option>}
        {all.map((station) => (
          <option key={station.id} value={station.id}>
            {label(station)}
          </option>
        ))}
      </select>
    </label>
  );
}

/** A shorter time is shown in steps of this, in s. */
function ms(seconds: number | null): string {
  return seconds === null ? "\u2013" : (seconds * 1000).toFixed(2);
}

/** How regular the cyclic frames of a drive reach this computer. */
function Link({ id }: { id: string }) {
  useEffect(() => want(`drive/${id}/link`, 2), [id]);
  const held = topics.value.get(`drive/${id}/link`);
  // before the first report nothing is known of them
  if (held === undefined || silent.value !== null) return <span class="spare muted">{"\u2013"}</span>;
  const fresh = (now.value - held.received) / 1000 < STALE;
  const timing = fresh ? (held.data as LinkTopic).timing : null;
  if (timing === null) return <span class="spare muted">{t("frame.link.none")}</span>;
  return (
    <span
      class="number spare"
      title={t("frame.link.about", { median: ms(timing.jitter_p50) })}
      data-link={timing.frames}
    >
      {t("frame.link", {
        cycle: Number((timing.cycle * 1000).toFixed(3)),
        most: ms(timing.jitter_p99),
      })}{" "}
      <span class={timing.lost > 0 ? "fault" : ""}>{t("frame.link.missed", { count: timing.lost })}</span>
    </span>
  );
}

/** Returns a word as the reports have it. */
function hex(word: number | null): string | null {
  return word === null ? null : `0x${word.toString(16).toUpperCase().padStart(4, "0")}`;
}

function Facts({ station }: { station: Station }) {
  const { status } = station;
  // of an axis that this server controls each cycle is known, the status is read now and then
  const axis = control.heldAxis(station.id);
  const old = (axis ? axis.lost || control.old.value : (aged(station.age) ?? 0) > STALE) || quiet.value;
  const dash = "\u2013";
  // without the control socket it is not known who has the drive that was of this page
  const live = silent.value === null && !control.ended.value;
  const words = axis
    ? { stw1: hex(axis.stw1), zsw1: hex(axis.zsw1) }
    : { stw1: status?.stw1?.hex, zsw1: status?.zsw1?.hex };
  const exact = axis?.speed == null ? null : { value: axis.speed, unit: axis.unit, beyond: null };
  // a telegram of position has no speed: then it is the one that was read
  const fresh = (aged(station.age) ?? STALE) < STALE ? status?.speed_actual : null;
  const speed = axis ? (exact ?? fresh) : status?.speed_actual;
  return (
    <>
      <p class="line">
        <bdi title={product(station)}>{product(station)}</bdi>
        <span class="number spare">{station.ip ?? dash}</span>
        <span class="spare">
          {!live
            ? dash
            : status?.telegram
              ? t("frame.telegram", { number: status.telegram })
              : t("frame.telegram.none")}
        </span>
        <Link id={station.id} />
        <bdi class="owner" title={live ? ownerShort(station) : undefined}>
          {live ? ownerShort(station) : dash}
        </bdi>
      </p>
      <p class={old ? "line stale" : "line"}>
        {live && axis && (
          <span class={control.operates(axis) ? "state live" : "state"}>
            <span class="cut">{t(`control.phase.${control.phaseOf(axis)}`)}</span>
          </span>
        )}
        {live ? !axis && <State station={station} /> : dash}
        <span class="number spare">
          <span class="muted">STW1</span> {(live && words.stw1) || dash}
        </span>
        <span class="number spare">
          <span class="muted">ZSW1</span> {(live && words.zsw1) || dash}
        </span>
        <span class="number wide">
          {live && speed ? digits(speed) : dash} <span class="unit">{speed?.unit ?? "rpm"}</span>
        </span>
        <span class={live && status?.faults.length ? "fault" : ""}>{live && status ? faults(status) : dash}</span>
        {live && status !== null && status.warnings.length > 0 && (
          <span class="warn" title={status.warnings.map(({ meaning }) => foreign(meaning ?? "")).join("; ")}>
            {status.warnings.map(({ number }) => t("frame.warning", { number })).join(", ")}
          </span>
        )}
      </p>
    </>
  );
}

function Stop({ station }: { station: Station | undefined }) {
  const count = axes.value.length;
  const only = count === 1 ? axes.value[0] : undefined;
  const name = ownerName(station);
  const offer = station?.stop;
  const beside = besideOf(station);
  // without one of these a person in front of a row that turns would find no STOP
  const other = beside === null ? stations.value?.find((one) => besideOf(one) !== null) : undefined;
  const named = station ? label(station) : "";
  const reason = offer?.reason;
  const own = !control.connected.value
    ? t(control.ended.value ? "frame.lost.control" : "stop.why.chosen")
    : only !== undefined
      ? t("stop.why.one", { how: t(`stop.by.${only.stop_by}`) })
      : count > 0
        ? t(axes.value.some(({ stop_by }) => stop_by !== "off3") ? "stop.why.chosen" : "stop.why.own")
        : "";
  const none =
    name !== null
      ? t("stop.why.owner", { name })
      : reason === "local_operation" || reason === "needs_interface"
        ? t(`stop.why.${reason}`, { name: named })
        : other
          ? ""
          : t("stop.why.none");
  const more =
    besideNow(station)?.text ??
    (beside !== null ? t(`stop.why.${beside}`, { name: named, parameter: offer?.parameter ?? "" }) : own ? "" : none);
  const select = other ? t("stop.why.select", { name: label(other) }) : "";
  const why = silent.value !== null ? t("stop.why.unreachable") : [own, more, select].filter(Boolean).join(" ");
  const first = stations.value?.find((one) => one.id === axes.value[0]?.drive);
  const axis = count > 1 ? t("stop.axes.count", { count }) : first ? label(first) : (axes.value[0]?.drive ?? "");
  const all = [axis, beside === null ? "" : named].filter(Boolean).join(", ");
  const text =
    silent.value !== null
      ? t("stop.unreachable")
      : all !== ""
        ? t(beside === null ? "stop.one" : `stop.beside.${beside}`, { name: all })
        : t(control.connected.value ? "stop.none" : "stop.all");
  return (
    <>
      <p class="line why" id="stop-why">
        <bdi>{why}</bdi> <span class="small">{t("stop.safety")}</span>{" "}
        {leases.value.size > 0 && <span class="small">{t("frame.control.keys")}</span>}
      </p>
      <button
        type="button"
        class={text === t("stop.none") ? "stop none" : "stop"}
        aria-describedby="stop-why"
        onPointerDown={(event) => {
          if (event.button === 0) void pressStop();
        }}
        onClick={(event) => {
          // the click that ends a press, however long, is no second one; a key has no press before it
          if (event.detail === 0) void pressStop();
        }}
      >
        {text}
      </button>
    </>
  );
}

/** Who pressed STOP, and the button that permits motion again. */
function Reset() {
  const button = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    // STOP disables the button that had the focus. Only with an axis: then the space bar is STOP here, too
    const focus = document.activeElement;
    const none = !(focus instanceof HTMLElement) || focus.tabIndex < 0 || focus.matches(":disabled");
    if (leases.value.size > 0 && none) button.current?.focus({ preventScroll: true });
  }, []);
  return (
    <p class="band reset">
      <bdi>{pressed()}</bdi>
      <button ref={button} type="button" disabled={refusal.value !== null} onClick={() => reset()}>
        {t("frame.reset")}
      </button>
    </p>
  );
}

/** Who waits for a drive of this page, and what this page can answer. It moves no button under a hand. */
function Wanted({ axis }: { axis: control.Axis }) {
  const { wanted } = axis;
  if (wanted === null) return null;
  const station = stations.value?.find(({ id }) => id === axis.drive);
  const name = station ? label(station) : axis.drive;
  const who = otherPage(wanted.by, wanted.claimed_name);
  const text = t(wanted.accepted ? "control.handing" : "control.wanted", { who, name });
  return (
    <div class="band wanted">
      <bdi role="status">{wanted.accepted ? text : capital(text)}</bdi>
      {!wanted.accepted && (
        <>
          <button type="button" onClick={() => control.handOver(axis)}>
            {t("control.hand")}
          </button>
          <button type="button" onClick={() => control.keep(axis)}>
            {t("control.keep")}
          </button>
          {/* outside of the status, which would be read out each second, and where it moves no button */}
          <span class="number">{t("control.waits.left", { seconds: wanted.seconds })}</span>
        </>
      )}
    </div>
  );
}

/** What stands above each screen: the selected drive, the mode and STOP. */
export function Frame() {
  const station = stationOf(recent(useLocation().path));
  const top = useRef<HTMLElement>(null);
  useEffect(() => {
    // what sticks below the frame, and where the focus scrolls to, follow its height
    const seen = new ResizeObserver(([entry]) => {
      const height = entry?.borderBoxSize[0]?.blockSize ?? 0;
      document.documentElement.style.setProperty("--frame-height", `${Math.ceil(height)}px`);
    });
    if (top.current) seen.observe(top.current);
    return () => seen.disconnect();
  }, []);
  const last = happened.value;
  const passes = last !== null && last.who === control.session.value && !last.failed && last.kind !== "stop";
  useEffect(() => {
    if (last === null || !passes) return;
    const timer = setTimeout(() => {
      shown.value = last.n;
    }, DONE);
    return () => clearTimeout(timer);
  }, [last?.n, passes]);
  // a STOP has its own line until it is reset
  const news = happened.value?.n !== shown.value && !(happened.value?.kind === "stop" && isStopped.value);
  const notice = `${becameBeside()} ${became()}`.trim();
  const simulation = server.value?.simulation ?? false;
  // whose control socket is gone has no control, and does not know yet whether it may write
  const mode =
    silent.value !== null || control.ended.value
      ? "offline"
      : leases.value.size > 0
        ? "control"
        : server.value?.read_only
          ? "readonly"
          : server.value?.role === "view"
            ? "view"
            : "write";
  return (
    <>
      <header class="top" ref={top}>
        <div class="frame">
          <Selector />
          {station ? <Facts station={station} /> : <p class="line muted">{t("frame.select")}</p>}
          <p class="badges">
            {server.value?.name && <bdi class="muted">{foreign(server.value.name)}</bdi>}
            {simulation && <span class="badge simulation">{t("frame.simulation")}</span>}
            <span class={`badge ${mode}`}>{t(`frame.${mode}`)}</span>
          </p>
          <Stop station={station} />
        </div>
        {simulation && (
          <p class="band simulation">
            <span>{t(paused.value ? "frame.simulation.paused" : "frame.simulation.band")}</span>
          </p>
        )}
      </header>
      <aside class="notices" aria-label={t("frame.notices")}>
        {outdated.value && (
          <p class="band outdated" role="alert">
            {t("frame.outdated")}{" "}
            <button type="button" onClick={() => location.reload()}>
              {t("frame.reload")}
            </button>
          </p>
        )}
        <p class="band stopped" role="alert" hidden={notice === ""}>
          {notice}
        </p>
        {isStopped.value && <Reset />}
        {[...leases.value.keys()].map((drive) => {
          const axis = control.own(drive);
          return axis && <Wanted key={drive} axis={axis} />;
        })}
        {news && happened.value !== null && (
          <p class="band happened">
            <bdi role="status">{event(happened.value)}</bdi>
            <button
              type="button"
              onClick={() => {
                shown.value = happened.value?.n ?? -1;
              }}
            >
              {t("frame.event.hide")}
            </button>
          </p>
        )}
        {silent.value !== null && (
          <p class="band lost" role="alert">
            {t("frame.lost", { age: age(silent.value) })}{" "}
            {t(control.ended.value ? "frame.lost.control" : "frame.lost.all")}
          </p>
        )}
      </aside>
    </>
  );
}
