import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { type Backups, type Job, post, request, type Station } from "../../api";
import { selected, selectedId } from "../../app/selected";
import { foreign, label, sentence } from "../../parts/format";
import { Bars, Loading } from "../../parts/Loading";
import { Nothing } from "../../parts/Nothing";
import { Plan } from "../../parts/Plan";
import { follow, reason } from "../../store/jobs";
import { server, silent, stations } from "../../store/store";
import { t } from "../../text";
import { Differences } from "./Differences";
import { keyOf, merge, valueText } from "./merge";
import { base, compared, left, network, picked, plan, type Restorable, right, save } from "./state";

/** The files of the server; `null` before they were listed. */
const files = signal<Backups["files"] | null>(null);
/** What is worked on, in words, and how far that is. */
const work = signal<{ text: string; done: number; total: number } | null>(null);
const failure = signal("");

async function list(): Promise<void> {
  files.value = (await request<Backups>("backups")).files;
}

/** Does something that takes longer, and shows how far it is. */
async function working(text: string, does: (show: (job: Job) => void) => Promise<void>): Promise<void> {
  if (work.value !== null) return;
  failure.value = "";
  work.value = { text, done: 0, total: 0 };
  try {
    await does((job) => {
      work.value = { text, done: job.done, total: job.total };
    });
  } catch (error) {
    failure.value = reason(error);
  }
  work.value = null;
}

function source(side: string): { [kind: string]: string } {
  const at = side.indexOf(" ");
  return { [side.slice(0, at)]: side.slice(at + 1) };
}

async function backUp(id: string): Promise<void> {
  await working(t("compare.saving"), async (show) => {
    const job = await follow(await post<Job>(`drives/${encodeURIComponent(id)}/backups`, {}), show);
    await list();
    if (job.file !== null) right.value = `file ${job.file}`;
    if (job.remarks.length > 0) failure.value = job.remarks.join(" ");
  });
}

async function compare(): Promise<void> {
  const sides = { left: left.value, right: right.value };
  plan.value = null;
  await working(t("compare.comparing"), async (show) => {
    const of = async (left: string, right: string) =>
      follow(await post<Job>("compare", { left: source(left), right: source(right) }), show);
    const third = base.value;
    const job = await of(sides.left, sides.right);
    const differences = async (side: string) =>
      third === side ? [] : ((await of(third, side)).differences?.differences ?? []);
    const beside = third === "" ? null : { left: await differences(sides.left), right: await differences(sides.right) };
    const rows = merge(job.differences?.differences ?? [], beside);
    compared.value = { job, ...sides, rows, base: third };
    picked.value = new Set();
  });
  // the table of the pair before is none of this one
  if (failure.value !== "") compared.value = null;
}

/** Values as delivered are written like values that are typed; those of the connection only where they are chosen. */
function delivered(from: "left" | "right"): { parameter: string; value: string }[] {
  const rows = compared.value?.rows ?? [];
  const may = rows.filter(({ of }) => network.value || !of.connection);
  const wanted = may.filter(({ of }) => picked.value.size === 0 || picked.value.has(keyOf(of)));
  return wanted.map(({ of }) => ({ parameter: keyOf(of), value: valueText(of[from]) }));
}

async function makePlan({ id, file, from }: Restorable): Promise<void> {
  const wanted =
    file === null ? { changes: delivered(from) } : { file, settings: [...picked.value], network: network.value };
  await working(t("plan.checking"), async (show) => {
    const begun = await post<Job>(`drives/${encodeURIComponent(id)}/plans`, { ...wanted, save: save.value });
    plan.value = await follow(begun, show);
  });
}

async function apply(): Promise<void> {
  const planned = plan.value;
  if (planned === null) return;
  await working(t("plan.applying"), async (show) => {
    plan.value = await follow(await post<Job>(`plans/${planned.id}/apply`, {}), show);
    await list();
  });
  if (failure.value !== "") plan.value = null;
}

async function upload(file: File): Promise<void> {
  const text = await file.text();
  await working(t("compare.uploading"), async () => {
    const kept = await post<{ file: string }>("backups", { text });
    await list();
    right.value = `file ${kept.file}`;
  });
}

