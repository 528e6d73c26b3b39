/** Differences against a base, and as files. */
import type { Difference } from "../../api";
import { cell } from "../../parts/format";

type Side = Difference["left"];

/** A setting that differs, with its value in the base. */
export interface Row {
  of: Difference;
  /** Its value in the base; nothing without one. */
  base: Side;
  /** Which sides differ from the base; nothing without one. */
  changed: "left" | "right" | "both" | null;
}

export function keyOf(one: Difference): string {
  return one.left?.number ?? one.right?.number ?? String(one.pnu);
}

/**
 * Returns the differences of two sides with their values in a base. `left` and `right` are what differs between the base, as their
 * left side, and each of them; nothing without a base.
 */
export function merge(
  all: readonly Difference[],
  sides: { left: readonly Difference[]; right: readonly Difference[] } | null,
): Row[] {
  if (sides === null) return all.map((of) => ({ of, base: null, changed: null }));
  const byKey = (list: readonly Difference[]) => new Map(list.map((one) => [keyOf(one), one]));
  const [left, right] = [byKey(sides.left), byKey(sides.right)];
  return all.map((of) => {
    const [l, r] = [left.get(keyOf(of)), right.get(keyOf(of))];
    const changed =
      l !== undefined && r !== undefined ? "both" : l !== undefined ? "left" : r !== undefined ? "right" : null;
    // a side that does not differ from the base has its value
    const base = l?.left ?? r?.left ?? (l === undefined ? of.left : r === undefined ? of.right : null);
    return { of, base, changed };
  });
}

/** Returns a value as a report has it: with its unit, or why there is none. */
export function valueText(parameter: Side): string {
  if (parameter === null) return "";
  return parameter.error?.meaning ?? `${parameter.text ?? ""} ${parameter.unit}`.trim();
}

/** What a report has: names of the columns, and rows of texts. */
export interface Report {
  title: string;
  head: readonly string[];
  rows: readonly (readonly string[])[];
}

export function csv({ head, rows }: Report): string {
  return [head, ...rows].map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

function escaped(text: string): string {
  const names: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };
  return text.replace(/[&<>"]/g, (letter) => names[letter] ?? letter);
}

/** Returns a page without scripts that a browser prints. */
export function html({ title, head, rows }: Report): string {
  const row = (tag: string, cells: readonly string[]) =>
    `<tr>${cells.map((text) => `<${tag}>${escaped(text)}</${tag}>`).join("")}</tr>\n`;
  return (
    `<!doctype html>\n<meta charset="utf-8">\n<title>${escaped(title)}</title>\n` +
    "<style>body{font:14px system-ui}table{border-collapse:collapse}th,td{border:1px solid #868e99;padding:2px 8px;text-align:left}</style>\n" +
    `<h1>${escaped(title)}</h1>\n<table>\n<thead>${row("th", head)}</thead>\n<tbody>\n${rows.map((cells) => row("td", cells)).join("")}</tbody>\n</table>\n`
  );
}
