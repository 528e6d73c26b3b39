/** What is recorded and what of it is shown: running, stopped, or waiting for a trigger. No socket, no clock of its own. */
import { type Block, columnOf, type Header } from "./block";
import { type Derived, type Difference, derived, difference } from "./maths";
import { Ring } from "./ring";
import { type Condition, Watch } from "./trigger";

export type Mode = "off" | "auto" | "normal" | "single";

/** When something is recorded. */
export interface Trigger {
  mode: Mode;
  condition: Condition;
  /** Which part of the picture is before the trigger, 0 to 0.9. */
  pre: number;
}

/** A part of the time, in us of the engine. */
export interface Span {
  from: number;
  to: number;
}

/** The time that is kept, in us. */
export const BUFFER = 600e6;
/** In the mode auto the picture runs after this time without a trigger, in us. */
const AUTO = 1e6;
/** Blocks that are dropped or lost are gaps; of a gap without a number of rows this many periods pass. */
const PAUSE = 5;

export class Acquisition {
  /** What is recorded: the columns that come, and those that are calculated. */
  header: Header | null = null;
  /** The same without what is calculated. */
  private plain: Header | null = null;
  private maths: readonly Difference[] = [];
  private derived: Derived[] = [];
  /** The stream that is recorded now; blocks of another one are not. */
  private stream: number | null = null;
  ring: Ring | null = null;
  running = true;
  trigger: Trigger = { mode: "off", condition: { kind: "fault" }, pre: 0.2 };
  /** The time that a picture spans, in us. */
  span = 5e6;
  /** What is shown in place of what runs. */
  shown: Span | null = null;
  /** The time of the trigger of what is shown. */
  zero: number | null = null;
  /** Rows that were lost since the recording began. */
  lost = 0;
  /** Rows whose values the drive marked as not valid. */
  bad = 0;
  /** Blocks that were not valid. */
  dropped = 0;
  private watch: Watch | null = null;
  /** The time of a trigger whose picture is not complete yet. */
  private hit: number | null = null;
  private armedAt = 0;
  private breaks = false;
  /** The stream that came while nothing was recorded. */
  private pending: Header | null = null;

  /** Begins a stream. Where its columns are those of before, what is recorded goes on behind a gap. */
  begin(header: Header): void {
    if (!this.running) {
      this.pending = header;
      return;
    }
    this.pending = null;
    const same = this.plain !== null && JSON.stringify(this.plain.columns) === JSON.stringify(header.columns);
    this.takeOver(header);
    this.stream = header.id;
    if (same && this.ring !== null) {
      this.breaks = true;
      return;
    }
    this.ring = null;
    this.breaks = false;
    this.lost = 0;
    this.bad = 0;
    this.shown = null;
    this.zero = null;
    if (header.columns.length > 0) {
      const rows = header.period_us > 0 ? BUFFER / header.period_us : BUFFER;
      this.ring = new Ring(this.header?.columns ?? [], Math.min(rows, BUFFER / 1000));
    }
    this.arm();
  }

  /** Notes what comes, and what is calculated of it. */
  private takeOver(header: Header): void {
    this.plain = header;
    this.derived = derived(header.columns, this.maths);
    this.header = { ...header, columns: [...header.columns, ...this.derived.map(({ column }) => column)] };
  }

  private calculated(cells: readonly ArrayLike<number>[]): Float64Array[] {
    return this.derived.map((one) => difference(this.plain?.columns ?? [], cells, one));
  }

  /** Calculates these signals from now on, and of what is recorded. */
  calculate(maths: readonly Difference[]): void {
    this.maths = maths;
    const { plain, ring } = this;
    if (plain === null) return;
    this.takeOver(plain);
    if (ring === null) return;
    const columns = this.header?.columns ?? [];
    if (JSON.stringify(columns) === JSON.stringify(ring.columns)) return;
    // rows are numbered from the first one that is kept: what watches them begins anew
    this.ring = ring.with(columns, plain.columns.length, (cells) => this.calculated(cells));
    if (this.running) this.arm();
  }

