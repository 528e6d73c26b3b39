import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import type { FaultsTopic, Station } from "../../api";
import { address, selected, selectedId } from "../../app/selected";
import { Acknowledge } from "../../parts/Acknowledge";
import { Command } from "../../parts/Command";
import { downloadText } from "../../parts/download";
import { cell, digits, foreign, label, sentence } from "../../parts/format";
import { Icon } from "../../parts/Icon";
import { Loading } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { want } from "../../store/live";
import { firstSeen } from "../../store/seen";
import { now, silent, topics } from "../../store/store";
import { age, t, utc } from "../../text";
import { history } from "./history";

/** Values older than this are grey, in s. */
const STALE = 3;

/** What a drive was like when a fault was seen first, in words. */
function moment(status: Station["status"]): string {
  const { stw1, zsw1, speed_actual: speed } = status ?? {};
  const parts = [
    stw1 ? `STW1 ${stw1.hex}` : "",
    zsw1 ? `ZSW1 ${zsw1.hex}` : "",
    speed ? `${digits(speed)} ${speed.unit}` : "",
  ];
  return parts
    .filter(Boolean)
    .map((part) => ` \u00b7 ${part}`)
    .join("");
}

/** Links to the parameters that a remedy names. */
function Named({ id, parameters }: { id: string; parameters: readonly string[] }) {
  if (parameters.length === 0) return null;
  return (
    <p class="small roomy">
      <span class="muted">{t("faults.parameters")}</span>{" "}
      {parameters.map((name) => (
        <>
          <a key={name} href={`${address(id, "parameters")}${location.search}#${new URLSearchParams({ q: name })}`}>
            {foreign(name)}
          </a>{" "}
        </>
      ))}
    </p>
  );
}

/** The address of the Scope at a time. */
function scopeAt(id: string, time: Date): string {
  return `${address(id, "scope")}${location.search}#at=${time.getTime()}`;
}

function Present({ id, report, station }: { id: string; report: FaultsTopic["report"]; station: Station }) {
  const present = report?.faults.filter((fault) => !fault.acknowledged) ?? [];
  const warnings = report?.warnings ?? [];
  return (
    <section>
      <h2>{t("faults.present")}</h2>
      <p class="unseen" role="alert">
        {present
          .map((fault) => t("faults.announce", { number: fault.number, text: foreign(fault.meaning ?? "") }))
          .join(" ")}
      </p>
      {present.length === 0 && warnings.length === 0 && <p class="muted">{t("faults.none")}</p>}
      <ul class="faults">
        {present.map((fault) => (
          <li key={`${fault.number} ${fault.position}`}>
            <p class="fault">
              <Icon name="cross" />
              <b>F{fault.number}</b> <bdi>{foreign(fault.meaning ?? t("faults.unknown"))}</bdi>
            </p>
            <p class="muted small number">
              {t("faults.seen", { time: utc(firstSeen(id, fault.number).time) })}
              {moment(firstSeen(id, fault.number).status)}
              {fault.value !== null && ` · ${t("faults.value", { value: fault.value })}`}
              {fault.time !== null && ` · ${t("faults.time", { time: fault.time })}`}
            </p>
            {fault.reaction && <p class="muted">{t("faults.reaction", { text: sentence(fault.reaction) })}</p>}
            {fault.remedy && <p>{t("overview.remedy", { text: sentence(fault.remedy) })}</p>}
            <Named id={id} parameters={fault.parameters} />
            <p class="small roomy">
              <a href={scopeAt(id, firstSeen(id, fault.number).time)}>{t("faults.scope")}</a>
            </p>
            {fault.cleared && <p class="muted">{t("faults.cleared", { text: sentence(fault.cleared) })}</p>}
          </li>
        ))}
        {warnings.map((warning) => (
          <li key={`w${warning.number}`}>
            <p class="warn">
              <Icon name="triangle" />
              <b>W{warning.number}</b> <bdi>{foreign(warning.meaning ?? "")}</bdi>
            </p>
            {warning.remedy && <p>{t("overview.remedy", { text: sentence(warning.remedy) })}</p>}
            <Named id={id} parameters={warning.parameters} />
          </li>
        ))}
      </ul>
      <Acknowledge station={station} present={present} />
    </section>
  );
}

