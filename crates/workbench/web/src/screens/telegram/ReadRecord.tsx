import { useSignal } from "@preact/signals";
import { type RecordReport, request } from "../../api";
import { sentence } from "../../parts/format";
import { reason } from "../../store/jobs";
import { silent } from "../../store/store";
import { t } from "../../text";
import { octets, wholeNumber } from "./nodes";

const FIELDS = ["api", "slot", "subslot", "index"] as const;

/** Reads a record of any submodule, for experts. */
export function ReadRecord({ id }: { id: string }) {
  const typed = useSignal<Record<(typeof FIELDS)[number], string>>({
    api: "0",
    slot: "0",
    subslot: "1",
    index: "0xAFF0",
  });
  const answer = useSignal<{ record: RecordReport | null; failure: string } | null>(null);
  const busy = useSignal(false);
  const numbers = FIELDS.map((field) => wholeNumber(typed.value[field], field === "api" ? 0xffff_ffff : 0xffff));
  const may = numbers.every((number) => number !== null) && silent.value === null && !busy.value;
  const read = async () => {
    busy.value = true;
    const query = new URLSearchParams(FIELDS.map((field, place) => [field, String(numbers[place])]));
    answer.value = await request<RecordReport>(`drives/${encodeURIComponent(id)}/record?${query}`).then(
      (record) => ({ record, failure: "" }),
      (error: unknown) => ({ record: null, failure: reason(error) }),
    );
    busy.value = false;
  };
  const all = octets(answer.value?.record?.octets ?? "");
  return (
    <details class="record">
      <summary>{t("record.title")}</summary>
      <form
        class="buttons"
        onSubmit={(event) => {
          event.preventDefault();
          if (may) void read();
        }}
      >
        {FIELDS.map((field, place) => (
          <label class="field" key={field}>
            <span>{t(`record.${field}`)}</span>
            <input
              value={typed.value[field]}
              size={8}
              maxLength={10}
              spellcheck={false}
              autocomplete="off"
              aria-invalid={numbers[place] === null}
              onInput={(event) => {
                typed.value = { ...typed.value, [field]: event.currentTarget.value };
              }}
            />
          </label>
        ))}
        <button type="submit" aria-disabled={!may}>
          {t("record.read")}
        </button>
      </form>
      <p class="muted small">{t("record.hint")}</p>
      <div role="status">
        {answer.value?.failure && (
          <p class="fault">
            <bdi>{sentence(answer.value.failure)}</bdi>
          </p>
        )}
        {answer.value?.record && (
          <>
            <p>
              <bdi>{sentence(answer.value.record.text ?? t("record.unknown"))}</bdi>
            </p>
            <p class="muted small">{t("record.length", { count: all.length })}</p>
            <pre class="number">
              {Array.from(
                { length: Math.ceil(all.length / 16) },
                (_, line) =>
                  `${(line * 16).toString(16).toUpperCase().padStart(4, "0")}  ${all.slice(line * 16, line * 16 + 16).join(" ")}`,
              ).join("\n")}
            </pre>
          </>
        )}
      </div>
    </details>
  );
}
