/** What the page and the worker of the Scope send to each other. */

import type { Span, Trigger } from "./acquisition";
import type { Header } from "./block";
import type { Difference } from "./maths";
import type { Statistics } from "./statistics";

/** Which source is wanted: the best there is, or readings of parameters. */
export type Wanted = "auto" | "acyclic";

/** A signal by its name, or a bit of it: `ZSW1.3`. */
export type Signal = string;

export type ToWorker =
  | { type: "open"; drive: string; address: string; parameters: string[]; wanted: Wanted }
  | { type: "close" }
  /** Forgets what is recorded: the drive is no more, and another one has its place. */
  | { type: "forget" }
  | { type: "visible"; visible: boolean }
  /** The page has taken a picture: the next one may come. */
  | { type: "drawn" }
  /** What is shown: columns by name, so many pixels wide, a time in us, cursors as parts of the picture. */
  | { type: "show"; columns: string[]; pixels: number; span: number; cursors: [number, number] | null }
  /** Shows another part of what is recorded, of a stopped recording. */
  | { type: "move"; view: Span }
  | { type: "run" }
  | { type: "stop" }
  | { type: "single"; trigger: Trigger }
  | { type: "trigger"; trigger: Trigger }
  /** Calculates these signals, of what is recorded too. */
  | { type: "calculate"; maths: Difference[] }
  /** Wants everything as a file, or what is between the cursors. */
  | { type: "save"; between: boolean; drive: string }
  | { type: "load"; text: string; name: string }
  /** Keeps what is shown beside what comes, or forgets it. */
  | { type: "overlay"; keep: boolean }
  /** Signals of this program instead of a drive: so many columns and rows in a second. */
  | { type: "generate"; columns: number; rate: number };

export interface Status {
  type: "status";
  /** How many messages of the page it knows. */
  obeyed: number;
  /** The drive, or the name of a file. */
  drive: string;
  header: Header | null;
  connected: boolean;
  running: boolean;
  /** Whether a trigger is waited for, and whether what it looks at is there. */
  waits: boolean;
  able: boolean;
  /** Rows in a second, measured; rows that are kept, lost since the beginning, without valid values, and blocks that cannot be read. */
  rate: number | null;
  rows: number;
  lost: number;
  bad: number;
  dropped: number;
  /** Why there are no values. */
  reason: string | null;
  /** The whole time that is kept, in us of the engine. */
  kept: Span | null;
  /** The parts of it in which nothing was recorded, as long as a person sees. */
  pauses: Span[];
  octets: number;
}

/** The values of a column. */
export interface Measured {
  name: string;
  /** At the cursors. */
  a: number;
  b: number;
  between: Statistics | null;
}

export interface Frame {
  type: "frame";
  view: Span;
  /** Where the cursors are, in us of the engine. */
  cursors: [number, number] | null;
  /** The time that counts as 0, in us of the engine. */
  zero: number;
  triggered: boolean;
  columns: string[];
  times: Float64Array;
  values: Float64Array[];
  gaps: { from: number; to: number; lost: number }[];
  /** An earlier run, moved to this picture. */
  overlay: { times: Float64Array; values: Float64Array[]; columns: string[] } | null;
  /** Between the cursors, else of the whole picture. */
  measured: Measured[];
}

export type FromWorker = Status | Frame | { type: "saved"; text: string } | { type: "failed"; text: string };
