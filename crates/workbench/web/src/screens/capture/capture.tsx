import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import {
  type CaptureReport,
  type Captures,
  type EventPage,
  type FrameNode,
  type FramePage,
  type FrameReport,
  request,
} from "../../api";
import { foreign, sentence } from "../../parts/format";
import { Icon } from "../../parts/Icon";
import { server } from "../../store/store";
import { t } from "../../text";
import { octets } from "../telegram/nodes";

/** Rows of a page. */
const ROWS = 100;
/** Time between two looks at a capture that is read, in ms. */
const LOOK = 300;
/** The largest capture, in octets, and the time for it, in ms. */
const LARGEST = 256 * 2 ** 20;
const UPLOAD = 300_000;
/** States that the time line shows. */
const STATES = 1000;

const captures = signal<CaptureReport[]>([]);
const current = signal<CaptureReport | null>(null);
const view = signal<"events" | "frames">("events");
const filter = signal({ trouble: false, device: "", begin: "", end: "" });
const from = signal(0);
const events = signal<EventPage | null>(null);
const frames = signal<FramePage | null>(null);
const states = signal<EventPage["events"]>([]);
const frame = signal<FrameReport | null>(null);
const range = signal<[number, number]>([0, 0]);
const failure = signal("");
const sending = signal("");
const wantedFrame = signal("");

