import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { useLocation } from "preact-iso";
import type { Station, TelegramTopic } from "../../api";
import { selected } from "../../app/selected";
import { Line } from "../../parts/Command";
import { foreign, label } from "../../parts/format";
import { Loading } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { want } from "../../store/live";
import { now, silent, topics } from "../../store/store";
import { age, t, utc } from "../../text";
import { bits, leaves, octets, telegramOctets } from "./nodes";
import { ReadRecord } from "./ReadRecord";

/** Values older than this are grey, in s. */
const STALE = 3;

type Half = TelegramTopic["halves"][number];

/** The field under the pointer or with the focus: its direction and its octets. */
const marked = signal<{ direction: string; start: number; end: number } | null>(null);

function isMarked(direction: string, start: number, end: number): boolean {
  const mark = marked.value;
  return mark !== null && mark.direction === direction && start < mark.end && end > mark.start;
}

/** The models whose telegrams have words of their own, by what a station calls itself. */
function model(station: Station): string {
  const type = `${station.vendor ?? ""} ${station.type}`.toLowerCase();
  return ["vlt", "vacon"].find((name) => type.includes(name)) ?? "akd";
}

function command(station: Station, telegram: number | null, half: Half): string | null {
  const data = telegramOctets(half.tree, half.octets);
  if (data === null || telegram === null) return null;
  const from = half.direction === "output" ? "controller" : "drive";
  return `profidrive decode --hex ${data} --telegram ${telegram} --from ${from} --model ${model(station)}`;
}

function ms(seconds: number | null | undefined): string {
  return seconds === null || seconds === undefined ? "\u2013" : `${(seconds * 1000).toFixed(3)} ms`;
}

