import { now, tracks } from "../store/store";
import { t } from "../text";

const WIDTH = 160;
const HEIGHT = 28;
const SPAN = 60_000;
/** A longer time between two values is a gap, in ms. */
const GAP = 4000;

/** The last minute of a value. */
export function Spark({ id, name, title, unit }: { id: string; name: string; title: string; unit: string }) {
  const track = tracks.value.get(`${id} ${name}`);
  if (!track || track.values.length < 2) {
    return <svg class="spark" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} width={WIDTH} height={HEIGHT} aria-hidden="true" />;
  }
  const low = Math.min(...track.values);
  const high = Math.max(...track.values);
  // noise of a value at rest is not drawn as motion
  const span = Math.max(high - low, Math.abs(high) * 0.02, 1e-3);
  const middle = (high + low) / 2;
  const points = track.times.map((time, index) => {
    const x = WIDTH - ((now.value - time) / SPAN) * WIDTH;
    const y = HEIGHT / 2 - (((track.values[index] ?? 0) - middle) / span) * (HEIGHT - 4);
    const before = track.times[index - 1];
    const begins = before === undefined || time - before > GAP;
    return `${begins ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`;
  });
  const text = t("overview.spark", { name: title, low: low.toFixed(1), high: high.toFixed(1), unit });
  return (
    <svg class="spark" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} width={WIDTH} height={HEIGHT} role="img" aria-label={text}>
      <path d={points.join("")} />
    </svg>
  );
}
