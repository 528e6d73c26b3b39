/** Signals that are calculated, and the layout as a file. */
import { useSignal } from "@preact/signals";
import { foreign } from "../../parts/format";
import type { Header } from "../../scope/block";
import { MOST } from "../../scope/maths";
import * as scope from "../../store/scope";
import { t } from "../../text";
import { Select } from "./parts";

/** Adds and removes differences of two signals with the same unit. */
export function Maths({ header }: { header: Header | null }) {
  const a = useSignal("");
  const b = useSignal("");
  const { maths, signals } = scope.layout.value;
  const own = new Set(maths.map(scope.differenceKey));
  const numbers = (header?.columns ?? []).filter((column) => column.type !== "u32" && !own.has(scope.keyOf(column)));
  const first = numbers.find((column) => scope.keyOf(column) === a.value) ?? numbers[0];
  const others = numbers.filter((column) => column !== first && column.unit === first?.unit);
  const second = others.find((column) => scope.keyOf(column) === b.value) ?? others[0];
  if (numbers.length < 2) return null;
  const names = (all: typeof numbers) => all.map((column) => [scope.keyOf(column), foreign(column.name)] as const);
  const pair = first && second ? { a: scope.keyOf(first), b: scope.keyOf(second) } : null;
  const nameOf = (key: string) => foreign(scope.find(header, key)?.column.name ?? key);
  return (
    <section aria-label={t("scope.maths")}>
      <h2>{t("scope.maths")}</h2>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (pair === null) return;
          scope.change({
            maths: [...maths, pair],
            signals: [...signals, scope.differenceKey(pair)].slice(0, scope.MOST_SIGNALS),
          });
        }}
      >
        <Select
          title={t("scope.maths.a")}
          value={pair?.a ?? ""}
          options={names(numbers)}
          onChange={(key) => {
            a.value = key;
          }}
        />
        <Select
          title={t("scope.maths.b")}
          value={pair?.b ?? ""}
          options={names(others)}
          onChange={(key) => {
            b.value = key;
          }}
        />
        <button type="submit" disabled={pair === null || maths.length >= MOST || own.has(scope.differenceKey(pair))}>
          {t("scope.maths.add")}
        </button>
      </form>
      {maths.length > 0 && (
        <ul>
          {maths.map((one) => (
            <li key={scope.differenceKey(one)}>
              <button
                type="button"
                onClick={() =>
                  scope.change({
                    maths: maths.filter((other) => other !== one),
                    signals: signals.filter((key) => key !== scope.differenceKey(one)),
                  })
                }
              >
                {t("scope.parameter.remove", { name: `${nameOf(one.a)} - ${nameOf(one.b)}` })}
              </button>
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}

/** Writes the layout to a file, and takes that of another drive. */
export function Keep({ name }: { name: string }) {
  return (
    <section aria-label={t("scope.layout")}>
      <h2>{t("scope.layout")}</h2>
      <p class="buttons">
        <button type="button" onClick={() => scope.saveLayout(name)}>
          {t("scope.layout.save")}
        </button>
        <label class="button">
          <span>{t("scope.layout.open")}</span>
          <input
            type="file"
            class="unseen"
            accept=".json,application/json"
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              if (file) void scope.loadLayout(file);
              event.currentTarget.value = "";
            }}
          />
        </label>
      </p>
    </section>
  );
}
