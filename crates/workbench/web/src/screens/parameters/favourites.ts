/** The parameters that a person looks at again and again, kept in this browser for each type of drive. */
import { signal } from "@preact/signals";

const KEY = "profidrive.favourites.";

/** The type of drive they are of. */
let type = "";
export const favourites = signal<ReadonlySet<string>>(new Set());

/** Returns what is kept; nothing where it is no list of texts. */
export function parsed(text: string | null): ReadonlySet<string> {
  try {
    const list: unknown = JSON.parse(text ?? "[]");
    return new Set(Array.isArray(list) ? list.filter((one) => typeof one === "string") : []);
  } catch {
    return new Set();
  }
}

/** Begins with a type of drive. */
export function openFavourites(of: string): void {
  type = of;
  favourites.value = parsed(localStorage.getItem(KEY + of));
}

export function isFavourite(number: string): boolean {
  return favourites.value.has(number);
}

export function toggleFavourite(number: string): void {
  const next = new Set(favourites.value);
  if (!next.delete(number)) next.add(number);
  favourites.value = next;
  localStorage.setItem(KEY + type, JSON.stringify([...next]));
}
