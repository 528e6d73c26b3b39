/** Signals that are calculated: the difference of two others. */
import type { Column } from "./block";
import { isNothing } from "./ring";

/** Differences of one layout, at most. */
export const MOST = 4;

/** A difference that is wanted: of two columns by their names, and how it is kept in a layout. */
export interface Difference {
  key: string;
  a: string;
  b: string;
}

/** A column that is the difference of two others, by their places. */
export interface Derived {
  column: Column;
  a: number;
  b: number;
}

/** Returns the columns that differences have: of numbers that are there, in the same unit. */
export function derived(columns: readonly Column[], wanted: readonly Difference[]): Derived[] {
  return wanted.flatMap(({ key, a, b }) => {
    const [placeA, placeB] = [a, b].map((name) => columns.findIndex((column) => column.name === name));
    const [first, second] = [columns[placeA ?? -1], columns[placeB ?? -1]];
    const name = `${a} - ${b}`;
    // a file has it already
    if (columns.some((column) => column.name === name)) return [];
    if (!first || !second || first.type === "u32" || second.type === "u32" || first.unit !== second.unit) return [];
    const column: Column = {
      name,
      role: key,
      unit: first.unit,
      type: "f64",
      scale: 1,
      bits: null,
      from: null,
    };
    return [{ column, a: placeA ?? 0, b: placeB ?? 0 }];
  });
}

/** Returns the differences of rows; no number where one of both is missing. */
export function difference(
  columns: readonly Column[],
  cells: readonly ArrayLike<number>[],
  { a, b }: Derived,
): Float64Array {
  const of = (place: number, row: number) => {
    const column = columns[place];
    const raw = cells[place]?.[row];
    if (column === undefined || raw === undefined || isNothing(column.type, raw)) return Number.NaN;
    return raw * column.scale;
  };
  return Float64Array.from({ length: cells[a]?.length ?? 0 }, (_, row) => of(a, row) - of(b, row));
}
