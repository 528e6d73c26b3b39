import { type Signal, signal } from "@preact/signals";

/** One value for each drive: what is chosen or confirmed for one counts for no other. */
export interface PerDrive<T> {
  /** The value of this drive. */
  of(id: string): Signal<T>;
  /** Puts back the value that each drive begins with. */
  forget(id: string): void;
}

export function perDrive<T>(first: T): PerDrive<T> {
  const known = new Map<string, Signal<T>>();
  const of = (id: string) => {
    const one = known.get(id) ?? signal(first);
    known.set(id, one);
    return one;
  };
  return {
    of,
    forget: (id) => {
      of(id).value = first;
    },
  };
}
