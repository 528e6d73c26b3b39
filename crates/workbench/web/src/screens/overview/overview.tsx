import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import {
  type Backups,
  type Diff,
  type Quantity,
  request,
  type Station,
  type Status,
  type Values as ValuesReport,
} from "../../api";
import { address, selected } from "../../app/selected";
import { Acknowledge } from "../../parts/Acknowledge";
import { Command } from "../../parts/Command";
import { digits, foreign, label, sentence, unit } from "../../parts/format";
import { Icon } from "../../parts/Icon";
import { Bars, Loading } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { findings, otherOwner, ownerName, sign } from "../../parts/Reason";
import { Shaft } from "../../parts/Shaft";
import { Spark } from "../../parts/Spark";
import { heldAxis } from "../../store/control";
import { aged, events, server, silent, whenRestarted } from "../../store/store";
import { age, ageLong, t, utc } from "../../text";
import { right } from "../compare/state";
import { conditions } from "./conditions";
import { Steps } from "./Steps";

/** Values older than this are grey; older than the second are dashes. In s. */
const STALE = 3;
const GONE = 15;

/** Whether its status is read for the first time. */
function isAwaited({ status, error, lost, unread, remarks }: Station): boolean {
  return status === null && error === null && lost === null && unread === null && remarks.length === 0;
}

function whyNot(station: Station): string {
  const { status, error } = station;
  if (station.lost !== null) return findings(station)[0] ?? "";
  if (status) return status.sentence;
  if (error) return error.message;
  if (station.remarks.includes("no_address")) return t("overview.noaddress");
  return station.unread ?? (station.remarks.length > 0 ? findings(station).join(", ") : t("overview.loading"));
}

function Why({ station }: { station: Station }) {
  const { status, error } = station;
  const { icon, tone, word } = sign(station);
  // what was advised before a drive went silent is no advice for that
  const next = station.lost === null ? (status?.next ?? error?.hint) : t("overview.lost.next");
  const name = otherOwner(station);
  return (
    <section class="why-not" data-cause={status?.cause ?? ""} data-id={station.id}>
      <p class={`sentence ${tone}`}>
        <Icon name={icon} />
        <span class="unseen">
          {label(station)} {word}.{" "}
        </span>
        <bdi>{sentence(whyNot(station))}</bdi>
      </p>
      {next && (
        <p class="next">
          <b>{t("overview.next")}</b> <bdi>{sentence(next)}</bdi>
        </p>
      )}
      <p class="buttons next-steps">{station.lost === null && <Steps station={station} />}</p>
      {name !== null && <p>{t("overview.watch", { name })}</p>}
      {name !== null && heldAxis(station.id) && (
        <p class="buttons next-steps">
          <a class="roomy" href={address(station.id, "control") + location.search}>
            {t("step.control")}
          </a>
        </p>
      )}
      {status && station.lost === null && <Acknowledge station={station} present={status.faults} />}
      {station.remarks.includes("no_name") && <p>{t("overview.noname")}</p>}
      {status?.notes.map((note) => (
        <p key={note.cause} class="note">
          <b>{t("overview.also")}</b> <bdi>{sentence(note.sentence)}</bdi>
        </p>
      ))}
    </section>
  );
}

function Conditions({ station, status }: { station: Station; status: Status }) {
  return (
    <section>
      <h2>{t("overview.conditions")}</h2>
      <ul class="conditions">
        {conditions(status, ownerName(station)).map(({ name, met: was, value }) => {
          // of a drive that does not answer nothing is good or bad
          const met = station.lost === null ? was : null;
          return (
            <li key={name}>
              {/* a fact that is neither good nor bad has no sign: a dash would say that it is missing */}
              {met === null ? (
                <span class="icon" />
              ) : (
                <Icon name={met ? "tick" : "square"} tone={met ? "muted" : "accent"} />
              )}
              <span class="unseen">
                {t(met === null ? "condition.info" : met ? "condition.met" : "condition.unmet")}:{" "}
              </span>
              <span>{name}</span>
              <bdi class="muted">{foreign(value)}</bdi>
            </li>
          );
        })}
      </ul>
    </section>
  );
}

