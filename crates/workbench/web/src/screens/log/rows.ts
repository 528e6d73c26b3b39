/** The log as rows: what was requested, and what became of it. */
import type { LogPage } from "../../api";

export type Record = LogPage["records"][number];

/** One action. */
export interface Row {
  /** Its result; the request where there is none yet. */
  record: Record;
  /** When it was requested, where that is another record. */
  requested: string | null;
}

function same({ boot, who, drive, action, value }: Record): string {
  return JSON.stringify([boot, who, drive, action, value]);
}

/** Returns a row for each action of these records, the newest first, as they are. */
export function rows(records: readonly Record[]): Row[] {
  const all: Row[] = [];
  const results = new Map<string, Row[]>();
  for (const record of records) {
    const key = same(record);
    if (record.result !== null) {
      const row = { record, requested: null };
      results.set(key, [...(results.get(key) ?? []), row]);
      all.push(row);
      continue;
    }
    // of equal actions the later request has the later result
    const result = results.get(key)?.shift();
    if (result === undefined) {
      all.push({ record, requested: null });
      continue;
    }
    result.requested = record.time;
    if (result.record.changes.length === 0) result.record = { ...result.record, changes: record.changes };
  }
  return all;
}
