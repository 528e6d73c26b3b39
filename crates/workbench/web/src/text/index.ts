import { en, type Key } from "./en";

/** The pseudo-locale of the tests: 40 % longer, so that a translation is data and no work on the layout. */
const pseudo = new URLSearchParams(location.search).get("lang") === "xx";

/** Returns a text with its arguments. */
export function t(key: Key, values: Record<string, string | number> = {}): string {
  const text = en[key].replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
  return pseudo ? `[${text}${"~".repeat(Math.ceil(text.length * 0.4))}]` : text;
}

/** Returns the time of day in UTC, as the log has it: a page may be far from its machine. */
export function utc(time: Date, decimals = 0): string {
  return `${time.toISOString().slice(11, decimals === 0 ? 19 : 20 + decimals)} UTC`;
}

/** Returns an age in words: `3 s`, `2 min`. */
export function age(seconds: number): string {
  return seconds < 120
    ? t("age.seconds", { count: Math.max(0, Math.round(seconds)) })
    : t("age.minutes", { count: Math.floor(seconds / 60) });
}

/** Returns an age that may be long: `2 min`, `3 h`, `12 days`. */
export function ageLong(seconds: number): string {
  if (seconds < 2 * 3600) return age(seconds);
  if (seconds < 2 * 86_400) return t("age.hours", { count: Math.floor(seconds / 3600) });
  return t("age.days", { count: Math.floor(seconds / 86_400) });
}
