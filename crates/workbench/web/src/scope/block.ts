/** The layout of a block of samples: `crates/workbench/src/live/block.rs` writes what this reads. */

const HEAD = 32;
/** A longer block is not read, in octets. */
const LONGEST = 1 << 20;

/** A value that is missing in a column of whole numbers or words. */
export const NO_INTEGER = -0x8000_0000;
export const NO_WORD = 0xffff_ffff;

/** `f64` is of files only. */
export type Kind = "f32" | "i32" | "u32" | "f64";

/** One column of a stream. */
export interface Column {
  name: string;
  /** What it is: `speed`, `speed_set`, `position`, `control`, `status`; empty for the rest. */
  role: string;
  unit: string;
  type: Kind;
  /** A number of the column times this is the value in its unit. */
  scale: number;
  /** The names of the bits of a word, bit 0 first. */
  bits: string[] | null;
  /** The parameter that it is read from. */
  from: string | null;
}

/** Precedes the blocks of a stream. */
export interface Header {
  topic: string;
  id: number;
  source: "cyclic" | "acyclic" | "none" | "file" | "test";
  reason: string | null;
  period_us: number;
  telegram: number | null;
  simulation: boolean;
  /** Engine time, us, and the time of day at that moment, ms since 1970. */
  t_us: number;
  unix_ms: number;
  columns: Column[];
  refused: [string, string][];
}

/** The rows of a block. */
export interface Block {
  stream: number;
  number: number;
  /** Nominal time between two rows, us. */
  period: number;
  rows: number;
  columns: number;
  /** Rows that are missing before the first. */
  lost: number;
  gap: boolean;
  /** Whether the drive marked its data as not valid (IOPS): then there are no actual values. */
  bad: boolean;
  simulation: boolean;
  /** Engine time of each row, us. */
  times: Float64Array;
  /** The octets of the columns, one after another. */
  octets: ArrayBuffer;
  /** Where the first column begins. */
  start: number;
}

/** Reads a block; nothing where it is not one of this version, or its lengths do not fit. */
export function decode(octets: ArrayBuffer): Block | null {
  if (octets.byteLength < HEAD || octets.byteLength > LONGEST) return null;
  const view = new DataView(octets);
  if (view.getUint8(0) !== 1 || view.getUint8(1) !== 1 || view.getUint16(30, true) !== 0) return null;
  const rows = view.getUint16(20, true);
  const columns = view.getUint16(22, true);
  const flags = view.getUint16(28, true);
  const period = view.getFloat32(16, true);
  const offsets = (flags & 1) !== 0;
  const start = HEAD + (offsets ? rows * 4 : 0);
  if (octets.byteLength !== start + rows * columns * 4 || !(period >= 0 && period < 1e12)) return null;
  const first = Number(view.getBigUint64(8, true));
  // times above this are no whole numbers of a script
  if (first > Number.MAX_SAFE_INTEGER - 0xffff_ffff) return null;
  const times = new Float64Array(rows);
  for (let row = 0; row < rows; row += 1) {
    const offset = offsets ? view.getUint32(HEAD + row * 4, true) : row * period;
    times[row] = first + offset;
    if (row > 0 && (times[row] ?? 0) < (times[row - 1] ?? 0)) return null;
  }
  return {
    stream: view.getUint16(2, true),
    number: view.getUint32(4, true),
    period,
    rows,
    columns,
    lost: view.getUint32(24, true),
    gap: (flags & 2) !== 0,
    bad: (flags & 4) !== 0,
    simulation: (flags & 8) !== 0,
    times,
    octets,
    start,
  };
}

/** Returns a column of a block, without a copy. */
export function columnOf(block: Block, place: number, kind: Kind): Float32Array | Int32Array | Uint32Array {
  const from = block.start + place * block.rows * 4;
  if (kind === "f32") return new Float32Array(block.octets, from, block.rows);
  if (kind === "i32") return new Int32Array(block.octets, from, block.rows);
  return new Uint32Array(block.octets, from, block.rows);
}
