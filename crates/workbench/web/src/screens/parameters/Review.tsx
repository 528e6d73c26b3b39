import { useEffect, useRef } from "preact/hooks";
import { Check } from "../../parts/Check";
import { sentence } from "../../parts/format";
import { Plan } from "../../parts/Plan";
import { silent } from "../../store/store";
import { t } from "../../text";
import * as edit from "./edit";

/** What would be written, and what became of it. */
export function Review() {
  const planned = edit.plan.value;
  const count = edit.edits.value.size;
  const done = edit.applied.value;
  const usable = !edit.busy.value && silent.value === null;
  const ready = usable && planned?.plan?.ready === true;
  const apply = useRef<HTMLButtonElement>(null);
  const leads = edit.leads.value && planned !== null;
  useEffect(() => {
    if (!leads) return;
    edit.leads.value = false;
    if (ready) apply.current?.focus();
  }, [leads]);
  return (
    <section class="review" aria-label={t("plan.title")}>
      <h2>{t("plan.title")}</h2>
      {count === 0 && done === null && <p class="muted">{t("plan.empty")}</p>}
      {edit.refused.value !== "" && (
        <p class="fault" role="alert">
          <bdi>{sentence(edit.refused.value)}</bdi>
        </p>
      )}
      {count > 0 && planned === null && edit.refused.value === "" && (
        <p class="muted" role="status">
          {t("plan.checking")}
        </p>
      )}
      {count > 0 && planned !== null && <Plan job={planned} />}
      {count > 0 && (
        <>
          <Check checked={edit.save.value} onChange={edit.choose}>
            {t("plan.save")}
          </Check>
          <p class="buttons">
            <button ref={apply} type="button" class="primary" disabled={!ready} onClick={() => void edit.apply()}>
              {t(edit.busy.value ? "plan.applying" : "plan.apply", { count })}
            </button>
            <button type="button" disabled={edit.busy.value} onClick={() => edit.discard()}>
              {t("plan.discard")}
            </button>
          </p>
          {planned?.plan && planned.plan.refusals.length > 0 && <p class="fault">{t("plan.blocked")}</p>}
          {planned?.plan && !planned.plan.ready && planned.plan.refusals.length === 0 && (
            <p class="muted">{t("plan.nothing")}</p>
          )}
        </>
      )}
      {count === 0 && done !== null && (
        <>
          <p role="status">
            {t(done.phase === "undone" ? "plan.undone" : "plan.done", { summary: done.plan?.summary ?? "" })}
          </p>
          <Plan job={done} />
          <p class="buttons">
            {done.phase === "applied" && done.plan?.undo && (
              <button type="button" disabled={!usable} onClick={() => void edit.undo()}>
                {t("plan.undo")}
              </button>
            )}
            {done.phase === "applied" && !done.plan?.saves && (
              <button type="button" disabled={!usable} onClick={() => edit.keep()}>
                {t("plan.keep")}
              </button>
            )}
          </p>
        </>
      )}
    </section>
  );
}
