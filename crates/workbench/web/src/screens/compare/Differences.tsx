import { signal } from "@preact/signals";
import type { Diff } from "../../api";
import { Check } from "../../parts/Check";
import { downloadText } from "../../parts/download";
import { foreign, sentence } from "../../parts/format";
import { groupOf, groups } from "../../parts/group";
import { server } from "../../store/store";
import { t } from "../../text";
import { csv, html, keyOf, type Report, type Row, valueText } from "./merge";
import { type Compared, network, picked, plan, type Restorable, restorable, save } from "./state";

/** Which of the differences are listed. */
const search = signal("");
const group = signal<string | null>(null);
/** In the list of groups, what selects all: no group is called so. */
const ALL = " ";

const dash = "\u2013";

function named({ of }: Row): { name: string | null; number: string } {
  return { name: of.name, number: keyOf(of) };
}

function listed(rows: readonly Row[]): readonly Row[] {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter((row) => {
    const text = `${row.of.name ?? ""} ${keyOf(row.of)}`.toLowerCase();
    return (group.value === null || groupOf(named(row)) === group.value) && words.every((word) => text.includes(word));
  });
}

function note(row: Row): string {
  const changed = row.changed === null ? "" : t(`compare.changed.${row.changed}`);
  return [changed, row.of.connection ? t("compare.connection") : ""].filter(Boolean).join("; ");
}

function report(names: { left: string; right: string }, rows: readonly Row[], withBase: boolean): Report {
  const head = [t("parameters.number"), t("parameters.name"), names.left, names.right];
  return {
    title: t("compare.report", names),
    head: [...head, ...(withBase ? [t("compare.base")] : []), t("compare.kind")],
    rows: rows.map((row) => [
      keyOf(row.of),
      row.of.name ?? "",
      valueText(row.of.left),
      valueText(row.of.right),
      ...(withBase ? [valueText(row.base)] : []),
      note(row),
    ]),
  };
}

function Take({ row }: { row: Row }) {
  const key = keyOf(row.of);
  return (
    <input
      type="checkbox"
      aria-label={t("compare.take.one", { name: row.of.name ?? key })}
      checked={picked.value.has(key)}
      onChange={(event) => {
        const next = new Set(picked.value);
        if (event.currentTarget.checked) next.add(key);
        else next.delete(key);
        picked.value = next;
        plan.value = null;
      }}
    />
  );
}

