/** Finds the row at which something happens. */
import type { Ring } from "./ring";

/** What is waited for. */
export type Condition =
  /** A signal goes through a level. */
  | { kind: "edge"; signal: string; edge: "rising" | "falling" | "either"; level: number }
  /** A bit of a word changes. */
  | { kind: "bit"; signal: string; bit: number; edge: "rising" | "falling" | "either" }
  /** The drive begins to report a fault. */
  | { kind: "fault" }
  /** A signal leaves the value that it has had. */
  | { kind: "change"; role: string };

/** Bit 3 of the status word: a fault is present. */
const FAULT = 3;

/** Which column a condition looks at; -1 where it is not there. */
function placeOf(ring: Ring, condition: Condition): number {
  const find = (key: "name" | "role", value: string) => ring.columns.findIndex((column) => column[key] === value);
  switch (condition.kind) {
    case "fault":
      return find("role", "status");
    case "change": {
      // a drive that is positioned has no speed in its telegram, and moves by its control word
      const place = find("role", condition.role);
      return place >= 0 ? place : find("role", "control");
    }
    default:
      return find("name", condition.signal);
  }
}

/** Returns what a condition looks at, as a number whose sign changes. */
function measure(condition: Condition, value: number, start: number): number {
  switch (condition.kind) {
    case "edge":
      return value - condition.level;
    case "bit":
      return (value >>> condition.bit) & 1 ? 1 : -1;
    case "fault":
      return (value >>> FAULT) & 1 ? 1 : -1;
    case "change":
      return value === start ? -1 : 1;
  }
}

/** Looks at each row once. */
export class Watch {
  private row: number;
  private before = Number.NaN;
  /** The value that a change begins from. */
  private start = Number.NaN;

  constructor(
    private readonly ring: Ring,
    readonly condition: Condition,
    from: number,
  ) {
    this.row = from;
  }

  /** Returns whether the column of the condition is there. */
  get able(): boolean {
    return placeOf(this.ring, this.condition) >= 0;
  }

  /** Looks at the rows that have come; returns the first at which it happens. A gap is no event: what was before it is forgotten. */
  look(): number | null {
    const place = placeOf(this.ring, this.condition);
    if (place < 0) {
      this.row = this.ring.next;
      return null;
    }
    for (let row = Math.max(this.row, this.ring.first); row < this.ring.next; row += 1) {
      const value = this.ring.value(place, row);
      if (Number.isNaN(value)) continue;
      if (Number.isNaN(this.start)) this.start = value;
      const now = measure(this.condition, value, this.start);
      const before = this.ring.gaps.some((gap) => gap.row === row) ? Number.NaN : this.before;
      this.before = now;
      const edge = this.condition.kind === "edge" || this.condition.kind === "bit" ? this.condition.edge : "rising";
      const rises = before < 0 && now >= 0;
      const falls = before >= 0 && now < 0;
      if ((rises && edge !== "falling") || (falls && edge !== "rising")) {
        this.row = row + 1;
        return row;
      }
    }
    this.row = this.ring.next;
    return null;
  }
}
