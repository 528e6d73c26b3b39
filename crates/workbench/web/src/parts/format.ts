/** How values are shown. */
import type { Fault, Quantity, Station } from "../api";
import { t } from "../text";

/** The longest text of a drive that is shown whole: of a name, and of a sentence with names in it. */
const LONGEST = 120;
const SENTENCE = 600;
// control and format characters, among them those that turn the direction of text
const UNSHOWN = /[\p{Cc}\p{Cf}]/gu;

/** Returns a text of a drive as it is shown: without characters that are no text, cut with the count of the rest. */
export function foreign(text: string, longest = LONGEST): string {
  const clean = Array.from(text.replace(UNSHOWN, "\u{fffd}"));
  const more = clean.length - longest;
  return more > 0 ? `${clean.slice(0, longest).join("")} .. (+${more})` : clean.join("");
}

/** Returns a sentence about a drive, as `foreign`. */
export function sentence(text: string): string {
  return foreign(text, SENTENCE);
}

/** Returns a text as it begins a sentence. */
export function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Decimals of each unit: they are fixed, so that digits do not move. */
const DECIMALS: Record<string, number> = { rpm: 1, rev: 3, V: 0, "%": 1, degC: 0 };

/** Returns a number with fixed decimals; a negative zero is none. */
export function digits(quantity: Quantity): string {
  const text = quantity.value.toFixed(DECIMALS[quantity.unit] ?? 2);
  const plain = Number(text) === 0 ? text.replace("-", "") : text;
  return `${quantity.beyond ?? ""}${plain.replace("-", "\u2212")}`;
}

/** Returns a unit as people write it. */
export function unit({ unit }: Quantity): string {
  return unit === "degC" ? "\u00b0C" : unit;
}

/** Returns what a station is called. Of one that was reached by its address the name is not known. */
export function label(station: Station): string {
  if (station.name === null && station.id.startsWith("ip-")) return station.ip ?? station.id;
  return station.name === null ? t("frame.unnamed", { mac: station.mac }) : foreign(station.name);
}

/** Returns vendor and type; some types begin with their vendor. */
export function product({ vendor, type }: Station): string {
  const named = vendor === null || type.toLowerCase().startsWith(vendor.toLowerCase());
  return foreign(named ? type : `${vendor} ${type}`);
}

/** Returns a fault by its number and what it means. */
export function faultText({ number, meaning }: Pick<Fault, "number" | "meaning">): string {
  return foreign(`F${number} ${meaning ?? ""}`).trim();
}

/** How much a station needs attention: the lowest first. */
export function urgency(station: Station): number {
  const { status, error } = station;
  if (status && status.faults.length > 0) return 0;
  if (station.lost !== null || error) return 1;
  if (status?.verdict === "held") return 2;
  if (station.remarks.length > 0 || station.unread) return 3;
  if (!status) return 4;
  // a drive that runs now and waits then does not change places with others
  return 5;
}

/** Compares as people count: `axis-2` before `axis-10`. */
const names = new Intl.Collator("en", { numeric: true });

/** Returns the stations, those that need attention first. */
export function sorted(all: readonly Station[]): Station[] {
  return [...all].sort((a, b) => urgency(a) - urgency(b) || names.compare(a.name ?? a.id, b.name ?? b.id));
}

/** Returns one cell of a CSV file. A text that a spreadsheet would calculate is prefixed. */
export function cell(text: string): string {
  const inert = /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n;]/.test(inert) ? `"${inert.replaceAll('"', '""')}"` : inert;
}