async function tried(work: () => Promise<void>): Promise<void> {
  try {
    failure.value = "";
    await work();
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
}

async function list(): Promise<void> {
  captures.value = (await request<Captures>("captures")).captures;
}

/** Shows a capture, again and again until it was read. */
async function open(id: number): Promise<void> {
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

async function load(): Promise<void> {
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

async function upload(file: File): Promise<void> {
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

async function show(number: number): Promise<void> {
  const id = current.value?.id;
  if (id === undefined) return;
  await tried(async () => {
    frame.value = await request<FrameReport>(`captures/${id}/frames/${number}`);
    range.value = [0, 0];
  });
}

function change(more: Partial<typeof filter.value>): void {
  filter.value = { ...filter.value, ...more };
  from.value = 0;
  void tried(load);
}

function ms(seconds: number | null): string {
  return seconds === null ? "\u2013" : (seconds * 1000).toFixed(3);
}

function Devices({ capture }: { capture: CaptureReport }) {
  if (capture.devices.length === 0) return null;
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
    <section class="scroll" tabIndex={0} aria-label={t("capture.devices")}>
      <table>
        <caption class="unseen">{t("capture.devices")}</caption>
        <thead>
          <tr>
            <th scope="col">{t("capture.device")}</th>
            <th scope="col">{t("capture.direction")}</th>
            <th scope="col">{t("capture.frames")}</th>
            <th scope="col">{t("capture.cycle")}</th>
            <th scope="col">{t("capture.jitter")}</th>
            <th scope="col">{t("telegram.missed")}</th>
            <th scope="col">{t("capture.gap")}</th>
            <th scope="col">{t("capture.losses")}</th>
            <th scope="col">{t("capture.faults")}</th>
          </tr>
        </thead>
        <tbody>
          {capture.devices.flatMap((device) =>
            device.streams.map((stream, number) => (
              <tr key={`${device.mac}${number}`}>
                <th scope="row">
                  <bdi>{foreign(device.device)}</bdi>
                </th>
                <td>{stream.direction}</td>
                <td class="number">{stream.frames}</td>
                <td class="number">{ms(stream.cycle)}</td>
                <td class="number">{ms(stream.jitter_p99)}</td>
                <td class={stream.lost > 0 ? "number fault" : "number"}>{stream.lost}</td>
                <td class="number">{ms(stream.longest_gap)}</td>
                <td class={device.connection_losses > 0 ? "number fault" : "number"}>{device.connection_losses}</td>
                <td class={device.faults > 0 ? "number fault" : "number"}>{device.faults}</td>
              </tr>
            )),
          )}
        </tbody>
      </table>
    </section>
  );
}

const ROWS_OF_STATES = ["S4", "S3", "S5", "S2", "S1"];

/** The states of the drives over the time of the capture, with what points to a fault. */
function Timeline({ capture }: { capture: CaptureReport }) {
  const drives = [...new Set(states.value.flatMap(({ drive }) => (drive === null ? [] : [drive])))].slice(0, 8);
  if (drives.length === 0 || capture.lasts === 0) return null;
  const x = (time: number) => (time / capture.lasts) * 600;
  return (
    <section>
      <h2>{t("capture.timeline")}</h2>
      {drives.map((drive) => {
        const own = states.value.filter((one) => one.drive === drive);
        const y = (state: string | null) => 6 + Math.max(0, ROWS_OF_STATES.indexOf(state ?? "S1")) * 12;
        const points = own.flatMap((one, number) => {
          const end = own[number + 1]?.time ?? capture.lasts;
          return [`${x(one.time)},${y(one.state)}`, `${x(end)},${y(one.state)}`];
        });
        const name = capture.devices.find(({ mac }) => mac === drive)?.device ?? drive;
        return (
          <div key={drive} class="lane">
            <p class="small">
              <bdi>{foreign(name)}</bdi>{" "}
              <span class="muted">
                {t("capture.states", {
                  list: own
                    .slice(-6)
                    .map(({ state }) => state)
                    .join(" "),
                })}
              </span>
            </p>
            <svg class="timeline" viewBox="-28 0 636 64" aria-hidden="true">
              {ROWS_OF_STATES.map((state) => (
                <g key={state}>
                  <path class="grid" d={`M0 ${y(state)}H600`} />
                  <text x="-24" y={y(state) + 4}>
                    {state}
                  </text>
                </g>
              ))}
              <polyline points={points.join(" ")} />
              {own
                .filter(({ trouble }) => trouble)
                .map((one) => (
                  <path key={one.frame} class="mark" d={`M${x(one.time)} 0V64`} />
                ))}
            </svg>
          </div>
        );
      })}
    </section>
  );
}

function Filters({ capture }: { capture: CaptureReport }) {
  const { trouble, device, begin, end } = filter.value;
  return (
    <p class="filters">
      <label class="check">
        <input
          type="checkbox"
          checked={trouble}
          disabled={view.value === "frames"}
          onChange={(event) => change({ trouble: event.currentTarget.checked })}
        />
        {t("capture.trouble")}
      </label>
      <label>
        <span class="muted small">{t("capture.device")}</span>
        <select
          value={device}
          disabled={view.value === "frames"}
          onChange={(event) => change({ device: event.currentTarget.value })}
        >
          <option value="">{t("log.all")}</option>
          {capture.devices.map((one) => (
            <option key={one.mac} value={one.mac}>
              {foreign(one.device)}
            </option>
          ))}
        </select>
      </label>
      <label>
        <span class="muted small">{t("capture.begin")}</span>
        <input
          inputMode="decimal"
          value={begin}
          disabled={view.value === "frames"}
          onChange={(event) => change({ begin: event.currentTarget.value })}
        />
      </label>
      <label>
        <span class="muted small">{t("capture.end")}</span>
        <input
          inputMode="decimal"
          value={end}
          disabled={view.value === "frames"}
          onChange={(event) => change({ end: event.currentTarget.value })}
        />
      </label>
      <label>
        <span class="muted small">{t("capture.view")}</span>
        <select
          value={view.value}
          onChange={(event) => {
            view.value = event.currentTarget.value === "frames" ? "frames" : "events";
            from.value = 0;
            void tried(load);
          }}
        >
          <option value="events">{t("capture.events")}</option>
          <option value="frames">{t("capture.all")}</option>
        </select>
      </label>
      <form
        onSubmit={(submit) => {
          submit.preventDefault();
          const number = Number(wantedFrame.value);
          if (Number.isInteger(number) && number > 0) void show(number);
        }}
      >
        <label>
          <span class="muted small">{t("capture.number")}</span>
          <input
            inputMode="numeric"
            value={wantedFrame.value}
            onInput={(event) => {
              wantedFrame.value = event.currentTarget.value;
            }}
          />
        </label>
        <button type="submit">{t("capture.show")}</button>
      </form>
    </p>
  );
}

interface Line {
  frame: number;
  time: number;
  from: string;
  to: string;
  text: string;
  tone: string;
}

function lines(): { all: Line[]; total: number } {
  if (view.value === "frames") {
    const page = frames.value;
    const rows = page?.frames.map((row) => ({
      ...row,
      from: row.source,
      to: row.destination,
      text: row.text || t("capture.plain", { length: row.length }),
      tone: row.text ? "" : "muted",
    }));
    return { all: rows ?? [], total: page?.total ?? 0 };
  }
  const page = events.value;
  const rows = page?.events.map((row) => ({
    ...row,
    text: `${row.topic}: ${row.text}`,
    tone: row.weight === "error" ? "fault" : row.trouble ? "warn" : "",
  }));
  return { all: rows ?? [], total: page?.total ?? 0 };
}

function Rows() {
  const { all, total } = lines();
  const turn = (step: number) => {
    from.value = Math.max(0, from.value + step);
    void tried(load);
  };
  return (
    <section class="capture-rows">
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("capture.list")}>
        <table>
          <caption class="unseen">{t("capture.list")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("capture.frame")}</th>
              <th scope="col">{t("capture.time")}</th>
              <th scope="col">{t("machine.from")}</th>
              <th scope="col">{t("machine.to")}</th>
              <th scope="col">{t("log.result")}</th>
            </tr>
          </thead>
          <tbody>
            {all.map((row, number) => (
              <tr key={`${row.frame} ${number}`} class={frame.value?.frame === row.frame ? "chosen" : ""}>
                <td class="number">
                  <button type="button" class="plain" onClick={() => void show(row.frame)}>
                    {row.frame}
                  </button>
                </td>
                <td class="number">{row.time.toFixed(6)}</td>
                <td>
                  <bdi>{foreign(row.from, 40)}</bdi>
                </td>
                <td>
                  <bdi>{foreign(row.to, 40)}</bdi>
                </td>
                <td class={`long ${row.tone}`}>
                  <bdi>{sentence(row.text)}</bdi>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </section>
      <p class="buttons">
        <button type="button" disabled={from.value === 0} onClick={() => turn(-ROWS)}>
          {t("capture.before")}
        </button>
        <button type="button" disabled={from.value + ROWS >= total} onClick={() => turn(ROWS)}>
          {t("capture.after")}
        </button>
        <span class="muted small">
          {t("capture.page", { first: total === 0 ? 0 : from.value + 1, last: from.value + all.length, total })}
        </span>
      </p>
    </section>
  );
}

function Field({ node, depth }: { node: FrameNode; depth: number }) {
  const [start, end] = range.value;
  const chosen = start === node.start && end === node.end;
  return (
    <>
      <li class={`depth-${Math.min(depth, 8)}`}>
        <button
          type="button"
          class="plain"
          aria-pressed={chosen}
          data-field={node.name}
          onClick={() => {
            range.value = [node.start, node.end];
          }}
        >
          <span class={node.weight === "error" ? "fault" : node.weight === "warning" ? "warn" : ""}>
            {foreign(node.name)}
          </span>{" "}
          <bdi class="muted">{foreign(node.value, 300)}</bdi>
        </button>
      </li>
      {node.children?.map((child, number) => (
        <Field key={number} node={child} depth={depth + 1} />
      ))}
    </>
  );
}

function Frame({ shown }: { shown: FrameReport }) {
  const all = octets(shown.octets);
  const [start, end] = range.value;
  return (
    <section class="one-frame">
      <h2>
        {t("capture.one", { number: shown.frame })}
        <span class="muted small number">{shown.time.toFixed(6)} s</span>
      </h2>
      {shown.texts.map((text) => (
        <p key={text}>
          <bdi>{sentence(text)}</bdi>
        </p>
      ))}
      <div class="frame-columns">
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
        <ul class="tree" tabIndex={0} aria-label={t("capture.tree")}>
          <Field node={shown.tree} depth={0} />
        </ul>
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
        <section class="hex number" tabIndex={0} aria-label={t("capture.octets")}>
          {Array.from({ length: Math.ceil(all.length / 16) }, (_, line) => (
            <p key={line}>
              <span class="muted">{(line * 16).toString(16).toUpperCase().padStart(4, "0")}</span>{" "}
              {all.slice(line * 16, line * 16 + 16).map((octet, column) => {
                const at = line * 16 + column;
                return (
                  <span key={column} class={at >= start && at < end ? "octet marked" : "octet"}>
                    {octet}
                  </span>
                );
              })}
            </p>
          ))}
        </section>
      </div>
    </section>
  );
}

/** Captures explained: what happened, each field of a frame, and its octets. */
export function Capture() {
  useEffect(() => void tried(list), []);
  const capture = current.value;
  const may = server.value?.role === "control" && sending.value === "";
  return (
    <article
      class="capture"
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file && may) void upload(file);
      }}
    >
      <div class="title">
        <h1>{t("capture.title")}</h1>
        <label class="button">
          <input
            type="file"
            class="unseen"
            accept=".pcap,.pcapng,.cap"
            disabled={!may}
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              if (file) void upload(file);
              event.currentTarget.value = "";
            }}
          />
          {t("capture.upload")}
        </label>
        {captures.value.length > 0 && (
          <label>
            <span class="muted small">{t("capture.kept")}</span>
            <select
              value={capture?.id ?? ""}
              onChange={(event) => void tried(() => open(Number(event.currentTarget.value)))}
            >
              <option value="" disabled hidden>
                {t("capture.choose")}
              </option>
              {captures.value.map((one) => (
                <option key={one.id} value={one.id}>
                  {t("capture.option", { id: one.id, frames: one.counts.frames })}
                </option>
              ))}
            </select>
          </label>
        )}
      </div>
      <p class="muted">{t(server.value?.role === "control" ? "capture.private" : "capture.only")}</p>
      {sending.value !== "" && <p role="status">{t("capture.sending", { name: foreign(sending.value) })}</p>}
      {failure.value !== "" && (
        <p class="fault" role="alert">
          <Icon name="cross" /> <bdi>{sentence(failure.value)}</bdi>
        </p>
      )}
      {capture && (
        <>
          <p role="status" data-frames={capture.ended ? capture.counts.frames : ""}>
            {t(capture.ended ? "capture.ended" : "capture.reading", {
              frames: capture.counts.frames,
              lasts: capture.lasts.toFixed(3),
              events: capture.events,
            })}
          </p>
          {capture.error !== null && (
            <p class="warn">
              <Icon name="triangle" /> <bdi>{sentence(capture.error)}</bdi>
            </p>
          )}
          {capture.left_out > 0 && <p class="muted">{t("capture.left", { count: capture.left_out })}</p>}
          <Devices capture={capture} />
          {capture.ended && <Timeline capture={capture} />}
          {capture.ended && <Filters capture={capture} />}
          {capture.ended && <Rows />}
          {frame.value && <Frame shown={frame.value} />}
        </>
      )}
    </article>
  );
}
