/** What is measured of the picture, its cursors, and the place that it shows. */
import { foreign } from "../../parts/format";
import * as scope from "../../store/scope";
import { t } from "../../text";
import { bitName } from "./Plot";
import { dash, number, Pen, time } from "./parts";

/** What is measured, as a table: for people who do not see the picture too. */
export function Measures() {
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
export function summary(): string {
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

export function Cursors() {
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
export function Position() {
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
