/** The samples of one stream: rings with a pyramid of extremes above them, so that one sample of a spike stays visible. */
import { type Column, type Kind, NO_INTEGER, NO_WORD } from "./block";

/** Rows under one entry of each level of the pyramid. */
export const LEVELS = [16, 256, 4096] as const;

/** The most rows that are kept: ten minutes with a row each millisecond. */
export const MOST_ROWS = 602_112;

type Values = Float32Array | Float64Array | Int32Array | Uint32Array;

function values(kind: Kind, length: number): Values {
  if (kind === "f32") return new Float32Array(length);
  if (kind === "f64") return new Float64Array(length);
  return kind === "i32" ? new Int32Array(length) : new Uint32Array(length);
}

/** Extremes of some rows. Of a word: the bits that are set in each row, and in any. */
export interface Extremes {
  low: number;
  high: number;
  /** Whether there was a value at all. */
  some: boolean;
}

/** A place where rows are missing. */
export interface Gap {
  /** The row behind it. */
  row: number;
  lost: number;
}

const isWord = (column: Column): boolean => column.type === "u32";

/** Rows of a stream, the newest ones. Rows are numbered from the first that ever came. */
export class Ring {
  readonly times: Float64Array;
  private readonly cells: Values[];
  /** For each column and level the low and the high entries. */
  private readonly levels: [Values, Values][][];
  /** The number of the next row. */
  next = 0;
  gaps: Gap[] = [];
  readonly capacity: number;

  constructor(
    readonly columns: readonly Column[],
    rows: number,
  ) {
    // entries of the highest level begin at the same place in each round
    const highest = LEVELS[LEVELS.length - 1] ?? 1;
    // the oldest one is being written anew
    this.capacity = (Math.max(1, Math.ceil(Math.min(rows, MOST_ROWS) / highest)) + 1) * highest;
    this.times = new Float64Array(this.capacity);
    this.cells = columns.map((column) => values(column.type, this.capacity));
    this.levels = columns.map((column) =>
      LEVELS.map((rows) => [values(column.type, this.capacity / rows), values(column.type, this.capacity / rows)]),
    );
  }

  /** The number of the oldest row that is kept. */
  get first(): number {
    return Math.max(0, this.next - this.capacity + (LEVELS[LEVELS.length - 1] ?? 0));
  }

  /** Octets of all buffers. */
  get octets(): number {
    const all = [this.times, ...this.cells, ...this.levels.flat(2)];
    return all.reduce((sum, buffer) => sum + buffer.byteLength, 0);
  }

  /** Adds rows, with what is missing before them. */
  add(times: ArrayLike<number>, columns: readonly ArrayLike<number>[], gap: boolean, lost: number): void {
    if (gap && this.next > 0) {
      this.gaps.push({ row: this.next, lost });
      this.gaps = this.gaps.filter((one) => one.row > this.first);
    }
    for (let row = 0; row < times.length; row += 1) {
      const at = this.next % this.capacity;
      this.times[at] = times[row] ?? 0;
      for (let place = 0; place < columns.length; place += 1) {
        this.put(place, at, columns[place]?.[row] ?? 0);
      }
      this.next += 1;
    }
  }

  private put(place: number, at: number, value: number): void {
    const column = this.columns[place];
    const cells = this.cells[place];
    const levels = this.levels[place];
    if (column === undefined || cells === undefined || levels === undefined) return;
    cells[at] = value;
    const word = isWord(column);
    const nothing = isNothing(column.type, value);
    for (let level = 0; level < LEVELS.length; level += 1) {
      const rows = LEVELS[level] ?? 1;
      const pair = levels[level];
      if (pair === undefined) continue;
      const [low, high] = pair;
      const entry = Math.floor(at / rows);
      if (at % rows === 0) {
        // an entry without a value yet: low above high
        low[entry] = word ? NO_WORD : column.type === "i32" ? 0x7fff_ffff : Number.POSITIVE_INFINITY;
        high[entry] = word ? 0 : column.type === "i32" ? NO_INTEGER : Number.NEGATIVE_INFINITY;
      }
      if (nothing) continue;
      const [before, above] = [low[entry] ?? 0, high[entry] ?? 0];
      if (word) {
        low[entry] = before & value;
        high[entry] = above | value;
      } else {
        if (value < before) low[entry] = value;
        if (value > above) high[entry] = value;
      }
    }
  }

