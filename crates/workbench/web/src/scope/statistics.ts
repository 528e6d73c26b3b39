/** What the values between two moments are like. */
import type { Ring } from "./ring";

export interface Statistics {
  rows: number;
  first: number;
  last: number;
  low: number;
  high: number;
  mean: number;
  /** Root of the mean of squares. */
  rms: number;
}

/** Returns the statistics of a column over the rows from `from` to before `to`; nothing without a value. */
export function statistics(ring: Ring, place: number, from: number, to: number): Statistics | null {
  let [rows, sum, squares] = [0, 0, 0];
  let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  let [first, last] = [Number.NaN, Number.NaN];
  ring.each(place, from, to, (value) => {
    if (rows === 0) first = value;
    last = value;
    rows += 1;
    sum += value;
    squares += value * value;
    if (value < low) low = value;
    if (value > high) high = value;
  });
  if (rows === 0) return null;
  return { rows, first, last, low, high, mean: sum / rows, rms: Math.sqrt(squares / rows) };
}

/** Returns the row that is nearest to a time; nothing where there is none. */
export function nearest(ring: Ring, time: number): number | null {
  if (ring.next === ring.first) return null;
  const behind = Math.min(ring.rowAt(time), ring.next - 1);
  const before = Math.max(ring.first, behind - 1);
  return time - ring.time(before) < ring.time(behind) - time ? before : behind;
}
