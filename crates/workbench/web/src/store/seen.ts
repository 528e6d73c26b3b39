/** When this page saw a fault first, on whichever screen, and what its drive was like then. */
import type { Station } from "../api";
import { whenRestarted } from "./store";

export interface Seen {
  time: Date;
  status: Station["status"];
}

/** By drive and number; forgotten when the fault goes. */
const seen = new Map<string, Seen>();
whenRestarted(() => seen.clear());

const key = (id: string, number: number) => `${id} ${number}`;

/** Notes the faults that a drive reports now. */
export function noteFaults({ id, status }: Station): void {
  if (status === null) return;
  const present = new Set(status.faults.map(({ number }) => key(id, number)));
  for (const known of [...seen.keys()]) {
    if (known.startsWith(`${id} `) && !present.has(known)) seen.delete(known);
  }
  for (const one of present) {
    if (!seen.has(one)) seen.set(one, { time: new Date(), status });
  }
}

/** Returns when a fault was seen first; now where that is not noted yet. */
export function firstSeen(id: string, number: number): Seen {
  return seen.get(key(id, number)) ?? { time: new Date(), status: null };
}
