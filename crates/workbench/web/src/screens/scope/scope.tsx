import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { selected, selectedId } from "../../app/selected";
import { isShortcut } from "../../app/shortcuts";
import { Check } from "../../parts/Check";
import { download } from "../../parts/download";
import { foreign, label, sentence } from "../../parts/format";
import { Nothing } from "../../parts/Nothing";
import { owner } from "../../parts/Reason";
import type { Header } from "../../scope/block";
import { recordedAt } from "../../scope/csv";
import * as scope from "../../store/scope";
import { silent } from "../../store/store";
import { t } from "../../text";
import { Keep, Maths } from "./Maths";
import { Cursors, Measures, Position, summary } from "./Measures";
import { Plot, png } from "./Plot";
import { dash, Select, time } from "./parts";
import { Signals } from "./Signals";
import { TriggerChoice } from "./Trigger";

/** Time between `g` and the letter of a screen, in ms. */
const SEQUENCE = 1000;

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
      if (event.repeat || last === "g" || !isShortcut(event)) return;
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
  const { span } = scope.layout.value;
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
          const header = status?.header ?? null;
          const recorded = recordedAt(header, scope.shown.value?.zero ?? null);
          void png([name, sourceText(header, status?.rate ?? null), recorded].filter(Boolean).join(", ")).then(
            (picture) => {
              if (picture !== null) download(scope.fileName(name, "png"), picture);
            },
          );
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
    </div>
  );
}

/** Where values come from, and whether they are kept while this screen is not shown. */
function Source() {
  const { wanted, background } = scope.layout.value;
  const source = scope.status.value?.header?.source;
  const shown = source === "test" || source === "file" ? source : wanted;
  return (
    <div class="inline">
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
    const at = Number(new URLSearchParams(location.hash.slice(1)).get("at") ?? "");
    if (at > 0) {
      scope.seek(at);
      // once: who comes back to this screen wants what runs
      history.replaceState(history.state, "", location.pathname + location.search);
    }
    return scope.leave;
  }, [id, there]);
  useScopeKeys();
  if (id === null || station === undefined) {
    return <Nothing title={t("scope.title")} select={t("scope.select")} />;
  }
  const status = scope.status.value;
  const header = status?.header ?? null;
  const said = scope.said.value;
  const name = header?.source === "file" ? (status?.drive ?? "") : label(station);
  return (
    <article class="scope">
      <div class="source">
        <h1>
          {t("scope.title")} <bdi>{foreign(name)}</bdi>
        </h1>
        <span class="number">{sourceText(header, status?.rate ?? null)}</span>
        {header?.source === "acyclic" && <bdi class="muted">{owner(station)}</bdi>}
        <span class="muted">{state()}</span>
        {status !== null && status.lost > 0 && <span class="warn">{t("scope.lost", { count: status.lost })}</span>}
        {status !== null && status.bad > 0 && <span class="warn">{t("scope.bad", { count: status.bad })}</span>}
        {status !== null && status.dropped > 0 && (
          <span class="warn">{t("scope.dropped", { count: status.dropped })}</span>
        )}
        <Source />
      </div>
      <Tools name={name} />
      {said !== null && (
        <p role="status" class={said.failed ? "fault" : "muted"}>
          <bdi>{foreign(said.text, 600)}</bdi>{" "}
          {said.unrecorded && (
            <button type="button" onClick={() => scope.recordFault()}>
              {t("scope.at.next")}
            </button>
          )}
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
          <Maths header={header} />
          <TriggerChoice header={header} />
          <Keep name={label(station)} />
        </aside>
      </div>
    </article>
  );
}