function Table({ rows, names, take, withBase }: TableProps) {
  const value = (side: Row["base"]) => <bdi>{side === null ? dash : foreign(valueText(side))}</bdi>;
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
    <section class="scroll differences" tabIndex={0} aria-label={t("compare.title")}>
      <table>
        <caption class="unseen">{t("compare.title")}</caption>
        <thead>
          <tr>
            {take && <th scope="col">{t("compare.take")}</th>}
            <th scope="col">{t("parameters.name")}</th>
            <th scope="col">{t("parameters.number")}</th>
            <th scope="col">{foreign(names.left)}</th>
            <th scope="col">{foreign(names.right)}</th>
            {withBase && <th scope="col">{t("compare.base")}</th>}
            <th scope="col">{t("compare.kind")}</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={keyOf(row.of)}>
              {take && (
                <td>
                  <Take row={row} />
                </td>
              )}
              <th scope="row">
                <bdi>{foreign(row.of.name ?? "")}</bdi>
              </th>
              <td class="number">{keyOf(row.of)}</td>
              <td class="number">{value(row.of.left)}</td>
              <td class="number">{value(row.of.right)}</td>
              {withBase && <td class="number">{value(row.base)}</td>}
              <td class="muted small">{note(row)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** What differs in name and address, which is set on another screen. */
function Addresses({ differences }: { differences: Diff }) {
  if (differences.network.length === 0) return null;
  return (
    <section class="scroll">
      <table>
        <caption class="unseen">{t("compare.network")}</caption>
        <thead>
          <tr>
            <th scope="col">{t("parameters.name")}</th>
            <th scope="col">{foreign(differences.left)}</th>
            <th scope="col">{foreign(differences.right)}</th>
            <th scope="col">{t("compare.kind")}</th>
          </tr>
        </thead>
        <tbody>
          {differences.network.map(({ setting, left, right }) => (
            <tr key={setting} data-network={setting}>
              <th scope="row">{setting}</th>
              <td class="number">
                <bdi>{foreign(left) || dash}</bdi>
              </td>
              <td class="number">
                <bdi>{foreign(right) || dash}</bdi>
              </td>
              <td class="muted small">
                {t("compare.network.set")} <a href={`/network${location.search}`}>{t("nav.network")}</a>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** Whether the settings of the network are listed and restored, with how many there are. */
function WithNetwork({ count }: { count: number }) {
  return (
    <p class="buttons">
      <Check
        of={network}
        onChange={() => {
          // what is not listed is not taken
          picked.value = new Set();
          plan.value = null;
        }}
      >
        {t("compare.network.with", { count })}
      </Check>
      <span class="muted small">{t(network.value ? "compare.network.taken" : "compare.network.left")}</span>
    </p>
  );
}

interface TableProps {
  rows: readonly Row[];
  names: { left: string; right: string };
  take: boolean;
  withBase: boolean;
}

/** Which differences are listed, and the same as files. */
function Tools({ rows, shown, names, withBase }: Omit<TableProps, "take"> & { shown: readonly Row[] }) {
  const of = groups(rows.map(named));
  return (
    <p class="buttons">
      <label class="inline">
        <span>{t("log.search")}</span>
        <input
          type="search"
          value={search.value}
          onInput={(event) => {
            search.value = event.currentTarget.value;
          }}
        />
      </label>
      {of.length > 1 && (
        <label class="inline">
          <span>{t("parameters.group")}</span>
          <select
            value={group.value ?? ALL}
            onChange={(event) => {
              group.value = event.currentTarget.value === ALL ? null : event.currentTarget.value;
            }}
          >
            <option value={ALL}>{t("parameters.group.all")}</option>
            {of.map((one) => (
              <option key={one} value={one}>
                {one === "" ? t("parameters.group.other") : one}
              </option>
            ))}
          </select>
        </label>
      )}
      <span class="muted">{t("parameters.count", { count: shown.length, all: rows.length })}</span>
      <button
        type="button"
        onClick={() => downloadText("differences.csv", "text/csv", csv(report(names, shown, withBase)))}
      >
        {t("network.export")}
      </button>
      <button
        type="button"
        onClick={() => downloadText("differences.html", "text/html", html(report(names, shown, withBase)))}
      >
        {t("compare.html")}
      </button>
    </p>
  );
}

/** What differs between two sides, and which of it is restored. */
export function Differences({
  job,
  left,
  right,
  base,
  rows: all,
  usable,
  makePlan,
}: Compared & { usable: boolean; makePlan: (wanted: Restorable) => void }) {
  const differences = job.differences;
  if (differences === null) return null;
  const ofNetwork = all.filter(({ of }) => of.connection).length + differences.network.length;
  const rows = network.value ? all : all.filter(({ of }) => !of.connection);
  const may = restorable({ left, right });
  const control = server.value?.role === "control";
  const tasks = differences.tasks.length;
  const names = { left: differences.left, right: differences.right };
  const shown = listed(rows);
  const withBase = base !== "";
  return (
    <section aria-label={t("compare.differences")}>
      <h2>{t("compare.result", { count: rows.length + tasks })}</h2>
      {job.remarks.map((remark) => (
        <p key={remark} class="warn">
          <bdi>{sentence(remark)}</bdi>
        </p>
      ))}
      {rows.length + tasks === 0 && <p>{t("compare.same")}</p>}
      {rows.length > 0 && (
        <>
          <Tools rows={rows} shown={shown} names={names} withBase={withBase} />
          <Table rows={shown} names={names} take={may !== null && control} withBase={withBase} />
        </>
      )}
      {network.value && <Addresses differences={differences} />}
      {ofNetwork > 0 && <WithNetwork count={ofNetwork} />}
      {tasks > 0 && <p>{t("compare.tasks", { list: differences.tasks.map(({ number }) => number).join(", ") })}</p>}
      {may && control && rows.length + tasks > 0 && (
        <p class="buttons">
          <button type="button" disabled={!usable} onClick={() => makePlan(may)}>
            {may.file === null
              ? picked.value.size === 0
                ? t("compare.plan.delivered.all")
                : t("compare.plan.delivered", { count: picked.value.size })
              : picked.value.size === 0
                ? t("compare.plan.all")
                : t("compare.plan", { count: picked.value.size })}
          </button>
          <Check
            of={save}
            onChange={() => {
              plan.value = null;
            }}
          >
            {t("plan.save")}
          </Check>
        </p>
      )}
      {!may && <p class="muted">{t("compare.unrestorable")}</p>}
    </section>
  );
}