  time(row: number): number {
    return this.times[row % this.capacity] ?? 0;
  }

  /** Returns the number of a column at a row, in its unit; no number where it is missing. */
  value(place: number, row: number): number {
    const column = this.columns[place];
    const raw = this.cells[place]?.[row % this.capacity];
    if (column === undefined || raw === undefined || row < this.first || row >= this.next) return Number.NaN;
    return isNothing(column.type, raw) ? Number.NaN : raw * column.scale;
  }

  /** Calls `see` with the numbers of a column from `from` to before `to`, in its unit and without those that are missing. */
  each(place: number, from: number, to: number, see: (value: number) => void): void {
    const column = this.columns[place];
    const cells = this.cells[place];
    if (column === undefined || cells === undefined) return;
    const end = Math.min(to, this.next);
    let at = Math.max(from, this.first) % this.capacity;
    for (let row = Math.max(from, this.first); row < end; row += 1) {
      const raw = cells[at] ?? 0;
      if (!isNothing(column.type, raw)) see(raw * column.scale);
      at += 1;
      if (at === this.capacity) at = 0;
    }
  }

  /** Returns the times that are longer than this without a row between two that are kept. */
  pauses(longest: number): { from: number; to: number }[] {
    const spans = this.gaps.map(({ row }) => ({ from: this.time(row - 1), to: this.time(row) }));
    return spans.filter(({ from, to }) => to - from > longest);
  }

