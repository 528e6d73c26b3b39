import { useEffect, useState } from "preact/hooks";
import { t } from "../text";

/** A shorter wait has no words, in ms. */
const LATE = 2000;

/** Returns whether something is waited for so long that the page says for what. */
export function useLate(): boolean {
  const [late, setLate] = useState(false);
  useEffect(() => {
    const timer = setTimeout(() => setLate(true), LATE);
    return () => clearTimeout(timer);
  }, []);
  return late;
}

/** What a wait is for, once it takes long. Its place is kept before. */
export function Waits({ what }: { what: string }) {
  const late = useLate();
  return (
    <p class="waits muted" role="status">
      {late && t("loading.waits", { what })}
    </p>
  );
}

/** Grey bars in the place of what is waited for. */
export function Bars({ count, height = 28 }: { count: number; height?: 28 | 64 | 308 }) {
  return (
    <div class="bars" aria-hidden="true">
      {Array.from({ length: count }, (_, place) => (
        <div key={place} class={`bar tall-${height}`} />
      ))}
    </div>
  );
}

/** Both, for a whole screen or a part of it. */
export function Loading({ what, count, height = 28 }: { what: string; count: number; height?: 28 | 64 | 308 }) {
  return (
    <section class="loading" aria-busy="true">
      <Waits what={what} />
      <Bars count={count} height={height} />
    </section>
  );
}