function Timing({ half }: { half: Half }) {
  const { timing, deviations } = half;
  if (timing === null) return null;
  const most = Math.max(1, ...deviations.map(({ frames }) => frames));
  return (
    <div class="timing">
      <dl class="facts">
        <div>
          <dt>{t("telegram.cycle")}</dt>
          <dd class="number">{ms(timing.cycle)}</dd>
        </div>
        <div>
          <dt>{t("telegram.jitter")}</dt>
          <dd class="number">
            {ms(timing.jitter_p50)} / {ms(timing.jitter_p99)}
          </dd>
        </div>
        <div>
          <dt>{t("telegram.gap")}</dt>
          <dd class="number">{ms(timing.longest_gap)}</dd>
        </div>
        <div>
          <dt>{t("telegram.frames")}</dt>
          <dd class="number">{timing.frames}</dd>
        </div>
        <div>
          <dt>{t("telegram.missed")}</dt>
          <dd class={timing.lost > 0 ? "number fault" : "number"}>{timing.lost}</dd>
        </div>
      </dl>
      <table class="histogram">
        <caption class="small muted">{t("telegram.histogram")}</caption>
        <tbody>
          {deviations.map(({ below, frames }) => (
            <tr key={below}>
              <th scope="row" class="number">
                {t("telegram.below", { time: ms(below) })}
              </th>
              <td>
                <svg viewBox="0 0 100 8" aria-hidden="true" preserveAspectRatio="none">
                  <rect width={Math.max(1, (100 * frames) / most)} height="8" />
                </svg>
              </td>
              <td class="number">{frames}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** One direction: its octets, and each field. */
function Direction({ half, telegram, station }: { half: Half; telegram: number | null; station: Station }) {
  const all = octets(half.octets);
  const before = useRef(all);
  const changed = all.map((octet, at) => before.current[at] !== undefined && before.current[at] !== octet);
  useEffect(() => {
    before.current = all;
  });
  const title = t(half.direction === "output" ? "telegram.output" : "telegram.input");
  const line = command(station, telegram, half);
  const mark = (start: number, end: number) => {
    marked.value = { direction: half.direction, start, end };
  };
  const clear = () => {
    marked.value = null;
  };
  return (
    <section class="direction" data-direction={half.direction} data-octets={half.octets}>
      <h2>{title}</h2>
      <p class="octets number">
        {all.map((octet, at) => (
          <span
            // a new key begins the flash again
            key={`${at}${changed[at] ? half.unix_ms : ""}`}
            class={`${changed[at] ? "flash" : ""} ${isMarked(half.direction, at, at + 1) ? "marked" : ""}`}
            onPointerEnter={() => mark(at, at + 1)}
            onPointerLeave={clear}
          >
            {octet}
          </span>
        ))}
      </p>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={title}>
        <table class="fields">
          <caption class="unseen">{title}</caption>
          <thead>
            <tr>
              <th scope="col">{t("telegram.offset")}</th>
              <th scope="col">{t("telegram.field")}</th>
              <th scope="col">{t("telegram.hex")}</th>
              <th scope="col">{t("telegram.bits")}</th>
              <th scope="col">{t("telegram.value")}</th>
            </tr>
          </thead>
          <tbody>
            {leaves(half.tree).map(({ node, path }) => {
              const own = all.slice(node.start, node.end);
              const is = changed.slice(node.start, node.end).some(Boolean);
              return (
                <tr
                  key={`${node.start} ${node.name}`}
                  data-field={node.name}
                  class={isMarked(half.direction, node.start, node.end) ? "marked" : ""}
                  title={path.slice(1).join(" / ")}
                  onPointerEnter={() => mark(node.start, node.end)}
                  onPointerLeave={clear}
                >
                  <td class="number">{node.start}</td>
                  <th scope="row">{foreign(node.name)}</th>
                  <td class={`number ${is ? "flash" : ""}`} key={is ? half.unix_ms : "still"}>
                    {own.length > 8 ? `${own.slice(0, 8).join(" ")} ..` : own.join(" ")}
                  </td>
                  <td class="number">{bits(own)}</td>
                  <td class={node.weight === "error" ? "fault" : node.weight === "warning" ? "warn" : ""}>
                    <bdi>{foreign(node.value, 300)}</bdi>
                  </td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </section>
      {line !== null && <Line text={line} />}
      <Timing half={half} />
    </section>
  );
}

/** The octets of the parameter channel: what they are called, and how many there are. */
const PKW = [
  ["PKE", 2],
  ["IND", 2],
  ["PWE", 4],
] as const;

/** The parameter channel of a telegram that has one: what is requested, and what the drive answers. */
function Channel({ halves }: { halves: readonly Half[] }) {
  const rows = halves.flatMap((half) => {
    const node = leaves(half.tree).find((leaf) => leaf.node.name === "PKW")?.node;
    return node === undefined ? [] : [{ half, node, own: octets(half.octets).slice(node.start, node.end) }];
  });
  if (rows.length === 0) return null;
  return (
    <section class="channel">
      <h2>{t("telegram.pkw")}</h2>
      <table class="fields">
        <caption class="unseen">{t("telegram.pkw")}</caption>
        <thead>
          <tr>
            <th scope="col">{t("telegram.pkw.direction")}</th>
            {PKW.map(([name]) => (
              <th key={name} scope="col">
                {name}
              </th>
            ))}
            <th scope="col">{t("telegram.value")}</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(({ half, node, own }) => (
            <tr key={half.direction} data-pkw={half.direction}>
              <th scope="row">{t(half.direction === "output" ? "telegram.pkw.request" : "telegram.pkw.reply")}</th>
              {PKW.map(([name, length], place) => {
                const from = PKW.slice(0, place).reduce((sum, [, before]) => sum + before, 0);
                return (
                  <td key={name} class="number">
                    {own.slice(from, from + length).join(" ")}
                  </td>
                );
              })}
              <td class={node.weight === "error" ? "fault" : node.weight === "warning" ? "warn" : ""}>
                <bdi>{foreign(node.value, 300)}</bdi>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function Of({ station }: { station: Station }) {
  const { id } = station;
  useEffect(() => want(`drive/${id}/telegram`, 10), [id]);
  const held = topics.value.get(`drive/${id}/telegram`);
  const topic = held?.data as TelegramTopic | undefined;
  const newest = Math.max(0, ...(topic?.halves.map(({ unix_ms }) => unix_ms) ?? []));
  const seconds = held ? (now.value - held.received) / 1000 : 0;
  const ended = topic !== undefined && topic.halves.length > 0 && topic.telegram === null;
  return (
    <article class={silent.value === null && seconds < STALE && !ended ? "telegram" : "telegram stale"}>
      <h1>
        {t("telegram.title")} <bdi>{label(station)}</bdi>
        {topic?.telegram && <span class="muted"> {t("frame.telegram", { number: topic.telegram })}</span>}
      </h1>
      {!topic && <Loading key={id} what={t("loading.frames", { name: label(station) })} count={14} />}
      {topic?.halves.length === 0 && <p>{t("telegram.none")}</p>}
      {ended && <p class="muted">{t("telegram.ended", { time: utc(new Date(newest)) })}</p>}
      {seconds >= STALE && <p class="muted">{t("overview.stale", { age: age(seconds) })}</p>}
      {topic?.halves.map((half) => (
        <Direction key={half.direction} half={half} telegram={topic.telegram} station={station} />
      ))}
      {topic && <Channel halves={topic.halves} />}
      <ReadRecord key={id} id={id} />
    </article>
  );
}

export function Telegram() {
  const { path } = useLocation();
  const station = selected(path);
  if (!station) {
    return <Nothing title={t("telegram.title")} select={t("telegram.select")} />;
  }
  return <Of station={station} />;
}
