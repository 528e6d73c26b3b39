import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { takesText } from "../../app/keys";
import { selected, selectedId } from "../../app/selected";
import { foreign, label, sentence } from "../../parts/format";
import { Nothing } from "../../parts/Nothing";
import { owner } from "../../parts/Reason";
import type { Mode, Trigger } from "../../scope/acquisition";
import type { Column, Header } from "../../scope/block";
import type { Condition } from "../../scope/trigger";
import * as scope from "../../store/scope";
import { silent } from "../../store/store";
import { t } from "../../text";
import { bitName, Plot, penOf, png } from "./Plot";

const dash = "\u2013";
/** Time between `g` and the letter of a screen, in ms. */
const SEQUENCE = 1000;

function number(value: number | undefined, unit: string): string {
  if (value === undefined || !Number.isFinite(value)) return dash;
  const text = value.toFixed({ rpm: 1, rev: 4, "%": 1 }[unit] ?? (Number.isInteger(value) ? 0 : 3));
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

/** Returns a time in words: `20 ms`, `1.5 s`. */
function time(us: number): string {
  const ms = us / 1000;
  const text = Math.abs(ms) < 1000 ? `${Number(ms.toFixed(3))} ms` : `${Number((ms / 1000).toFixed(4))} s`;
  return text.replace("-", "\u2212");
}

/** Where the values come from, and how many there really are. */
function sourceText(header: Header | null, rate: number | null): string {
  const hertz = rate === null ? dash : rate.toFixed(1);
  switch (header?.source) {
    case "cyclic":
      return t("scope.source.cyclic", { ms: header.period_us / 1000, hertz, telegram: header.telegram ?? dash });
    case "acyclic":
      return t("scope.source.acyclic", { hertz });
    case "file":
      return t("scope.source.file");
    case "test":
      return t("scope.source.test", { hertz });
    default:
      return t("scope.source.none");
  }
}

function Select<T extends string>({
  title,
  value,
  options,
  disabled,
  onChange,
}: {
  title: string;
  value: T;
  options: readonly (readonly [T, string])[];
  disabled?: boolean;
  onChange: (value: T) => void;
}) {
  return (
    <label class="field">
      <span>{title}</span>
      <select value={value} disabled={disabled ?? false} onChange={(event) => onChange(event.currentTarget.value as T)}>
        {options.map(([key, text]) => (
          <option key={key} value={key}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

function Check({
  checked,
  disabled,
  onChange,
  children,
}: {
  checked: boolean;
  disabled?: boolean;
  onChange: (on: boolean) => void;
  children: ComponentChildren;
}) {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={checked}
        disabled={disabled ?? false}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
      <span>{children}</span>
    </label>
  );
}

/** A line as a signal is drawn. */
function Pen({ place }: { place: number }) {
  const { colour, dash } = penOf(place);
  return (
    <svg width="20" height="8" viewBox="0 0 20 8" aria-hidden="true">
      <path d="M0 4H20" stroke={colour} stroke-width="2" stroke-dasharray={dash.join(" ")} />
    </svg>
  );
}

function toggle(key: string, on: boolean): void {
  const { signals } = scope.layout.value;
  scope.change({ signals: on ? [...signals, key] : signals.filter((one) => one !== key) });
}

function SignalCheck({ id, column, bit, name }: { id: string; column: Column; bit: number | null; name: string }) {
  const { signals } = scope.layout.value;
  const on = signals.includes(id);
  const place = scope.chosen().findIndex((one) => one.column.name === column.name && one.bit === bit);
  return (
    <Check checked={on} disabled={!on && signals.length >= scope.MOST_SIGNALS} onChange={(now) => toggle(id, now)}>
      <bdi>{foreign(name)}</bdi> {column.unit !== "" && <span class="unit">{column.unit}</span>}{" "}
      {on && place >= 0 && <Pen place={place} />}
    </Check>
  );
}

/** The name of a column, and the parameter that it is read from. */
function titleOf({ name, from }: Column): string {
  if (from === null) return name;
  return from.startsWith(name) ? from : `${name}, ${from}`;
}

function Signals({ header }: { header: Header | null }) {
  const wanted = useSignal("");
  const { parameters } = scope.layout.value;
  const columns = header?.columns ?? [];
  const numbers = columns.filter((column) => column.type !== "u32");
  const words = columns.filter((column) => column.type === "u32");
  const add = (event: Event) => {
    event.preventDefault();
    const name = wanted.value.trim();
    if (name === "" || parameters.includes(name)) return;
    const { signals } = scope.layout.value;
    scope.change({ parameters: [...parameters, name], signals: [...signals, name].slice(0, scope.MOST_SIGNALS) });
    wanted.value = "";
  };
  return (
    <section aria-label={t("scope.signals")}>
      <h2>{t("scope.signals")}</h2>
      {numbers.map((column) => (
        <SignalCheck key={column.name} id={scope.keyOf(column)} column={column} bit={null} name={titleOf(column)} />
      ))}
      {words.map((column) => (
        <details key={column.name}>
          <summary>{t("scope.bits", { name: foreign(column.name) })}</summary>
          {Array.from({ length: 16 }, (_, bit) => (
            <SignalCheck
              key={bitName(column, bit) + String(bit)}
              id={`${scope.keyOf(column)}.${bit}`}
              column={column}
              bit={bit}
              name={`${bit} ${column.bits?.[bit] ?? ""}`}
            />
          ))}
        </details>
      ))}
      {header?.source !== "test" && header?.source !== "file" && (
        <form onSubmit={add}>
          <label class="field">
            <span>{t("scope.parameter")}</span>
            <input
              value={wanted.value}
              autocomplete="off"
              spellcheck={false}
              disabled={parameters.length >= 16}
              onInput={(event) => {
                wanted.value = event.currentTarget.value;
              }}
            />
          </label>
          <button type="submit" disabled={wanted.value.trim() === "" || parameters.length >= 16}>
            {t("scope.parameter.add")}
          </button>
        </form>
      )}
      {parameters.length > 0 && (
        <ul>
          {parameters.map((name) => {
            const why = header?.refused.find(([refused]) => refused === name)?.[1];
            return (
              <li key={name}>
                <button
                  type="button"
                  onClick={() => {
                    scope.change({
                      parameters: parameters.filter((one) => one !== name),
                      signals: scope.layout.value.signals.filter((one) => one !== name),
                    });
                  }}
                >
                  {t("scope.parameter.remove", { name: foreign(name) })}
                </button>
                {why !== undefined && <bdi class="fault small">{sentence(why)}</bdi>}
              </li>
            );
          })}
        </ul>
      )}
      {header?.source === "cyclic" && parameters.length > 0 && <p class="muted small">{t("scope.parameter.cyclic")}</p>}
    </section>
  );
}

function TriggerChoice({ header }: { header: Header | null }) {
  const { trigger } = scope.layout.value;
  const { condition } = trigger;
  const set = (more: Partial<Trigger>) => scope.change({ trigger: { ...trigger, ...more } });
  const columns = header?.columns ?? [];
  const numbers = columns.filter((column) => column.type !== "u32");
  const words = columns.filter((column) => column.type === "u32");
  const first = (all: Column[]) => (all[0] ? scope.keyOf(all[0]) : "@speed");
  const kinds: readonly (readonly [Condition["kind"], string])[] = [
    ["edge", t("scope.trigger.edge")],
    ["bit", t("scope.trigger.bit")],
    ["fault", t("scope.trigger.fault")],
    ["change", t("scope.trigger.change")],
  ];
  const change = (kind: Condition["kind"]) => {
    if (kind === "edge") set({ condition: { kind, signal: first(numbers), edge: "rising", level: 10 } });
    else if (kind === "bit") set({ condition: { kind, signal: first(words), bit: 2, edge: "rising" } });
    else if (kind === "fault") set({ condition: { kind } });
    else set({ condition: { kind, role: "speed_set" } });
  };
  const names = (all: Column[]) => all.map((column) => [scope.keyOf(column), foreign(column.name)] as const);
  return (
    <section aria-label={t("scope.trigger")}>
      <h2>{t("scope.trigger")}</h2>
      <Select<Mode>
        title={t("scope.mode")}
        value={trigger.mode === "single" ? "off" : trigger.mode}
        options={(["off", "auto", "normal"] as const).map((mode) => [mode, t(`scope.mode.${mode}`)])}
        onChange={(mode) => set({ mode })}
      />
      <Select title={t("scope.trigger.on")} value={condition.kind} options={kinds} onChange={change} />
      {condition.kind === "edge" && (
        <>
          <Select
            title={t("scope.trigger.signal")}
            value={condition.signal}
            options={names(numbers)}
            onChange={(signal) => set({ condition: { ...condition, signal } })}
          />
          <label class="field">
            <span>{t("scope.trigger.level")}</span>
            <input
              type="number"
              step="any"
              value={condition.level}
              onChange={(event) => {
                const level = event.currentTarget.valueAsNumber;
                if (Number.isFinite(level)) set({ condition: { ...condition, level } });
              }}
            />
          </label>
        </>
      )}
      {condition.kind === "bit" && (
        <>
          <Select
            title={t("scope.trigger.signal")}
            value={condition.signal}
            options={names(words)}
            onChange={(signal) => set({ condition: { ...condition, signal } })}
          />
          <Select
            title={t("scope.trigger.bit")}
            value={String(condition.bit)}
            options={Array.from({ length: 16 }, (_, bit) => {
              const column = scope.find(header, condition.signal)?.column;
              return [String(bit), `${bit} ${column?.bits?.[bit] ?? ""}`] as const;
            })}
            onChange={(bit) => set({ condition: { ...condition, bit: Number(bit) } })}
          />
        </>
      )}
      {(condition.kind === "edge" || condition.kind === "bit") && (
        <Select
          title={t("scope.trigger.direction")}
          value={condition.edge}
          options={(["rising", "falling", "either"] as const).map((edge) => [edge, t(`scope.edge.${edge}`)])}
          onChange={(edge) => set({ condition: { ...condition, edge } })}
        />
      )}
      <Select
        title={t("scope.pre")}
        value={String(trigger.pre)}
        options={[0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9].map((pre) => [
          String(pre),
          t("scope.percent", { value: Math.round(pre * 100) }),
        ])}
        onChange={(pre) => set({ pre: Number(pre) })}
      />
    </section>
  );
}

/** What is measured, as a table: for people who do not see the picture too. */
function Measures() {
  const frame = scope.shown.value;
  const cursors = scope.cursors.value;
  const marks = frame?.cursors ?? null;
  const between = marks === null ? null : marks[1] - marks[0];
  const signals = scope.chosen();
  return (
    <div class="scroll">
      <table>
        <caption>
          {between === null
            ? t("scope.table", { time: time((frame?.view.to ?? 0) - (frame?.view.from ?? 0)) })
            : t("scope.table.cursors", {
                a: time((marks?.[0] ?? 0) - (frame?.zero ?? 0)),
                b: time((marks?.[1] ?? 0) - (frame?.zero ?? 0)),
                delta: time(between),
                hertz: between === 0 ? dash : Number((1e6 / Math.abs(between)).toFixed(3)),
              })}
        </caption>
        <thead>
          <tr>
            <th scope="col">{t("scope.signal")}</th>
            {cursors !== null && (["a", "b", "delta"] as const).map((one) => <th key={one}>{t(`scope.${one}`)}</th>)}
            {(["low", "high", "mean", "rms", "peak"] as const).map((one) => (
              <th key={one} scope="col">
                {t(`scope.${one}`)}
              </th>
            ))}
            <th scope="col">{t("scope.unit")}</th>
          </tr>
        </thead>
        <tbody>
          {signals.length === 0 && (
            <tr>
              <td class="empty" colSpan={9}>
                {t(scope.layout.value.signals.length === 0 ? "scope.empty" : "scope.loading")}
              </td>
            </tr>
          )}
          {signals.map(({ key, column, bit }, place) => {
            const found = frame?.measured.find((one) => one.name === column.name);
            const one = (value: number | undefined) =>
              bit === null || value === undefined || Number.isNaN(value) ? value : (value >>> bit) & 1;
            const show = (value: number | undefined) => number(value, bit === null ? column.unit : "");
            const [a, b] = [one(found?.a), one(found?.b)];
            const all = bit === null ? found?.between : null;
            return (
              <tr key={key}>
                <th scope="row">
                  <Pen place={place} /> <bdi>{foreign(bit === null ? column.name : bitName(column, bit))}</bdi>
                </th>
                {cursors !== null && (
                  <>
                    <td class="number">{show(a)}</td>
                    <td class="number">{show(b)}</td>
                    <td class="number">{show((b ?? Number.NaN) - (a ?? Number.NaN))}</td>
                  </>
                )}
                <td class="number">{show(all?.low)}</td>
                <td class="number">{show(all?.high)}</td>
                <td class="number">{show(all?.mean)}</td>
                <td class="number">{show(all?.rms)}</td>
                <td class="number">{show(all ? all.high - all.low : undefined)}</td>
                <td class="unit">{column.unit}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

/** The picture in words. */
function summary(): string {
  const frame = scope.shown.value;
  if (frame === null) return t("scope.summary.none");
  const parts = frame.measured.flatMap(({ name, between }) => {
    const column = scope.chosen().find((one) => one.column.name === name)?.column;
    if (!between || column === undefined || column.type === "u32") return [];
    const [low, high] = [number(between.low, column.unit), number(between.high, column.unit)];
    return [t("scope.summary.signal", { name: foreign(name), low, high, unit: column.unit })];
  });
  const gaps = frame.gaps.length === 0 ? "" : ` ${t("scope.summary.gaps", { count: frame.gaps.length })}`;
  return `${t("scope.summary", { time: time(frame.view.to - frame.view.from) })} ${parts.join(" ")}${gaps}`;
}

function Cursors() {
  const cursors = scope.cursors.value;
  if (cursors === null) return null;
  return (
    <p class="cursors">
      {(["a", "b"] as const).map((name, place) => (
        <label key={name} class="field">
          <span>{t("scope.cursor", { name: name.toUpperCase() })}</span>
          <input
            type="range"
            min="0"
            max="1"
            step="0.001"
            value={cursors[place] ?? 0}
            onInput={(event) => {
              const part = event.currentTarget.valueAsNumber;
              scope.cursors.value = place === 0 ? [part, cursors[1]] : [cursors[0], part];
            }}
          />
        </label>
      ))}
      <span class="muted small">{t("scope.cursor.hint")}</span>
    </p>
  );
}

/** Moves through what was recorded. */
function Position() {
  const kept = scope.status.value?.kept;
  const view = scope.shown.value?.view;
  if (!kept || !view || scope.status.value?.running) return null;
  const span = view.to - view.from;
  const room = kept.to - kept.from - span;
  return (
    <p class="cursors">
      <label class="field">
        <span>{t("scope.position")}</span>
        <input
          type="range"
          min="0"
          max="1"
          step="0.001"
          disabled={room <= 0}
          value={room <= 0 ? 0 : (view.from - kept.from) / room}
          onInput={(event) => {
            const from = kept.from + event.currentTarget.valueAsNumber * room;
            scope.move(from, from + span);
          }}
        />
      </label>
      <button type="button" onClick={() => scope.move(kept.from, kept.to)}>
        {t("scope.all")}
      </button>
      <button type="button" onClick={() => scope.move(view.from + span / 4, view.to - span / 4)}>
        {t("scope.in")}
      </button>
      <button type="button" onClick={() => scope.move(view.from - span / 2, view.to + span / 2)}>
        {t("scope.out")}
      </button>
      <span class="muted small">{t("scope.position.hint")}</span>
    </p>
  );
}

function toggleCursors(): void {
  scope.cursors.value = scope.cursors.value === null ? [0.25, 0.75] : null;
}

function runOrStop(): void {
  if (scope.status.value?.running) scope.stop();
  else scope.run();
}

/** `R`, `S` and `C`, outside of fields. */
function useScopeKeys(): void {
  useEffect(() => {
    let before = { key: "", time: 0 };
    const press = (event: KeyboardEvent) => {
      const last = performance.now() - before.time < SEQUENCE ? before.key : "";
      before = { key: event.key, time: performance.now() };
      if (takesText(event.target) || event.repeat || event.ctrlKey || event.altKey || event.metaKey || last === "g")
        return;
      const act = { r: runOrStop, s: scope.single, c: toggleCursors }[event.key.toLowerCase()];
      act?.();
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, []);
}

function Tools({ name }: { name: string }) {
  const status = scope.status.value;
  const running = status?.running ?? true;
  const none = (status?.rows ?? 0) === 0;
  const { span, wanted, background } = scope.layout.value;
  const source = status?.header?.source;
  const shown = source === "test" || source === "file" ? source : wanted;
  return (
    <div class="tools" role="toolbar" aria-label={t("scope.tools")}>
      <button type="button" class="primary" aria-keyshortcuts="r" onClick={runOrStop}>
        {t(running ? "scope.stop" : "scope.run")}
      </button>
      <button type="button" aria-keyshortcuts="s" onClick={() => scope.single()}>
        {t("scope.single")}
      </button>
      <Select
        title={t("scope.span")}
        value={String(span)}
        options={scope.SPANS.map((one) => [String(one), time(one)] as const)}
        onChange={(value) => {
          const time = Number(value);
          const [view, kept] = [scope.shown.value?.view, status?.kept];
          scope.change({ span: time });
          // of a stopped recording another part is shown around the same middle, as far as there are values
          if (!running && view && kept) {
            const from = Math.min((view.from + Math.min(view.to, kept.to) - time) / 2, kept.to - time);
            scope.move(Math.max(kept.from, from), Math.max(kept.from, from) + time);
          }
        }}
      />
      <button type="button" aria-pressed={scope.cursors.value !== null} aria-keyshortcuts="c" onClick={toggleCursors}>
        {t("scope.cursors")}
      </button>
      <button
        type="button"
        aria-pressed={scope.overlaid.value}
        disabled={none}
        onClick={() => scope.overlay(!scope.overlaid.value)}
      >
        {t("scope.overlay")}
      </button>
      <button type="button" disabled={none} onClick={() => scope.save(name, false)}>
        {t("scope.csv")}
      </button>
      {scope.cursors.value !== null && (
        <button type="button" disabled={none} onClick={() => scope.save(name, true)}>
          {t("scope.csv.between")}
        </button>
      )}
      <button
        type="button"
        disabled={none}
        onClick={() => {
          const title = `${name}, ${sourceText(status?.header ?? null, status?.rate ?? null)}, ${new Date().toISOString()}`;
          void png(title).then((picture) => {
            if (picture !== null) scope.download(picture, scope.fileName(name, "png"));
          });
        }}
      >
        {t("scope.png")}
      </button>
      <label class="file">
        <span>{t("scope.file")}</span>
        <input
          type="file"
          class="unseen"
          accept=".csv,text/csv"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file) void scope.load(file);
            event.currentTarget.value = "";
          }}
        />
      </label>
      <Select
        title={t("scope.source")}
        value={shown}
        options={[
          ["auto", t("scope.source.auto")],
          ["acyclic", t("scope.source.read")],
          ["test", t("scope.source.generated")],
          ...(source === "file" ? [["file", t("scope.source.file")] as const] : []),
        ]}
        onChange={(value) => {
          if (value === "test") scope.generate();
          else if (value !== "file") {
            scope.change({ wanted: value });
            scope.run();
          }
        }}
      />
      <Check checked={background} onChange={(on) => scope.change({ background: on })}>
        {t("scope.background")}
      </Check>
    </div>
  );
}

/** How the recording is, in words. */
function state(): string {
  const status = scope.status.value;
  if (silent.value !== null || (status !== null && !status.connected && status.header === null)) {
    return t("scope.state.connecting");
  }
  if (status === null) return t("scope.state.connecting");
  if (status.reason !== null) return t("scope.state.reason", { reason: sentence(status.reason) });
  if (!status.running) return t("scope.state.stopped");
  if (status.waits) return t(status.able ? "scope.state.waits" : "scope.state.unable");
  return t(status.rows === 0 ? "scope.state.first" : "scope.state.running");
}

/** Plots the signals of a drive. */
export function Scope() {
  const { path } = useLocation();
  const id = selectedId(path);
  const station = selected(path);
  const there = station !== undefined;
  useEffect(() => {
    if (id === null || !there) return;
    scope.enter(id);
    return scope.leave;
  }, [id, there]);
  useScopeKeys();
  if (id === null || station === undefined) {
    return <Nothing title={t("scope.title")} text={t(id === null ? "scope.select" : "overview.unknown")} />;
  }
  const status = scope.status.value;
  const header = status?.header ?? null;
  const said = scope.said.value;
  const name = header?.source === "file" ? (status?.drive ?? "") : label(station);
  return (
    <article class="scope">
      <h1>
        {t("scope.title")} <bdi>{foreign(name)}</bdi>
      </h1>
      <p class="source">
        <span class="number">{sourceText(header, status?.rate ?? null)}</span>
        {header?.source === "acyclic" && <bdi class="muted">{owner(station)}</bdi>}
        <span class="muted">{state()}</span>
        {status !== null && status.lost > 0 && <span class="warn">{t("scope.lost", { count: status.lost })}</span>}
        {status !== null && status.dropped > 0 && (
          <span class="warn">{t("scope.dropped", { count: status.dropped })}</span>
        )}
      </p>
      <Tools name={name} />
      {said !== null && (
        <p role="status" class={said.failed ? "fault" : "muted"}>
          <bdi>{foreign(said.text, 600)}</bdi>
        </p>
      )}
      <div class="picture">
        <div class="drawing">
          <Plot label={summary()} />
          <Cursors />
          <Position />
          <Measures />
        </div>
        <aside aria-label={t("scope.settings")}>
          <Signals header={header} />
          <TriggerChoice header={header} />
        </aside>
      </div>
    </article>
  );
}
