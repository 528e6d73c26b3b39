/** Samples as lines of text, in the form of `profidrive record`: `t`, `wall`, `drive`, `gap`, then the signals with their units. */
import { type Column, NO_WORD } from "./block";
import { Ring } from "./ring";

/** Lines for one gap, at most, as a recording has them. */
const MOST_GAPS = 1000;
/** A longer text is not opened, in characters, and no more columns. */
export const LONGEST = 256 << 20;
const MOST_COLUMNS = 64;

/** What signals of the profile are, whoever wrote the file. */
const ROLES: Record<string, string> = {
  STW1: "control",
  ZSW1: "status",
  NSOLL_A: "speed_set",
  NIST_A: "speed",
  XIST_A: "position",
};

/** Numbers of one drive, and what they are called. */
export interface Sheet {
  drive: string;
  ring: Ring;
}

/** A text that a spreadsheet would take for a formula is marked as text. */
function field(text: string): string {
  const safe = /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/** Returns the shortest number that is this value of 32 bits. */
export function shortest(value: number): string {
  for (let digits = 6; digits <= 9; digits += 1) {
    const text = Number(value.toPrecision(digits));
    if (Math.fround(text) === value) return String(text);
  }
  return String(value);
}

/** Returns a time in s with nine decimals, without rounding. */
function seconds(us: number): string {
  const whole = Math.floor(us / 1e6);
  const rest = Math.round((us - whole * 1e6) * 1000);
  return rest >= 1e9 ? `${whole + 1}.000000000` : `${whole}.${String(rest).padStart(9, "0")}`;
}

/** Where times of the engine are in the time of day. */
export interface Clock {
  t_us: number;
  unix_ms: number;
}

/** Returns the time of day of a time of the engine in us: `2026-11-26 20:58:24.169 UTC`. Nothing where they were not compared. */
export function recordedAt(clock: Clock | null, time: number | null): string | null {
  if (clock === null || clock.unix_ms === 0 || time === null) return null;
  const at = new Date(clock.unix_ms + (time - clock.t_us) / 1000);
  return at.toISOString().replace("T", " ").replace("Z", " UTC");
}

/**
 * Writes the rows from `from` to before `to`. Numbers have a point, times of day are UTC. The lines of a gap are spread evenly over it,
 * so that a file that was read is written as it was.
 */
export function write(sheet: Sheet, from: number, to: number, clock: Clock | null): string {
  const { ring, drive } = sheet;
  const begin = Math.max(from, ring.first);
  const end = Math.min(to, ring.next);
  const name = ({ name, unit }: Column) => field(unit === "" ? name : `${name} [${unit}]`);
  const lines = [["t", "wall", "drive", "gap", ...ring.columns.map(name)].join(",")];
  const start = ring.time(begin);
  const named = field(drive);
  const line = (time: number, gap: boolean, values: string[]) => {
    const unix = clock === null ? null : clock.unix_ms + (time - clock.t_us) / 1000;
    const wall = unix === null ? "" : new Date(unix).toISOString();
    lines.push([seconds(time - start), wall, named, String(gap), ...values].join(","));
  };
  const nothing = ring.columns.map(() => "");
  const gaps = new Map(ring.gaps.map((gap) => [gap.row, gap.lost]));
  for (let row = begin; row < end; row += 1) {
    const time = ring.time(row);
    const lost = gaps.get(row);
    if (lost !== undefined && row > begin) {
      const before = ring.time(row - 1);
      const count = Math.min(Math.max(1, lost), MOST_GAPS);
      const step = (time - before) / (count + 1);
      for (let one = 1; one <= count; one += 1) line(before + Math.round(one * step), true, nothing);
    }
    const values = ring.columns.map((column, place) => {
      const value = ring.value(place, row);
      if (Number.isNaN(value)) return "";
      return column.type === "f32" ? shortest(value) : String(value);
    });
    line(time, false, values);
  }
  return `${lines.join("\n")}\n`;
}

/** Splits a line into its fields. */
function split(line: string): string[] {
  const fields: string[] = [];
  for (const match of line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^",]*))/g)) {
    fields.push(match[1] !== undefined ? match[1].replaceAll('""', '"') : (match[2] ?? ""));
  }
  return fields;
}

function text(field: string): string {
  return /^'[=+\-@\t\r]/.test(field) ? field.slice(1) : field;
}

/**
 * Reads lines that `write` or `profidrive record` wrote; of several drives the first one. `known` has the bits of words by their names.
 * Fails with the number of the line that is wrong.
 */
export function read(lines: string, known: readonly Column[]): Sheet {
  if (lines.length > LONGEST) throw new Error(`the file is longer than ${LONGEST >> 20} MiB`);
  const all = lines.split(/\r?\n/);
  const head = split(all[0] ?? "").map(text);
  if (head.slice(0, 4).join(",") !== "t,wall,drive,gap" || head.length < 5 || head.length > 4 + MOST_COLUMNS) {
    throw new Error("line 1: not the columns of a recording: t, wall, drive, gap, then signals");
  }
  const columns = head.slice(4).map((title): Column => {
    const unit = /^(.*) \[([^\]]*)\]$/.exec(title);
    const name = unit?.[1] ?? title;
    const old = known.find((column) => column.name === name);
    const word = old ? old.type === "u32" : /^(STW|ZSW)\d/.test(name);
    return {
      name,
      role: old?.role ?? ROLES[name] ?? "",
      unit: unit?.[2] ?? "",
      type: word ? "u32" : "f64",
      scale: 1,
      bits: word ? (old?.bits ?? []) : null,
      from: null,
    };
  });
  const ring = new Ring(columns, all.length);
  let drive: string | null = null;
  let lost = 0;
  for (let number = 1; number < all.length; number += 1) {
    const line = all[number] ?? "";
    if (line === "") continue;
    const fields = split(line);
    const time = Number(fields[0]) * 1e6;
    if (fields.length !== head.length || fields[0] === "" || !Number.isFinite(time)) {
      throw new Error(`line ${number + 1}: ${fields.length} fields of ${head.length}, or no time`);
    }
    drive ??= text(fields[2] ?? "");
    if (text(fields[2] ?? "") !== drive) continue;
    if (fields[3] === "true") {
      lost += 1;
      continue;
    }
    const values = columns.map((column, place) => {
      const value = fields[4 + place] ?? "";
      if (value === "") return [column.type === "u32" ? NO_WORD : Number.NaN];
      const found = Number(value);
      if (Number.isNaN(found)) throw new Error(`line ${number + 1}: \`${value.slice(0, 40)}\` is not a number`);
      return [found];
    });
    // times are whole microseconds but in files of other clocks
    ring.add([Math.round(time * 1000) / 1000], values, lost > 0, lost);
    lost = 0;
  }
  if (ring.next === 0) throw new Error("the file has no row with values");
  return { drive: drive ?? "", ring };
}