  /** Returns the first row at or behind a time. */
  rowAt(time: number): number {
    let [low, high] = [this.first, this.next];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Returns the extremes of the rows from `from` to before `to`, as they are in the column, without its scale. */
  extremes(place: number, from: number, to: number): Extremes {
    const column = this.columns[place];
    const cells = this.cells[place];
    const levels = this.levels[place];
    const found: Extremes = { low: 0, high: 0, some: false };
    if (column === undefined || cells === undefined || levels === undefined) return found;
    const word = isWord(column);
    const take = (low: number, high: number) => {
      if (!found.some) [found.low, found.high, found.some] = [low, high, true];
      else if (word) {
        found.low &= low;
        found.high |= high;
      } else {
        if (low < found.low) found.low = low;
        if (high > found.high) found.high = high;
      }
    };
    let row = Math.max(from, this.first);
    const end = Math.min(to, this.next);
    while (row < end) {
      let rows = 1;
      let level = -1;
      for (let one = 0; one < LEVELS.length; one += 1) {
        const step = LEVELS[one] ?? 1;
        if (row % step !== 0 || row + step > end) break;
        rows = step;
        level = one;
      }
      const at = row % this.capacity;
      if (level < 0) {
        const value = cells[at] ?? 0;
        if (!isNothing(column.type, value)) take(value, value);
      } else {
        const pair = levels[level];
        const entry = at / rows;
        const [low, high] = [pair?.[0][entry] ?? 0, pair?.[1][entry] ?? 0];
        // of a word without any value no bit is in any row, and each is in all
        const some = word ? !(low >>> 0 === NO_WORD && high === 0) : low <= high;
        if (some) take(low, high);
      }
      row += rows;
    }
    return found;
  }

  /** Returns the same rows with other columns behind the first `kept` of them: `more` makes those of the cells of a row. */
  with(columns: readonly Column[], kept: number, more: (cells: number[][]) => ArrayLike<number>[]): Ring {
    const copy = new Ring(columns, this.capacity - (LEVELS[LEVELS.length - 1] ?? 0));
    const gaps = new Map(this.gaps.map((gap) => [gap.row, gap.lost]));
    for (let row = this.first; row < this.next; row += 1) {
      const cells = this.cells.slice(0, kept).map((all) => [all[row % this.capacity] ?? 0]);
      const lost = gaps.get(row);
      copy.add([this.time(row)], [...cells, ...more(cells)], lost !== undefined, lost ?? 0);
    }
    return copy;
  }

  /** Returns what lies between two rows as a ring of its own. */
  slice(from: number, to: number): Ring {
    const begin = Math.max(from, this.first);
    const end = Math.min(to, this.next);
    const copy = new Ring(this.columns, end - begin);
    for (let row = begin; row < end; row += 1) {
      const gap = this.gaps.find((one) => one.row === row);
      const columns = this.cells.map((cells) => [cells[row % this.capacity] ?? 0]);
      copy.add([this.time(row)], columns, gap !== undefined && row > begin, gap?.lost ?? 0);
    }
    return copy;
  }
}

/** Returns whether a cell of a column has no value. */
export function isNothing(kind: Kind, value: number): boolean {
  if (kind === "f32" || kind === "f64") return Number.isNaN(value);
  return value === (kind === "i32" ? NO_INTEGER : NO_WORD);
}

/** Points of the signals for a picture: times, and for each signal as many values. */
export interface Picture {
  times: Float64Array;
  values: Float64Array[];
}

/**
 * Returns at most two points for each pixel and signal, of the rows from `from` to before `to`. Where there are fewer rows than points,
 * each row is one. Between rows with a gap stands a point without a value.
 */
export function picture(ring: Ring, places: readonly number[], from: number, to: number, pixels: number): Picture {
  const begin = Math.max(from, ring.first);
  const end = Math.max(begin, Math.min(to, ring.next));
  const times: number[] = [];
  const values: number[][] = places.map(() => []);
  const gaps = ring.gaps.filter((gap) => gap.row > begin && gap.row < end);
  const breakAt = (row: number) => {
    times.push((ring.time(row - 1) + ring.time(row)) / 2);
    for (const list of values) list.push(Number.NaN);
  };
  // a gap ends one piece and begins another
  const edges = [begin, ...gaps.map((gap) => gap.row), end];
  const whole = end - begin;
  for (let piece = 0; piece + 1 < edges.length; piece += 1) {
    const [first, last] = [edges[piece] ?? 0, edges[piece + 1] ?? 0];
    if (piece > 0) breakAt(first);
    if (whole <= pixels * 2) {
      for (let row = first; row < last; row += 1) {
        times.push(ring.time(row));
        places.forEach((place, index) => {
          values[index]?.push(ring.value(place, row));
        });
      }
      continue;
    }
    const span = Math.max(1, ring.time(end - 1) - ring.time(begin));
    const columns = Math.max(1, Math.round((pixels * (ring.time(last - 1) - ring.time(first))) / span));
    const width = (ring.time(last - 1) - ring.time(first)) / columns;
    let row = first;
    for (let pixel = 0; pixel < columns && row < last; pixel += 1) {
      const until = pixel === columns - 1 ? last : Math.min(last, ring.rowAt(ring.time(first) + (pixel + 1) * width));
      if (until <= row) continue;
      const time = ring.time(row);
      const half = (ring.time(until - 1) - time) / 2;
      times.push(time, time + half);
      places.forEach((place, index) => {
        const { low, high, some } = ring.extremes(place, row, until);
        const scale = ring.columns[place]?.scale ?? 1;
        const rising = ring.value(place, row) <= ring.value(place, until - 1);
        const pair = some ? [low * scale, high * scale] : [Number.NaN, Number.NaN];
        values[index]?.push(...(rising ? pair : pair.reverse()));
      });
      row = until;
    }
  }
  return { times: Float64Array.from(times), values: values.map((list) => Float64Array.from(list)) };
}
