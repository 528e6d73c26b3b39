import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { type MachineTopic, request, type StateMachine, type Station } from "../../api";
import { selected } from "../../app/selected";
import { foreign, label, sentence } from "../../parts/format";
import { Icon } from "../../parts/Icon";
import { Bars, Waits } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { want } from "../../store/live";
import { now, silent, topics } from "../../store/store";
import { age, t, utc } from "../../text";
import { conditions } from "../overview/conditions";
import { curve, edges, HEIGHT, lines, place, SIZE, type State, WIDTH } from "./diagram";

/** Values older than this are grey, in s. */
const STALE = 3;
/** What the time line shows, in ms. */
const SPAN = 60_000;
/** Changes in the list below it. */
const LISTED = 12;

/** The table of the profile; it is the same for all drives. */
const table = signal<StateMachine | null>(null);
const failure = signal("");

async function load(): Promise<void> {
  if (table.value !== null) return;
  try {
    table.value = await request<StateMachine>("state-machine");
    failure.value = "";
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
}

function time(unixMs: number): string {
  return utc(new Date(unixMs), 3);
}

function Diagram({ machine, active, next }: { machine: StateMachine; active: State | null; next: State | null }) {
  return (
    <svg class="diagram" viewBox={`0 0 ${SIZE.width} ${SIZE.height}`} aria-hidden="true">
      <defs>
        <marker
          id="arrow"
          viewBox="0 0 8 8"
          refX="7"
          refY="4"
          markerWidth="8"
          markerHeight="8"
          markerUnits="userSpaceOnUse"
          orient="auto-start-reverse"
        >
          <path d="M0 0L8 4L0 8z" />
        </marker>
        <marker
          id="arrow-awaited"
          viewBox="0 0 8 8"
          refX="7"
          refY="4"
          markerWidth="10"
          markerHeight="10"
          markerUnits="userSpaceOnUse"
          orient="auto-start-reverse"
        >
          <path d="M0 0L8 4L0 8z" />
        </marker>
      </defs>
      {edges(machine).map((edge) => {
        const { path, x, y } = curve(edge);
        const awaited = edge.from === active && edge.to === next;
        return (
          <g
            key={`${edge.from}${edge.to}`}
            class={awaited ? "edge awaited" : "edge"}
            data-edge={`${edge.from} ${edge.to}`}
          >
            <path d={path} marker-end={awaited ? "url(#arrow-awaited)" : "url(#arrow)"} />
            <text x={x} y={y}>
              {edge.reasons.join(" ")}
            </text>
          </g>
        );
      })}
      {machine.states.map(({ state, name }) => {
        const [x, y] = place(state);
        return (
          <g key={state} class={state === active ? "node active" : "node"} data-state={state}>
            <rect x={x - WIDTH / 2} y={y - HEIGHT / 2} width={WIDTH} height={HEIGHT} rx="4" />
            <text class="name" x={x} y={y - 12}>
              {state}
            </text>
            {lines(name).map((line, place) => (
              <text key={line} class="words" x={x} y={y + 6 + place * 15}>
                {line}
              </text>
            ))}
          </g>
        );
      })}
    </svg>
  );
}

/** The diagram in words. */
function Twin({ machine, active }: { machine: StateMachine; active: State | null }) {
  return (
    <details>
      <summary>{t("machine.twin")}</summary>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("machine.twin")}>
        <table class="twin">
          <caption class="unseen">{t("machine.twin")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("machine.from")}</th>
              <th scope="col">{t("machine.to")}</th>
              <th scope="col">{t("machine.transition")}</th>
              <th scope="col">{t("machine.when")}</th>
            </tr>
          </thead>
          <tbody>
            {machine.transitions.map((row, number) => {
              const bits = row.bits.map(({ bit, name, value }) => `STW1.${bit} ${name} = ${value ? 1 : 0}`);
              return (
                <tr key={number} data-edge={`${row.from} ${row.to}`} class={row.from === active ? "chosen" : ""}>
                  <td>{row.from}</td>
                  <td>{row.to}</td>
                  <td>
                    {row.reason} {row.text}
                  </td>
                  <td class="number">{[...bits, ...row.also].join(", ")}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </section>
    </details>
  );
}

/** What has to be so that the drive goes on. */
function Next({ station, topic }: { station: Station; topic: MachineTopic }) {
  const { awaited, missing } = topic.machine;
  const held = station.status?.verdict === "held";
  // a fault stands in the sentence already
  const fault = t("condition.fault");
  const against = station.status
    ? conditions(station.status, null).filter(({ met, name }) => met === false && !(held && name === fault))
    : [];
  if (awaited === null) return <p class="muted">{t("machine.none")}</p>;
  return (
    <>
      <p>{t("machine.awaited", { to: awaited.to, reason: awaited.reason, text: awaited.text })}</p>
      <ul class="conditions awaited">
        {held && station.status && (
          <li>
            <Icon name="square" tone="accent" />
            <bdi class="accent">{sentence(station.status.sentence)}</bdi>
          </li>
        )}
        {against.map(({ name, value }) => (
          <li key={name}>
            <Icon name="square" tone="accent" />
            <span class="accent">{name}</span>
            <bdi class="muted">{foreign(value)}</bdi>
          </li>
        ))}
        {missing.map(({ bit, name, value, meaning }) => (
          <li key={bit}>
            <Icon name="square" tone="accent" />
            <span class="accent">{t("machine.bit", { bit, name, value: value ? 1 : 0, meaning })}</span>
            <span class="muted">{t("machine.bit.is", { value: value ? 0 : 1 })}</span>
          </li>
        ))}
        {awaited.also.map((text) => (
          <li key={text}>
            <Icon name="dash" tone="muted" />
            <span>{text}</span>
          </li>
        ))}
      </ul>
      {against.length === 0 && station.status && station.status.verdict === "waits" && (
        <p class="muted">
          <bdi>{sentence(station.status.sentence)}</bdi>
        </p>
      )}
    </>
  );
}

/** Returns the name of a bit, which may break behind its underscores only. */
function breakable(name: string) {
  return name.split(/(?<=_)/).flatMap((part, place) => (place === 0 ? [part] : [<wbr key={part} />, part]));
}

type Strip = MachineTopic["machine"]["words"][number];

function Word({ strip, live }: { strip: Strip; live: boolean }) {
  const bits = [...strip.word.bits].reverse();
  const by = t(strip.writer === "controller" ? "machine.controller" : "machine.drive");
  const title = `${strip.name} ${live ? strip.word.hex : "\u2013"}`;
  return (
    <section>
      <h3>
        <span class="number">{title}</span>
        <span class="muted small">
          {by} · {strip.profile}
        </span>
      </h3>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={title}>
        <table class="strip" data-word={strip.name}>
          <caption class="unseen">{title}</caption>
          <thead>
            <tr>
              {bits.map(({ bit }) => (
                <th key={bit} scope="col" class="number">
                  {bit}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            <tr>
              {bits.map(({ bit, name, meaning, set }) => (
                <td key={bit} class={live && set ? "set" : ""} title={meaning}>
                  <span class="cell-name">{breakable(name)}</span>
                  <span class="cell-value number">{live ? (set ? "1" : "0") : "\u2013"}</span>
                </td>
              ))}
            </tr>
          </tbody>
        </table>
      </section>
    </section>
  );
}

const ROWS: State[] = ["S5", "S4", "S3", "S2", "S1"];

/** Width of the time line. */
const LENGTH = 400;

/** The states of the last minute. */
function Timeline({ topic }: { topic: MachineTopic }) {
  const { changes, unix_ms } = topic;
  const x = (ms: number) => Math.max(0, LENGTH + ((ms - unix_ms) / SPAN) * LENGTH);
  const y = (state: State | null) => (state === null ? 106 : 10 + ROWS.indexOf(state) * 20);
  const points = changes.flatMap((change, number) => {
    const end = changes[number + 1]?.unix_ms ?? unix_ms;
    return [`${x(change.unix_ms)},${y(change.state)}`, `${x(end)},${y(change.state)}`];
  });
  const listed = changes.slice(-LISTED);
  return (
    <section>
      <h2>{t("machine.timeline")}</h2>
      <svg class="timeline" viewBox={`-28 0 ${LENGTH + 44} 128`} aria-hidden="true">
        {ROWS.map((state) => (
          <g key={state}>
            <path class="grid" d={`M0 ${y(state)}H${LENGTH}`} />
            <text x="-24" y={y(state) + 4}>
              {state}
            </text>
          </g>
        ))}
        {[60, 45, 30, 15, 0].map((seconds) => (
          <text key={seconds} class="at" x={LENGTH - (seconds * LENGTH) / 60} y="124">
            {seconds === 0 ? "0 s" : `\u2212${seconds}`}
          </text>
        ))}
        <polyline points={points.join(" ")} />
      </svg>
      <ol class="changes-of-state">
        {listed.map((change) => (
          <li key={change.unix_ms} data-state={change.state ?? ""}>
            <time class="number muted">{time(change.unix_ms)}</time> <b>{change.state ?? t("machine.unknown")}</b>{" "}
            <span class="number muted">
              {change.stw1 && `STW1 ${change.stw1}`} {change.zsw1 && `ZSW1 ${change.zsw1}`}
            </span>
          </li>
        ))}
      </ol>
    </section>
  );
}

function Of({ station }: { station: Station }) {
  const { id } = station;
  useEffect(() => {
    void load();
    return want(`drive/${id}/machine`, 10);
  }, [id]);
  const held = topics.value.get(`drive/${id}/machine`);
  const topic = held?.data as MachineTopic | undefined;
  const machine = table.value;
  const seconds = held ? (now.value - held.received) / 1000 : 0;
  const live = silent.value === null;
  const active = (live && topic?.machine.state) || null;
  const name = machine?.states.find(({ state }) => state === active)?.name;
  const last = topic?.changes.at(-1);
  return (
    <article class={live && seconds < STALE ? "machine" : "machine stale"}>
      <h1>
        {t("machine.title")} <bdi>{label(station)}</bdi>
      </h1>
      {failure.value !== "" && <p class="fault">{failure.value}</p>}
      <div class="machine-columns">
        <section>
          <p class="machine-state">
            {active === null ? (
              t("machine.unknown")
            ) : (
              <>
                <b>{active}</b> {name}
              </>
            )}
            {last && topic && (
              <span class="muted small">
                {t("machine.since", { time: time(last.unix_ms) })} ·{" "}
                {t(topic.source === "frames" ? "machine.frames" : "machine.parameters")}
                {seconds >= STALE && ` · ${t("overview.stale", { age: age(seconds) })}`}
              </span>
            )}
          </p>
          {!topic && <Waits key={id} what={t("loading.words", { name: label(station) })} />}
          {!machine && <Bars count={1} height={308} />}
          {machine && <Diagram machine={machine} active={active} next={topic?.machine.awaited?.to ?? null} />}
          {machine && <Twin machine={machine} active={active} />}
        </section>
        <div>
          <section>
            <h2>{t("machine.next")}</h2>
            {topic ? <Next station={station} topic={topic} /> : <Bars count={2} />}
          </section>
          {!topic && <Bars count={4} />}
          {topic && <Timeline topic={topic} />}
        </div>
      </div>
      {topic?.machine.words.map((strip) => (
        <Word key={`${strip.name}${strip.profile}`} strip={strip} live={live} />
      ))}
    </article>
  );
}

export function Machine() {
  const { path } = useLocation();
  const station = selected(path);
  if (!station) {
    return <Nothing title={t("machine.title")} select={t("machine.select")} />;
  }
  return <Of station={station} />;
}