function Faults({ status }: { status: Status }) {
  const all = [
    ...status.faults.map((fault) => ({ ...fault, tone: "fault", icon: "cross" as const, sign: "F" })),
    ...status.warnings.map((warning) => ({ ...warning, tone: "warn", icon: "triangle" as const, sign: "W" })),
  ];
  if (all.length === 0) return null;
  return (
    <section>
      <h2>{t("overview.faults")}</h2>
      <ul class="faults">
        {all.map((one) => (
          <li key={`${one.sign}${one.number}`}>
            <p class={one.tone}>
              <Icon name={one.icon} />
              <b>
                {one.sign}
                {one.number}
              </b>{" "}
              <bdi>{foreign(one.meaning ?? "")}</bdi>
            </p>
            {one.remedy && <p class="muted">{t("overview.remedy", { text: sentence(one.remedy) })}</p>}
          </li>
        ))}
      </ul>
    </section>
  );
}

interface Shown {
  id: string;
  name: string;
  title: string;
  quantity: Quantity | null;
  seconds: number | null;
  /** What 100 % is. */
  of?: "reference" | "torque";
}

function Value({ id, name, title, quantity, seconds, of = "reference" }: Shown) {
  if (quantity === null) return null;
  const gone = silent.value !== null || seconds === null || seconds > GONE;
  const stale = gone || seconds > STALE;
  return (
    <div class={stale ? "value stale" : "value"}>
      <dt>{quantity.unit === "%" ? t(`value.of.${of}`, { name: title }) : title}</dt>
      <dd>
        <span class="main number">{gone ? "\u2013" : digits(quantity)}</span> <span class="unit">{unit(quantity)}</span>
        <Spark id={id} name={name} title={title} unit={unit(quantity)} />
      </dd>
    </div>
  );
}

function Values({ station }: { station: Station }) {
  const seconds = aged(station.age);
  const { status, id } = station;
  if (!status) return null;
  const read = seconds === null ? 0 : seconds;
  const stale = silent.value !== null || read > STALE;
  const common = { id, seconds };
  return (
    <section>
      <h2>
        {t("overview.values")}
        {server.value?.simulation && <Shaft id={id} />}
        <span class="muted small">{t(stale ? "overview.stale" : "overview.age", { age: age(read) })}</span>
      </h2>
      <dl class="values">
        <Value {...common} name="speed" title={t("value.speed")} quantity={status.speed_actual} />
        <Value {...common} name="set" title={t("value.set")} quantity={status.speed_set} />
        <Value {...common} name="position" title={t("value.position")} quantity={status.position} />
        <Value {...common} name="following" title={t("value.following")} quantity={status.following_error} />
        <Value {...common} name="current" title={t("value.current")} quantity={status.current} />
        <Value {...common} name="torque" title={t("value.torque")} quantity={status.torque} of="torque" />
        <Value {...common} name="temperature" title={t("value.temperature")} quantity={status.temperature} />
        <Value {...common} name="motor" title={t("value.motor")} quantity={status.motor_temperature} />
        <Value {...common} name="bus" title={t("value.bus")} quantity={status.bus_voltage} />
      </dl>
    </section>
  );
}

