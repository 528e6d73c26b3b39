import { useEffect, useState } from "preact/hooks";
import { type LogPage, type LogTopic, request, type Station } from "../../api";
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
      <span class="muted">{t("parameters.last", { time, who: person(record.who) })}</span>{" "}
      <bdi>{foreign(change, 200)}</bdi>
    </p>
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
      <LastChange of={of.name || of.number} />
      <Command verb="read" station={station} more={[line.key]} />
      {of.source !== "" && <p class="muted small">{of.source}</p>}
    </section>
  );
}
