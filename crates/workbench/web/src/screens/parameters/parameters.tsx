import { computed, effect, signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { useLocation } from "preact-iso";
import type { Value } from "../../api";
import { selected, selectedId } from "../../app/selected";
import { foreign, label, sentence } from "../../parts/format";
import { groupOf, groups } from "../../parts/group";
import { Icon } from "../../parts/Icon";
import { Loading, Waits } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { otherOwner } from "../../parts/Reason";
import { now, restarts, server, silent } from "../../store/store";
import { t } from "../../text";
import { Details } from "./Details";
import * as edit from "./edit";
import { isFavourite, openFavourites, toggleFavourite } from "./favourites";
import { Review } from "./Review";

/** Height of a row, in px, as in the style; rows that are out of sight are not made. */
const large = matchMedia("(pointer: coarse), (max-width: 899px)");
const height = () => (large.matches ? 48 : 28);
const row = signal(height());
large.addEventListener("change", () => {
  row.value = height();
});
/** Rows above and below those in sight. */
const BESIDE = 6;
/** Time between two readings of the rows in sight, in ms. */
const PERIOD = 1000;
/** Values older than this are grey, in ms. */
const STALE = 3000;

const search = signal("");
const chosen = signal<string | null>(null);
const ONLY = ["all", "favourites", "edited", "unsaved", "changed"] as const;
const only = signal<(typeof ONLY)[number]>("all");
const group = signal<string | null>(null);

/** The groups of thousands of parameters, which a key of a search does not change. */
const offered = computed(() => groups((edit.lines.value ?? []).map(({ of }) => of)));

/** In the list of groups, what selects all: no group is called so. */
const ALL = " ";

/** Returns the rows that are looked for. */
function found(all: readonly edit.Line[]): edit.Line[] {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  const rows = all.filter((line) => {
    if (only.value === "edited" && !edit.edits.value.has(line.key)) return false;
    if (only.value === "unsaved" && !edit.unsaved.value.has(line.key)) return false;
    if (only.value === "favourites" && !isFavourite(line.of.number)) return false;
    if (group.value !== null && groupOf(line.of) !== group.value) return false;
    if (only.value === "changed" && !edit.isChanged(line)) return false;
    return words.every((word) => line.words.includes(word));
  });
  return edit.exactFirst(rows, search.value);
}

function limits({ of }: edit.Line): string {
  if (of.minimum === null && of.maximum === null) return "";
  if (of.maximum === null) return `\u2265 ${of.minimum}`;
  if (of.minimum === null) return `\u2264 ${of.maximum}`;
  return `${of.minimum} \u2026 ${of.maximum}`;
}

function Editor({ line, may }: { line: edit.Line; may: boolean }) {
  const value = edit.values.value.get(line.key)?.value;
  const typed = edit.edits.value.get(line.key);
  const name = t("parameters.value", { name: line.of.name || line.key });
  const present = value?.text ?? "";
  const take = (text: string) => edit.edit(line.key, text === "" || text === present ? null : text);
  if (line.of.choices.length > 0) {
    const raw = value === undefined ? "" : String(value.raw ?? "");
    const known = line.of.choices.some((choice) => String(choice.value) === raw);
    return (
      <select
        aria-label={name}
        value={typed ?? raw}
        disabled={!may}
        onChange={(event) => {
          const text = event.currentTarget.value;
          edit.edit(line.key, text === raw ? null : text);
        }}
      >
        {!known && <option value={raw}>{value === undefined ? "" : foreign(present)}</option>}
        {line.of.choices.map((choice) => (
          <option key={choice.value} value={String(choice.value)}>
            {choice.value} {foreign(choice.text)}
          </option>
        ))}
      </select>
    );
  }
  return (
    <input
      aria-label={name}
      value={typed ?? present}
      disabled={!may}
      maxLength={200}
      spellcheck={false}
      autocomplete="off"
      onInput={(event) => take(event.currentTarget.value)}
      onKeyDown={(event) => {
        if (event.key === "Escape") edit.edit(line.key, null);
        if (event.key === "Enter") edit.leads.value = edit.edits.value.size > 0;
      }}
    />
  );
}

/** Whether no table describes a parameter: the drive has reported its number. */
function isUnknown({ of }: edit.Line): boolean {
  return of.name === "" && of.source === "";
}

/** Returns a value as it is shown: of an unknown parameter with its octets, or with these alone where it is not even a number. */
function shown(line: edit.Line, value: Value): string {
  const text = value.text ?? "";
  if (!isUnknown(line) || !value.hex) return text;
  const octets = `0x${value.hex.replaceAll(" ", "")}`;
  return text === value.hex ? t("parameters.undecoded", { octets }) : `${text} (${octets})`;
}

function Row({ line }: { line: edit.Line }) {
  const read = edit.values.value.get(line.key);
  const may = server.value?.role === "control" && line.of.access !== "read";
  const old = read === undefined || now.value - read.received > STALE || silent.value !== null;
  const edited = edit.edits.value.has(line.key);
  const error = read?.value.error;
  const meaning = read?.value.meaning;
  const text = read === undefined ? "\u2013" : foreign(shown(line, read.value));
  return (
    <tr
      class={`parameter ${old ? "stale" : ""} ${edited ? "edited" : ""} ${chosen.value === line.key ? "chosen" : ""}`}
      data-key={line.key}
      onFocusIn={() => {
        chosen.value = line.key;
      }}
    >
      <th scope="row">
        <button
          type="button"
          class="plain star"
          aria-pressed={isFavourite(line.of.number)}
          aria-label={t("parameters.favourite", { name: line.of.name || line.key })}
          onClick={() => toggleFavourite(line.of.number)}
        >
          <Icon name="star" />
        </button>
        <button
          type="button"
          class="plain"
          title={line.of.description}
          onClick={() => {
            chosen.value = line.key;
          }}
        >
          <bdi>{foreign(line.of.name || line.key)}</bdi>
          {line.element !== null && `[${line.element}]`}
        </button>
      </th>
      <td class="number muted">{line.of.number}</td>
      <td colSpan={isUnknown(line) ? 2 : 1}>
        {error ? (
          <span class="fault" title={error.meaning}>
            {foreign(error.meaning)}
          </span>
        ) : may ? (
          <Editor line={line} may={silent.value === null} />
        ) : (
          <bdi class="number" title={meaning ?? text}>
            {text}
            {meaning && ` (${foreign(meaning)})`}
          </bdi>
        )}
      </td>
      {/* without a unit, which is not known, there is room for both forms */}
      {!isUnknown(line) && (
        <td class="unit" title={line.of.unit}>
          {line.of.unit || read?.value.unit}
        </td>
      )}
      <td class="number spare">{line.of.default ?? ""}</td>
      <td class="number spare">{limits(line)}</td>
      <td class="muted small">
        {edit.unsaved.value.has(line.key) ? (
          <span class="warn">{t("parameters.unsaved")}</span>
        ) : (
          t(line.of.access === "read" ? "parameters.read" : line.of.saved ? "parameters.saved" : "parameters.volatile")
        )}
      </td>
    </tr>
  );
}

/** Takes the place of rows that are out of sight. */
function Space({ rows }: { rows: number }) {
  if (rows === 0) return null;
  return (
    <tr>
      <td
        class="space"
        ref={(cell) => {
          if (cell !== null) cell.style.height = `${rows * row.value}px`;
        }}
      />
    </tr>
  );
}

const COLUMNS = ["name", "number", "present", "unit", "default", "limits", "access"] as const;

function Table({ rows }: { rows: readonly edit.Line[] }) {
  const [view, setView] = useState({ top: 0, height: 448 });
  const [focused, setFocused] = useState<string | null>(null);
  const element = useRef<HTMLElement>(null);
  const first = Math.max(0, Math.min(rows.length, Math.floor(view.top / row.value)) - BESIDE);
  const last = Math.min(rows.length, Math.ceil((view.top + view.height) / row.value) + BESIDE);
  const seen = rows.slice(first, last);
  // the row with the focus is made out of sight too: a key that scrolls must not take the place of the next key
  const kept = focused === null ? -1 : rows.findIndex(({ key }) => key === focused);
  const apart = kept >= 0 && (kept < first || kept >= last) ? rows[kept] : undefined;
  // one list, so that a row stays the same one in its other place
  const made = seen.map((line) => <Row key={line.key} line={line} />);
  const from = apart && kept < first ? kept : first;
  const to = apart && kept >= last ? kept + 1 : last;
  if (apart) {
    const gap = <Space key=" between" rows={kept < first ? first - kept - 1 : kept - last} />;
    const own = <Row key={apart.key} line={apart} />;
    if (kept < first) made.unshift(own, gap);
    else made.push(gap, own);
  }
  made.unshift(<Space key=" above" rows={from} />);
  made.push(<Space key=" below" rows={rows.length - to} />);
  const keys = seen.filter((line) => line.of.access !== "command").map((line) => line.key);
  const wanted = keys.join(",");
  useEffect(() => {
    let going = false;
    const look = () => {
      const keys = wanted.split(",").filter((key) => key !== "" && !edit.isAbsent(key));
      if (going || document.hidden) return;
      // another page may have written or saved, too
      edit.readUnsaved().catch(() => {});
      if (keys.length === 0) return;
      going = true;
      edit
        .read(keys)
        .catch(() => {})
        .finally(() => {
          going = false;
        });
    };
    // while the table scrolls nothing is read
    const soon = setTimeout(look, 80);
    const turn = setInterval(look, PERIOD);
    return () => {
      clearTimeout(soon);
      clearInterval(turn);
    };
  }, [wanted]);
  useEffect(() => {
    const body = element.current;
    if (body === null) return undefined;
    const measure = () => setView({ top: body.scrollTop, height: body.clientHeight });
    const observer = new ResizeObserver(measure);
    observer.observe(body);
    return () => observer.disconnect();
  }, []);
  return (
    <section
      class="scroll parameters-table"
      // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
      tabIndex={0}
      aria-label={t("parameters.title")}
      ref={element}
      onFocusIn={({ target }) => {
        setFocused(target instanceof Element ? (target.closest<HTMLElement>("[data-key]")?.dataset.key ?? null) : null);
      }}
      onFocusOut={() => setFocused(null)}
      onScroll={(event) => setView({ top: event.currentTarget.scrollTop, height: event.currentTarget.clientHeight })}
    >
      <table aria-rowcount={rows.length + 1}>
        <caption class="unseen">{t("parameters.title")}</caption>
        <thead>
          <tr>
            {COLUMNS.map((column) => (
              <th
                key={column}
                scope="col"
                class={`${column} ${column === "default" || column === "limits" ? "spare" : ""}`}
              >
                {t(`parameters.${column}`)}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {made}
          {rows.length === 0 && (
            <tr>
              <td class="empty" colSpan={5}>
                {t("parameters.nothing")}
              </td>
            </tr>
          )}
        </tbody>
      </table>
    </section>
  );
}

/** All parameters of the selected drive: their values, and changes that are reviewed before anything is written. */
export function Parameters() {
  const { path } = useLocation();
  const id = selectedId(path);
  const station = selected(path);
  // what a link to this screen wants to be typed
  const wanted = useRef(new URLSearchParams(location.hash.slice(1)).get("set"));
  useEffect(() => {
    if (id !== null && station !== undefined) {
      void edit.open(id).then(() => {
        if (wanted.current !== null && server.value?.role === "control") edit.set(wanted.current);
        wanted.current = null;
      });
    }
    group.value = null;
  }, [id, station === undefined, restarts.value]);
  useEffect(() => openFavourites(station?.type ?? ""), [station?.type]);
  useEffect(() => {
    // a link to this screen has what is looked for
    const kept = new URLSearchParams(location.hash.slice(1));
    if (kept.size > 0) {
      search.value = kept.get("q") ?? "";
      only.value = ONLY.find((one) => one === kept.get("only")) ?? "all";
    }
    return effect(() => {
      const all = { q: search.value, only: only.value === "all" ? "" : only.value };
      const hash = new URLSearchParams(Object.entries(all).filter(([, value]) => value !== "")).toString();
      history.replaceState(history.state, "", location.pathname + location.search + (hash && `#${hash}`));
    });
  }, []);
  const wantsChanged = only.value === "changed" && edit.lines.value !== null;
  const { value: done } = edit.applied;
  useEffect(() => {
    // what was written may have made it other
    if (wantsChanged) void edit.readChanged();
  }, [wantsChanged, id, done]);
  useEffect(() => {
    const warn = (event: BeforeUnloadEvent) => {
      if (edit.waits()) event.preventDefault();
    };
    addEventListener("beforeunload", warn);
    return () => removeEventListener("beforeunload", warn);
  }, []);
  if (id === null || !station) {
    return <Nothing title={t("parameters.title")} select={t("parameters.select")} />;
  }
  const all = edit.lines.value;
  const rows = found(all ?? []);
  const line = all?.find((one) => one.key === chosen.value);
  const name = otherOwner(station);
  return (
    <article class="parameters">
      <div class="title">
        <h1>
          {t("parameters.title")} <bdi>{label(station)}</bdi>
        </h1>
        <label>
          <span class="unseen">{t("parameters.search")}</span>
          <input
            type="search"
            placeholder={t("parameters.search")}
            value={search.value}
            onInput={(event) => {
              search.value = event.currentTarget.value;
            }}
          />
        </label>
        <label>
          <span class="unseen">{t("parameters.only")}</span>
          <select
            value={only.value}
            onChange={(event) => {
              only.value = event.currentTarget.value as typeof only.value;
            }}
          >
            {ONLY.map((one) => (
              <option key={one} value={one}>
                {t(`parameters.only.${one}`)}
              </option>
            ))}
          </select>
        </label>
        <label>
          <span class="unseen">{t("parameters.group")}</span>
          <select
            value={group.value ?? ALL}
            onChange={(event) => {
              group.value = event.currentTarget.value === ALL ? null : event.currentTarget.value;
            }}
          >
            <option value={ALL}>{t("parameters.group.all")}</option>
            {offered.value.map((one) => (
              <option key={one} value={one}>
                {one === "" ? t("parameters.group.other") : foreign(one)}
              </option>
            ))}
          </select>
        </label>
        <span class="muted">{all && t("parameters.count", { count: rows.length, all: all.length })}</span>
      </div>
      {name !== null && <p class="warn">{t("parameters.owner", { name })}</p>}
      {edit.failure.value !== "" && (
        <p class="fault">
          <bdi>{sentence(edit.failure.value)}</bdi>
        </p>
      )}
      {wantsChanged && edit.changed.value === null && edit.failure.value === "" && (
        <Waits what={t("loading.changed", { name: label(station) })} />
      )}
      {all === null && edit.failure.value === "" && (
        <div class="beside">
          <Loading key={id} what={t("loading.parameters")} count={14} />
          <aside aria-hidden="true" />
        </div>
      )}
      {all !== null && (
        <div class="beside">
          <Table rows={rows} />
          <aside>
            {server.value?.role === "control" ? <Review /> : <p class="muted">{t("parameters.view")}</p>}
            {line && <Details line={line} station={station} />}
          </aside>
        </div>
      )}
    </article>
  );
}