/** Each row has its place before it is read, and without a text: what stands below does not move. */
function Identity({ station }: { station: Station }) {
  const identity = station.info?.identity;
  const rows: [string, string | undefined][] = [
    [t("identity.order"), identity?.order_id],
    [t("identity.serial"), identity?.serial_number],
    [t("identity.firmware"), identity?.software_revision],
    [t("identity.hardware"), identity ? String(identity.hardware_revision) : undefined],
    [t("identity.address"), station.ip ? `${station.ip}/${station.prefix ?? ""}` : undefined],
    [t("identity.mac"), station.mac],
    [t("identity.function"), identity?.function],
    [t("identity.location"), identity?.location],
  ];
  return (
    <section>
      <h2>{t("overview.identity")}</h2>
      <dl class="pairs">
        {rows.map(([name, text]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd>
              <bdi>{foreign(text?.trim() || "\u2013")}</bdi>
            </dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

/** The rights by which others keep a drive from being changed or controlled (PNU 927 and 928), and the last backup. */
const extras = signal<ReadonlyMap<string, Extras>>(new Map());
whenRestarted(() => {
  extras.value = new Map();
});

interface Extras {
  rights: { name: string; value: string }[];
  /** The last backup; `null` where there is none. */
  backup: Backups["files"][number] | null;
  /** How many settings differ from it; `null` where that was not read. */
  since: number | null;
  /** How many settings differ from those as delivered; `null` where those are not known. */
  changed: number | null;
}

/** Time for reading all settings whose delivered value is known, in ms. */
const SETTINGS = 25_000;

async function readExtras({ id, name }: Station): Promise<void> {
  const values = async () => {
    const read = await request<ValuesReport>(`drives/${encodeURIComponent(id)}/values/927,928?present=true`);
    return read.parameters.map((one) => ({
      name: one.name || `PNU ${one.pnu}`,
      value: one.meaning ?? one.text ?? String(one.value ?? ""),
    }));
  };
  const rights = await values().catch(() => []);
  const files = await request<Backups>("backups").then(
    (report) => report.files,
    () => [],
  );
  const path = `drives/${encodeURIComponent(id)}/changed`;
  const count = (query: string) =>
    request<Diff>(path + query, { signal: AbortSignal.timeout(SETTINGS) }).then(
      (report) => report.differences.length,
      () => null,
    );
  const changed = await count("");
  // the newest is the first
  const backup = files.find((file) => file.drive === name && !file.before) ?? null;
  const since = backup === null ? null : await count(`?file=${encodeURIComponent(backup.file)}`);
  extras.value = new Map(extras.value).set(id, { rights, backup, since, changed });
}

function Care({ station }: { station: Station }) {
  const readable = station.status !== null;
  useEffect(() => {
    if (readable) void readExtras(station);
  }, [station.id, readable]);
  const known = extras.value.get(station.id);
  if (known === undefined && !readable) return null;
  if (known === undefined) {
    return (
      <section class="care">
        <h2>{t("overview.care")}</h2>
        <Loading key={station.id} what={t("loading.care", { name: label(station) })} count={2} />
      </section>
    );
  }
  const { backup } = known;
  return (
    <section class="care">
      <h2>{t("overview.care")}</h2>
      <dl class="pairs">
        <div>
          <dt>{t("overview.backup")}</dt>
          <dd>
            {backup === null
              ? t("overview.backup.none")
              : t("overview.backup.age", { age: ageLong(Date.now() / 1000 - backup.time) })}
            {known.since !== null &&
              `, ${t(`overview.since.${known.since === 0 ? "none" : known.since === 1 ? "one" : "count"}`, {
                count: known.since,
              })}`}{" "}
            {backup !== null && (
              <a
                class="roomy"
                href={address(station.id, "compare") + location.search}
                onClick={() => {
                  right.value = `file ${backup.file}`;
                }}
              >
                {t("overview.backup.compare")}
              </a>
            )}
          </dd>
        </div>
        {known.changed !== null && (
          <div>
            <dt>{t("overview.changed")}</dt>
            <dd>
              {t(`overview.changed.${known.changed === 0 ? "none" : known.changed === 1 ? "one" : "count"}`, {
                count: known.changed,
              })}{" "}
              {known.changed > 0 && (
                <a class="roomy" href={`${address(station.id, "parameters")}${location.search}#only=changed`}>
                  {t("overview.changed.show")}
                </a>
              )}
            </dd>
          </div>
        )}
        {known.rights.map(({ name, value }) => (
          <div key={name}>
            <dt>
              <bdi>{foreign(name)}</bdi>
            </dt>
            <dd>
              <bdi>{foreign(value)}</bdi>
            </dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

function Events({ id }: { id: string }) {
  const own = events.value.filter((event) => event.drive === id).slice(0, 5);
  return (
    <section>
      <h2>{t("overview.events")}</h2>
      {own.length === 0 ? (
        <p class="muted">{t("overview.events.none")}</p>
      ) : (
        <ul class="events">
          {own.map(({ time, text }) => (
            <li key={`${time.getTime()} ${text}`}>
              <time class="number muted">{utc(time)}</time> <bdi>{sentence(text)}</bdi>
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}

export function Overview() {
  const { path } = useLocation();
  const station = selected(path);
  if (!station) {
    return <Nothing title={t("overview.title")} select={t("overview.none")} />;
  }
  const awaited = isAwaited(station);
  return (
    <article class="overview">
      <div>
        <h1>
          <bdi>{label(station)}</bdi>
        </h1>
        <Why station={station} />
        {station.status && <Conditions station={station} status={station.status} />}
        {awaited && <Loading what={t("loading.status", { name: label(station) })} count={9} />}
        {station.status && <Faults status={station.status} />}
        <Command verb="status" station={station} />
      </div>
      <div>
        {awaited && <Bars count={4} height={64} />}
        <Values station={station} />
        <Identity station={station} />
        <Care station={station} />
        <Events id={station.id} />
      </div>
    </article>
  );
}
