/** Who changed a parameter last, by the log. */
import type { LogPage } from "../../api";

type Record = LogPage["records"][number];

/** A record of the log, and its line about a parameter. */
export interface LastChange {
  record: Record;
  change: string;
}

/** Returns the last change of a parameter among records, the newest first; nothing where none was carried out. */
export function lastChange(records: readonly Record[], name: string): LastChange | null {
  // `DRV.ACC` is no part of `DRV.ACCZERO`
  const whole = new RegExp(`(^|[^\\w.])${name.replace(/[^\w]/g, "\\$&")}($|[^\\w.])`);
  for (const record of records) {
    const change = record.result === null ? undefined : record.changes.find((one) => whole.test(one));
    if (change !== undefined) return { record, change };
  }
  return null;
}
