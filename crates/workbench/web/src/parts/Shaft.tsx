import { computed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { shafts, silent } from "../store/store";
import { t } from "../text";

/** The shaft of a virtual drive, at its position. Says in words what it does where motion is not wanted. */
export function Shaft({ id }: { id: string }) {
  const shaft = useMemo(() => computed(() => (silent.value === null ? shafts.value.get(id) : undefined)), [id]);
  const seen = shaft.value;
  if (!seen) {
    return <span class="muted">&ndash;</span>;
  }
  const turns = Math.abs(seen.speed) >= 0.5;
  const text = turns ? t("shaft.turns", { speed: seen.speed.toFixed(0) }) : t("shaft.still");
  return (
    <span class="shaft" data-turns={turns}>
      <svg viewBox="0 0 16 16" width="20" height="20" role="img" aria-label={text}>
        <title>{text}</title>
        <circle cx="8" cy="8" r="6.5" />
        <path class="key" d="M8 8V2.5" style={{ transform: `rotate(${(seen.position * 360).toFixed(1)}deg)` }} />
      </svg>
      <span class="shaft-text">{text}</span>
    </span>
  );
}
