/** Numbers and fields of the Scope. */
import { penOf } from "./Plot";

export const dash = "\u2013";

export function number(value: number | undefined, unit: string): string {
  if (value === undefined || !Number.isFinite(value)) return dash;
  const text = value.toFixed({ rpm: 1, rev: 4, "%": 1 }[unit] ?? (Number.isInteger(value) ? 0 : 3));
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

/** Returns a time in words: `20 ms`, `1.5 s`. */
export function time(us: number): string {
  const ms = us / 1000;
  const text = Math.abs(ms) < 1000 ? `${Number(ms.toFixed(3))} ms` : `${Number((ms / 1000).toFixed(4))} s`;
  return text.replace("-", "\u2212");
}

export function Select<T extends string>({
  title,
  value,
  options,
  disabled,
  onChange,
}: {
  title: string;
  value: T;
  options: readonly (readonly [T, string])[];
  disabled?: boolean;
  onChange: (value: T) => void;
}) {
  return (
    <label class="field">
      <span>{title}</span>
      <select value={value} disabled={disabled ?? false} onChange={(event) => onChange(event.currentTarget.value as T)}>
        {options.map(([key, text]) => (
          <option key={key} value={key}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

/** A line as a signal is drawn. */
export function Pen({ place }: { place: number }) {
  const { colour, dash } = penOf(place);
  return (
    <svg width="20" height="8" viewBox="0 0 20 8" aria-hidden="true">
      <path d="M0 4H20" stroke={colour} stroke-width="2" stroke-dasharray={dash.join(" ")} />
    </svg>
  );
}
