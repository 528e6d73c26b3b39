/** What is compared, and which of it is to be restored. */
import { signal } from "@preact/signals";
import type { Job } from "../../api";
import type { Row } from "./merge";

/** Both sides: `drive ID` or `file NAME`. */
export const left = signal("");
export const right = signal("");
/** What both are compared with: empty, or the same as a side. */
export const base = signal("");
/** The last comparison. */
export const compared = signal<Compared | null>(null);
/** The plan of what is restored. */
export const plan = signal<Job | null>(null);
/** The differences that are taken from the file. */
export const picked = signal<ReadonlySet<string>>(new Set());
export const save = signal(false);

export interface Compared {
  job: Job;
  left: string;
  right: string;
  base: string;
  rows: Row[];
}

/** Returns the drive and the file where one side is each. */
export function restorable(sides: { left: string; right: string }): { id: string; file: string } | null {
  const all = [sides.left, sides.right];
  const id = all.find((side) => side.startsWith("drive "))?.slice(6);
  const file = all.find((side) => side.startsWith("file "))?.slice(5);
  return id === undefined || file === undefined ? null : { id, file };
}
