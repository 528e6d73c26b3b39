/** The stations that are selected, and what is done with all of them. */
import { signal } from "@preact/signals";
import { type Info, type Job, post, request, type Station } from "../../api";
import { label } from "../../parts/format";
import { follow, reason } from "../../store/jobs";
import { whenRestarted } from "../../store/store";
import { t } from "../../text";

export const chosen = signal<ReadonlySet<string>>(new Set());
/** The identities that were read last; nothing before. */
export const identities = signal<{ id: string; info: Info | null; failed: string }[] | null>(null);
whenRestarted(() => {
  chosen.value = new Set();
  identities.value = null;
});
/** Time for the identity of a drive with all its records, in ms. */
const IDENTITY = 20_000;
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

/** Reads who these drives are, with their modules and neighbours, all at once. */
export async function readIdentities(all: readonly Station[]): Promise<void> {
  const read = all.map(async ({ id }) => {
    const path = `drives/${encodeURIComponent(id)}/info`;
    try {
      return { id, info: await request<Info>(path, { signal: AbortSignal.timeout(IDENTITY) }), failed: "" };
    } catch (error) {
      return { id, info: null, failed: reason(error) };
    }
  });
  identities.value = await Promise.all(read);
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
