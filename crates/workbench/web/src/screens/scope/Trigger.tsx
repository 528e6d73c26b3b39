/** What a recording waits for. */
import { foreign } from "../../parts/format";
import type { Mode, Trigger } from "../../scope/acquisition";
import type { Column, Header } from "../../scope/block";
import type { Condition } from "../../scope/trigger";
import * as scope from "../../store/scope";
import { t } from "../../text";
import { Select } from "./parts";

export function TriggerChoice({ header }: { header: Header | null }) {
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