function Side({ title, side, none, of }: { title: string; side: typeof left; none?: string; of: Station }) {
  const file = side.value.startsWith("file ") ? side.value.slice(5) : null;
  return (
    <div class="side">
      <label>
        <span class="muted small">{title}</span>
        <select
          value={side.value}
          onChange={(event) => {
            side.value = event.currentTarget.value;
          }}
        >
          <option value="" disabled={none === undefined} hidden={none === undefined}>
            {none ?? t("compare.choose")}
          </option>
          <optgroup label={t("compare.drives")}>
            {(stations.value ?? []).map((station) => (
              <option key={station.id} value={`drive ${station.id}`}>
                {label(station)}
              </option>
            ))}
          </optgroup>
          <optgroup label={t("compare.default")}>
            <option value={`delivered ${of.id}`}>{t("compare.delivered", { name: label(of) })}</option>
          </optgroup>
          <optgroup label={t("compare.files")}>
            {(files.value ?? []).map((kept) => (
              <option key={kept.file} value={`file ${kept.file}`}>
                {foreign(kept.file)}
              </option>
            ))}
          </optgroup>
        </select>
      </label>
      {file !== null && (
        <a href={`/api/v1/backups/${encodeURIComponent(file)}`} download={file} target="_blank" rel="noopener">
          {t("compare.download")}
        </a>
      )}
    </div>
  );
}

/** Settings of drives and files: saved, compared, and restored as a plan that is reviewed. */
export function Compare() {
  const { path } = useLocation();
  const id = selectedId(path);
  const station = selected(path);
  useEffect(() => {
    if (id === null) return;
    left.value = `drive ${id}`;
    list().catch((error: unknown) => {
      failure.value = reason(error);
    });
  }, [id]);
  if (id === null || !station) {
    return <Nothing title={t("compare.title")} select={t("compare.select")} />;
  }
  const control = server.value?.role === "control";
  const usable = control && work.value === null && silent.value === null;
  const planned = plan.value;
  return (
    <article class="compare">
      <h1>
        {t("compare.title")} <bdi>{label(station)}</bdi>
      </h1>
      {control && (
        <p class="buttons">
          <button type="button" disabled={!usable} onClick={() => void backUp(id)}>
            {t("compare.save", { name: label(station) })}
          </button>
          <label class="button">
            <span>{t("compare.upload")}</span>
            <input
              type="file"
              class="unseen"
              disabled={!usable}
              onChange={(event) => {
                const file = event.currentTarget.files?.[0];
                if (file) void upload(file);
                event.currentTarget.value = "";
              }}
            />
          </label>
        </p>
      )}
      <div class="sides">
        <Side title={t("compare.left")} side={left} of={station} />
        <Side title={t("compare.right")} side={right} of={station} />
        <Side title={t("compare.base")} side={base} none={t("compare.base.none")} of={station} />
        {control && (
          <button
            type="button"
            class="primary"
            disabled={!usable || left.value === "" || right.value === "" || left.value === right.value}
            onClick={() => void compare()}
          >
            {t("compare.go")}
          </button>
        )}
      </div>
      {!control && <p class="muted">{t("compare.view")}</p>}
      <p role="status" class="muted">
        {work.value &&
          (work.value.total > 0
            ? t("compare.progress", { text: work.value.text, done: work.value.done, total: work.value.total })
            : work.value.text)}
      </p>
      {failure.value !== "" && (
        <p class="fault" role="alert">
          <bdi>{sentence(failure.value)}</bdi>
        </p>
      )}
      {files.value === null && failure.value === "" && <Loading key={id} what={t("loading.files")} count={6} />}
      {compared.value === null && work.value !== null && <Bars count={6} />}
      {compared.value === null && work.value === null && files.value !== null && (
        <p class="muted">{t("compare.empty")}</p>
      )}
      {compared.value && (
        <Differences
          {...compared.value}
          usable={work.value === null && silent.value === null}
          makePlan={(wanted) => void makePlan(wanted)}
        />
      )}
      {planned && (
        <section class="review" aria-label={t("plan.title")}>
          <h2>{t(planned.phase === "planned" ? "plan.title" : "compare.restored")}</h2>
          {planned.phase !== "planned" && <p role="status">{sentence(planned.plan?.summary ?? "")}</p>}
          <Plan job={planned} />
          {planned.phase === "planned" && (
            <p class="buttons">
              <button
                type="button"
                class="primary"
                disabled={!usable || planned.plan?.ready !== true}
                onClick={() => void apply()}
              >
                {t("plan.apply", { count: planned.plan?.changes.length ?? 0 })}
              </button>
              <button
                type="button"
                onClick={() => {
                  plan.value = null;
                }}
              >
                {t("plan.discard")}
              </button>
            </p>
          )}
        </section>
      )}
    </article>
  );
}