  /** Takes a block; returns whether something was recorded. */
  take(block: Block | null): boolean {
    if (block === null) {
      this.dropped += 1;
      return false;
    }
    const ring = this.ring;
    if (!this.running || ring === null || block.stream !== this.stream || block.rows === 0) return false;
    const last = ring.next === 0 ? 0 : ring.time(ring.next - 1);
    // columns that are others, or a time that runs backwards: of another stream than it says
    const plain = this.plain?.columns ?? [];
    if (block.columns !== plain.length || (block.times[0] ?? 0) < last) {
      this.dropped += 1;
      return false;
    }
    const paused = this.breaks && (block.times[0] ?? 0) - last > PAUSE * Math.max(block.period, 1);
    if (ring.next > 0) this.lost += block.lost;
    if (block.bad) this.bad += block.rows;
    const cells = plain.map((column, place) => columnOf(block, place, column.type));
    ring.add(block.times, [...cells, ...this.calculated(cells)], block.gap || paused, block.lost);
    this.breaks = false;
    this.look();
    return true;
  }

  /** The time of the newest row. */
  get latest(): number {
    return this.ring === null || this.ring.next === 0 ? 0 : this.ring.time(this.ring.next - 1);
  }

  private look(): void {
    if (this.trigger.mode === "off" || this.ring === null) return;
    if (this.hit === null && this.watch !== null) {
      const row = this.watch.look();
      if (row !== null) this.hit = this.ring.time(row);
    }
    const { pre, mode } = this.trigger;
    if (this.hit === null) {
      if (mode === "auto" && this.latest - this.armedAt > Math.max(this.span, AUTO)) {
        this.shown = null;
        this.zero = null;
      }
      return;
    }
    const to = this.hit + (1 - pre) * this.span;
    if (this.latest < to) return;
    this.shown = { from: this.hit - pre * this.span, to };
    this.zero = this.hit;
    if (mode === "single") this.running = false;
    else this.arm();
  }

  /** Whether a trigger is waited for, or its picture is. */
  get waits(): boolean {
    return this.running && this.trigger.mode !== "off" && (this.trigger.mode === "single" || this.shown === null);
  }

  /** Whether the condition of the trigger looks at something that is there. */
  get able(): boolean {
    return this.watch?.able ?? false;
  }

  private arm(): void {
    this.hit = null;
    this.armedAt = this.latest;
    this.watch =
      this.ring !== null && this.trigger.mode !== "off"
        ? new Watch(this.ring, this.trigger.condition, this.ring.next)
        : null;
  }

  set(trigger: Trigger): void {
    this.trigger = { ...trigger, pre: Math.min(0.9, Math.max(0, trigger.pre)) };
    if (this.running) {
      this.shown = null;
      this.zero = null;
      this.arm();
    }
  }

  /** Records, from now on. */
  run(): void {
    if (this.running) return;
    this.running = true;
    this.shown = null;
    this.zero = null;
    this.breaks = true;
    if (this.pending !== null) this.begin(this.pending);
    else this.arm();
  }

  /** Stops; what is shown stays. */
  stop(): void {
    if (!this.running) return;
    this.shown ??= this.view();
    this.running = false;
  }

  /** Records the next event, with nothing that an earlier one has left in the picture. */
  single(trigger: Trigger): void {
    this.run();
    this.set({ ...trigger, mode: "single" });
  }

  /** Shows what a file has. */
  open(header: Header, ring: Ring): void {
    this.plain = header;
    this.header = header;
    this.derived = [];
    this.stream = null;
    this.ring = ring;
    this.running = false;
    this.calculate(this.maths);
    this.lost = ring.gaps.reduce((sum, gap) => sum + gap.lost, 0);
    this.zero = null;
    this.shown = { from: ring.time(ring.first), to: this.latest };
  }

  /** Forgets everything, as for another drive. */
  clear(): void {
    Object.assign(this, new Acquisition(), { trigger: this.trigger, span: this.span, maths: this.maths });
  }

  /** What a picture shows. */
  view(): Span {
    if (this.shown !== null) return this.shown;
    // a recording that is shorter than the picture begins at its left
    const begin = this.ring === null || this.ring.next === 0 ? 0 : this.ring.time(this.ring.first);
    const from = Math.max(begin, this.latest - this.span);
    return { from, to: from + this.span };
  }

  /** Rows in a second as they came in the last two. */
  rate(): number | null {
    const ring = this.ring;
    if (ring === null || ring.next - ring.first < 3) return null;
    const last = ring.next - 1;
    const first = Math.max(ring.rowAt(ring.time(last) - 2e6), ring.first);
    const time = ring.time(last) - ring.time(first);
    return time > 0 ? ((last - first) * 1e6) / time : null;
  }
}
