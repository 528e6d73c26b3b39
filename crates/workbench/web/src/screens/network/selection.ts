/** The stations that are selected, and what is done with all of them. */
import { signal } from "@preact/signals";
import { type Job, post, type Station } from "../../api";
import { label } from "../../parts/format";
import { follow, reason } from "../../store/jobs";
import { t } from "../../text";

export const chosen = signal<ReadonlySet<string>>(new Set());
/** Whether settings are saved now. */
export const saving = signal(false);
/** What became of it. */
export const saved = signal<{ text: string; failed: boolean } | null>(null);

export function choose(id: string, on: boolean): void {
  const next = new Set(chosen.value);
  if (on) next.add(id);
  else next.delete(id);
  chosen.value = next;
}

/** Returns whether parameters of a station can be read. */
export function isReadable(station: Station): boolean {
  return station.status !== null && station.lost === null;
}

/** Saves all settings of these drives, one after the other. One that fails does not keep the others from it. */
export async function backUp(all: readonly Station[]): Promise<void> {
  if (saving.value) return;
  saving.value = true;
  const files: string[] = [];
  const failed: string[] = [];
  for (const station of all) {
    const name = label(station);
    const work = t("network.backup.saving", { name, done: files.length + failed.length, all: all.length });
    try {
      const begun = await post<Job>(`drives/${encodeURIComponent(station.id)}/backups`, {});
      const job = await follow(begun, ({ done, total }) => {
        saved.value = { text: `${work} ${total > 0 ? `${done}/${total}` : ""}`.trim(), failed: false };
      });
      if (job.file !== null) files.push(job.file);
      failed.push(...job.remarks);
    } catch (error) {
      failed.push(`${name}: ${reason(error)}`);
    }
  }
  const text = t("network.backup.saved", { count: files.length, all: all.length, files: files.join(", ") });
  saved.value = { text: [text, ...failed].join(" "), failed: failed.length > 0 };
  saving.value = false;
}
