/** Which signals are shown. */
import { useSignal } from "@preact/signals";
import { Check } from "../../parts/Check";
import { foreign, sentence } from "../../parts/format";
import type { Column, Header } from "../../scope/block";
import * as scope from "../../store/scope";
import { t } from "../../text";
import { bitName } from "./Plot";
import { Pen } from "./parts";

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
      {on && place >= 0 && <Pen place={place} />} <bdi>{foreign(name)}</bdi>{" "}
      {column.unit !== "" && <span class="unit">{column.unit}</span>}
    </Check>
  );
}

/** The name of a column, and the parameter that it is read from. */
function titleOf({ name, from }: Column): string {
  if (from === null) return name;
  return from.startsWith(name) ? from : `${name}, ${from}`;
}

export function Signals({ header }: { header: Header | null }) {
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
