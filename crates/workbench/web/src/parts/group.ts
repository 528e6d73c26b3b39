/** Groups of parameters, by how their vendor names or numbers them. */

/** Numbers of the profile begin here. */
const PROFILE = 900;

/** Returns the group of a parameter: what stands before the dot of its name (`DRV`) or the hyphen of its number (`3-`). */
export function groupOf({ name, number }: { name: string | null; number: string }): string {
  const named = /^([A-Za-z][A-Za-z0-9]*)\./.exec(name ?? "")?.[1];
  if (named !== undefined) return named;
  const numbered = /^(\d+-)/.exec(number)?.[1];
  if (numbered !== undefined) return numbered;
  if (number.startsWith("ID ")) return "ID";
  const profile = Number(/^[pr]?0*(\d+)/.exec(number)?.[1] ?? Number.NaN);
  return profile >= PROFILE && profile < 1000 ? "PROFIdrive" : "";
}

/** Compares as people count: `9-` before `14-`. */
const order = new Intl.Collator("en", { numeric: true });

/** Returns the groups of these parameters, sorted; the empty one, of what has none, last. */
export function groups(all: Iterable<{ name: string | null; number: string }>): string[] {
  const found = new Set(Array.from(all, groupOf));
  return [...found].sort((a, b) => Number(a === "") - Number(b === "") || order.compare(a, b));
}