function Before({ report }: { report: NonNullable<FaultsTopic["report"]> }) {
  const lines = history(report.faults);
  return (
    <section>
      <h2>{t("faults.history")}</h2>
      <p class="muted">
        {t("faults.counter", { count: report.counter })}
        {report.situation_counter !== null && ` ${t("faults.situations", { count: report.situation_counter })}`}
      </p>
      {lines.length === 0 ? (
        <p class="muted">{t("faults.history.none")}</p>
      ) : (
        <table>
          <caption class="unseen">{t("faults.history")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("faults.situation")}</th>
              <th scope="col">{t("faults.fault")}</th>
              <th scope="col">{t("faults.meaning")}</th>
              <th scope="col">{t("faults.count")}</th>
            </tr>
          </thead>
          <tbody>
            {lines.map(({ key, situation, fault, count }) => (
              <tr key={key}>
                <td class="number">{situation}</td>
                <th scope="row" class="number">
                  F{fault.number}
                </th>
                <td>
                  <bdi>{foreign(fault.meaning ?? "")}</bdi>
                </td>
                <td class="number">{count}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </section>
  );
}

/** Writes the faults and warnings to a file of the browser: those that are present, and those of before. */
function exportFaults(station: Station, report: NonNullable<FaultsTopic["report"]>): void {
  const head = ["drive", "kind", "situation", "number", "meaning", "value", "time of the drive", "remedy"];
  const name = label(station);
  const rows = [
    ...report.faults.map((fault) => [
      name,
      fault.acknowledged ? "acknowledged fault" : "fault",
      String(fault.situation ?? ""),
      String(fault.number),
      fault.meaning ?? "",
      String(fault.value ?? ""),
      String(fault.time ?? ""),
      fault.remedy ?? "",
    ]),
    ...(report.warnings ?? []).map(({ number, meaning, remedy }) => [
      name,
      "warning",
      "",
      String(number),
      meaning ?? "",
      "",
      "",
      remedy ?? "",
    ]),
  ];
  downloadText("faults.csv", "text/csv", [head, ...rows].map((row) => `${row.map(cell).join(",")}\r\n`).join(""));
}

/** The faults of the selected drive, with their remedies. */
export function Faults() {
  const { path } = useLocation();
  const id = selectedId(path);
  const station = selected(path);
  const topic = `drive/${id}/faults`;
  useEffect(() => (id === null ? undefined : want(topic, 2)), [id, topic]);
  if (id === null || !station) {
    return <Nothing title={t("faults.title")} select={t("faults.select")} />;
  }
  const held = topics.value.get(topic);
  const { report, error } = (held?.data as FaultsTopic | undefined) ?? { report: null, error: null };
  const seconds = held === undefined ? 0 : Math.max(0, (now.value - held.received) / 1000);
  const stale = silent.value !== null || seconds > STALE;
  return (
    <article class={stale ? "faults-screen stale" : "faults-screen"}>
      <h1>
        {t("faults.title")} <bdi>{label(station)}</bdi>
        <span class="muted small"> {held && t(stale ? "overview.stale" : "overview.age", { age: age(seconds) })}</span>
      </h1>
      {error && (
        <p class="fault">
          <bdi>{sentence(error.message)}</bdi>
        </p>
      )}
      {!report && !error && <Loading key={id} what={t("loading.faults", { name: label(station) })} count={6} />}
      {report && <Present id={id} report={report} station={station} />}
      {report && <Before report={report} />}
      {report && (
        <p class="buttons">
          <button type="button" onClick={() => exportFaults(station, report)}>
            {t("network.export")}
          </button>
          <a class="roomy" href={address(id, "machine") + location.search}>
            {t("nav.machine")}
          </a>
          <a class="roomy" href={address(id, "scope") + location.search}>
            {t("nav.scope")}
          </a>
          <a class="roomy" href={address(id, "parameters") + location.search}>
            {t("nav.parameters")}
          </a>
        </p>
      )}
      <Command verb="faults" station={station} more={["--history"]} />
    </article>
  );
}
