import { signal } from "@preact/signals";
import { type Fault, post, type Station } from "../api";
import { server, silent } from "../store/store";
import { t } from "../text";
import { sentence } from "./format";
import { ownerName } from "./Reason";

/** What became of the last acknowledgement: of which drive, and in words. What is done is shown without a fault, and not for long. */
const answer = signal<{ id: string; text: string; busy: boolean; done: boolean } | null>(null);
/** Time for which it is shown that it is done, in ms. */
const SHOWN = 10_000;

async function acknowledge(id: string, by: "control_word" | "parameter"): Promise<void> {
  answer.value = { id, text: t("faults.acknowledging"), busy: true, done: false };
  const became = await post(`drives/${encodeURIComponent(id)}/acknowledge`, { by }).then(
    () => ({ text: t("faults.acknowledged"), done: true }),
    (error: unknown) => {
      const reason = error instanceof Error ? error.message : String(error);
      return { text: t("faults.refused", { reason }), done: false };
    },
  );
  const ended = { id, busy: false, ...became };
  answer.value = ended;
  if (!ended.done) return;
  setTimeout(() => {
    if (answer.value === ended) answer.value = null;
  }, SHOWN);
}

/** Acknowledges the faults of a drive, or says why that is not possible here. */
export function Acknowledge({ station, present }: { station: Station; present: readonly Fault[] }) {
  const name = ownerName(station);
  const of = answer.value?.id === station.id ? answer.value : null;
  // until the drive was read again, and once it has another fault
  const last = of?.done && present.length > 0 ? null : of;
  const said = <p role="status">{last && <bdi>{sentence(last.text)}</bdi>}</p>;
  if (present.length === 0) return said;
  if (present.every((fault) => fault.needs_restart === true)) return <p class="next">{t("faults.restart")}</p>;
  if (server.value?.role !== "control") return <p class="muted">{t("faults.view")}</p>;
  // beside its controller, and where no cyclic connection is possible, only a parameter is left
  const by = name !== null || server.value.source === "addresses" ? "parameter" : "control_word";
  const why = by === "control_word" ? "faults.by.word" : name === null ? "faults.by.address" : "faults.by.parameter";
  return (
    <>
      <div class="action">
        <button
          type="button"
          disabled={last?.busy || silent.value !== null}
          onClick={() => void acknowledge(station.id, by)}
        >
          {t("faults.acknowledge")}
        </button>
        <p class="muted">
          <bdi>{t(why, { name: name ?? "" })}</bdi>
        </p>
      </div>
      {said}
    </>
  );
}
