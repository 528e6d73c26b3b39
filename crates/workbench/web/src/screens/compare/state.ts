/** What is compared, and which of it is to be restored. */
import { signal } from "@preact/signals";
import type { Job } from "../../api";
import { whenRestarted } from "../../store/store";
import type { Row } from "./merge";

/** Both sides: `drive ID`, `file NAME`, or `delivered ID` for what a drive has as delivered. */
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
/** Whether the settings of the network are among the differences: name and address, and what belongs to the connection. */
export const network = signal(false);

whenRestarted(() => {
  compared.value = null;
  plan.value = null;
  picked.value = new Set();
});

export interface Compared {
  job: Job;
  left: string;
  right: string;
  base: string;
  rows: Row[];
}

/** What a drive takes values from. */
export interface Restorable {
  id: string;
  /** The file; nothing for the values as delivered. */
  file: string | null;
  /** The side that has them. */
  from: "left" | "right";
}

/** Returns what can be restored where one side is a drive, and the other one a file or values as delivered. */
export function restorable(sides: { left: string; right: string }): Restorable | null {
  const from = sides.left.startsWith("drive ") ? "right" : "left";
  const [drive, other] = from === "right" ? [sides.left, sides.right] : [sides.right, sides.left];
  if (!drive.startsWith("drive ") || other.startsWith("drive ") || other === "") return null;
  return { id: drive.slice(6), file: other.startsWith("file ") ? other.slice(5) : null, from };
}
