import { useEffect, useState } from "preact/hooks";
import { type LogPage, type LogTopic, request, type Station, type TelegramLayout } from "../../api";
import { address } from "../../app/selected";
import { Command } from "../../parts/Command";
import { foreign, sentence } from "../../parts/format";
import { person } from "../../parts/Reason";
import { want } from "../../store/live";
import { topics } from "../../store/store";
import { t } from "../../text";
import * as edit from "./edit";
import { type LastChange as Found, lastChange } from "./lastChange";

/** Who changed it last by this server. */
function LastChange({ of }: { of: string }) {
  const [found, setFound] = useState<Found | null>(null);
  useEffect(() => want("log", 1), []);
  const count = (topics.value.get("log")?.data as LogTopic | undefined)?.records;
  const drive = edit.drive.value;
  useEffect(() => {
    let current = true;
    const query = new URLSearchParams({ drive, text: of, most: "20" });
    request<LogPage>(`audit?${query}`).then(
      ({ records }) => current && setFound(lastChange(records, of)),
      () => current && setFound(null),
    );
    return () => {
      current = false;
    };
  }, [drive, of, count]);
  if (found === null) return null;
  const { record, change } = found;
  const time = record.time.replace("T", " ").slice(0, 19);
  return (
    <p class="small">
      <span class="muted">{t("parameters.last", { time, who: person(record.who, record.claimed_name) })}</span>{" "}
      <bdi>{foreign(change, 200)}</bdi>
    </p>
  );
}

/** Where the parameter stands in the telegram that the drive has selected; nothing where it does not. */
function Place({ of, station }: { of: string; station: Station }) {
  const [layout, setLayout] = useState<TelegramLayout | null>(null);
  useEffect(() => {
    let current = true;
    setLayout(null);
    request<TelegramLayout>(`drives/${encodeURIComponent(station.id)}/layout`).then(
      (read) => current && setLayout(read),
      // without it the details are shown all the same
      () => {},
    );
    return () => {
      current = false;
    };
  }, [station.id, station.status?.telegram]);
  const places = layout?.places.filter(({ parameters }) => parameters.includes(of)) ?? [];
  return (
    <>
      {places.map(({ direction, octet, octets, signal }) => (
        <p key={`${direction} ${octet}`} class="small">
          <span class="muted">{t("parameters.place", { number: layout?.telegram ?? "" })}</span>{" "}
          {t(direction === "setpoint" ? "parameters.place.setpoint" : "parameters.place.actual", {
            octets: octets === 1 ? octet : `${octet}-${octet + octets - 1}`,
            signal: signal ?? t("parameters.place.chosen"),
          })}{" "}
          <a href={address(station.id, "telegram") + location.search}>{t("nav.telegram")}</a>
        </p>
      ))}
    </>
  );
}

/** What is known of a parameter. */
export function Details({ line, station }: { line: edit.Line; station: Station }) {
  const { of } = line;
  const word = edit.values.value.get(line.key)?.value.word;
  return (
    <section class="details">
      <h2>
        <bdi>{foreign(of.name || line.key)}</bdi>
      </h2>
      <p>
        <bdi>{sentence(of.description)}</bdi>
      </p>
      {of.common_names.length > 0 && <p class="muted small">{of.common_names.join(", ")}</p>}
      {of.bits.length > 0 && (
        <ul class="small">
          {of.bits.map((bit) => (
            <li key={bit.value}>
              {bit.value}: <bdi>{foreign(bit.text)}</bdi>
            </li>
          ))}
        </ul>
      )}
      {word && <p class="small">{word.bits.join(", ")}</p>}
      <Place of={of.number} station={station} />
      <LastChange of={of.name || of.number} />
      <Command verb="read" station={station} more={[line.key]} />
      {of.source !== "" && <p class="muted small">{of.source}</p>}
    </section>
  );
}
