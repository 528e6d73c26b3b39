import type { ComponentChildren } from "preact";
import type { Job, SettingChange } from "../api";
import { own } from "../store/control";
import { t } from "../text";
import { foreign, sentence } from "./format";
import { Icon } from "./Icon";

function shown(parameter: SettingChange["old"]): string {
  if (parameter === null) return "\u2013";
  return foreign(parameter.text ?? parameter.error?.meaning ?? "");
}

/** What became of a change; nothing while it is only planned. */
function result(change: SettingChange): { text: string; tone: string } | null {
  switch (change.step) {
    case "same":
      return { text: t("plan.same"), tone: "muted" };
    case "read back":
      return { text: t("plan.verified"), tone: "ok" };
    case "written":
      return { text: t("plan.written"), tone: "ok" };
    case "differs":
      return { text: t("plan.differs", { value: shown(change.read_back) }), tone: "fault" };
    case "in doubt":
      return { text: t("plan.doubt"), tone: "fault" };
    case "refused":
    case "not carried":
      return { text: t("plan.refused", { reason: change.error?.meaning ?? "" }), tone: "fault" };
    default:
      return null;
  }
}

function Change({ change, planned }: { change: SettingChange; planned: boolean }) {
  const done = result(change);
  const unit = change.new.unit;
  return (
    <li>
      <p>
        <bdi>
          <b>{foreign(change.name ?? change.new.number)}</b>
        </bdi>{" "}
        <span class="muted small">{change.name === null ? "" : change.new.number}</span>
      </p>
      <p class="number">
        <bdi>{shown(change.old)}</bdi> {"\u2192"} <bdi>{shown(change.new)}</bdi> <span class="unit">{unit}</span>
        {change.new.meaning && <span class="muted small"> {foreign(change.new.meaning)}</span>}
      </p>
      {planned && change.rounded && change.asked !== null && (
        <p class="warn small">{t("plan.rounded", { asked: change.asked, unit })}</p>
      )}
      {planned && change.can_be_kept === false && <p class="muted small">{t("plan.volatile")}</p>}
      {done !== null && (change.step !== "same" || planned) && (
        <p class={`${done.tone} small`}>
          <Icon name={done.tone === "ok" ? "tick" : done.tone === "fault" ? "cross" : "dash"} />{" "}
          <bdi>{sentence(done.text)}</bdi>
        </p>
      )}
    </li>
  );
}

/** What a plan changes, and what became of it. */
export function Plan({ job, children }: { job: Job; children?: ComponentChildren }) {
  const { plan } = job;
  const planned = job.phase === "planned";
  if (plan === null) return null;
  return (
    <>
      {planned && plan.controller !== null && (job.drive === null || own(job.drive) === undefined) && (
        <p class="warn">
          <Icon name="triangle" /> <bdi>{t("plan.controller", { name: foreign(plan.controller) })}</bdi>
        </p>
      )}
      <ul class="changes">
        {plan.refusals.map(({ parameter, error }) => (
          <li key={`${parameter} ${error.message}`}>
            <p class="fault">
              <Icon name="cross" /> <bdi>{sentence(error.message)}</bdi>
            </p>
            {error.hint && (
              <p class="muted small">
                <bdi>{sentence(error.hint)}</bdi>
              </p>
            )}
          </li>
        ))}
        {plan.changes.map((change) =>
          // what makes the drive save has no value of before, and none that is kept
          planned && plan.saves && change.old === null && change.can_be_kept === false ? (
            <li key="save">
              <bdi>{t("plan.saves", { name: foreign(change.name ?? change.new.number) })}</bdi>
            </li>
          ) : (
            <Change key={`${change.pnu} ${change.index}`} change={change} planned={planned} />
          ),
        )}
        {plan.tasks.map((task) => (
          <li key={`task ${task.number}`}>{t("plan.task", { number: task.number, step: task.step })}</li>
        ))}
        {plan.skipped.map(({ setting, why }) => (
          <li key={`left ${setting.number}`} class="warn small">
            <bdi>{t("plan.skipped", { name: foreign(setting.name ?? setting.number), why: foreign(why) })}</bdi>
          </li>
        ))}
      </ul>
      {plan.tasks_left_out !== null && plan.file !== null && (
        <p class="warn small">{t("plan.tasks", { why: foreign(plan.tasks_left_out) })}</p>
      )}
      {job.remarks.map((remark) => (
        <p key={remark} class="small">
          <bdi>{sentence(remark)}</bdi>
        </p>
      ))}
      {job.problem !== null && (
        <p class="fault">
          <bdi>{sentence(job.problem.message)}</bdi>
        </p>
      )}
      {!planned && plan.before !== null && <p class="small">{t("plan.before", { file: foreign(plan.before) })}</p>}
      {children}
    </>
  );
}
