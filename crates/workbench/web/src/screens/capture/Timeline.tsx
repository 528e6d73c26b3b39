import type { CaptureReport } from "../../api";
import { foreign } from "../../parts/format";
import { t } from "../../text";
import { states } from "./state";

const ROWS_OF_STATES = ["S4", "S3", "S5", "S2", "S1"];

/** The states of the drives over the time of the capture, with what points to a fault. */
export function Timeline({ capture }: { capture: CaptureReport }) {
  const drives = [...new Set(states.value.flatMap(({ drive }) => (drive === null ? [] : [drive])))].slice(0, 8);
  if (drives.length === 0 || capture.lasts === 0) return null;
  const x = (time: number) => (time / capture.lasts) * 600;
  return (
    <section>
      <h2>{t("capture.timeline")}</h2>
      {drives.map((drive) => {
        const own = states.value.filter((one) => one.drive === drive);
        const y = (state: string | null) => 6 + Math.max(0, ROWS_OF_STATES.indexOf(state ?? "S1")) * 12;
        const points = own.flatMap((one, number) => {
          const end = own[number + 1]?.time ?? capture.lasts;
          return [`${x(one.time)},${y(one.state)}`, `${x(end)},${y(one.state)}`];
        });
        const name = capture.devices.find(({ mac }) => mac === drive)?.device ?? drive;
        return (
          <div key={drive} class="lane">
            <p class="small">
              <bdi>{foreign(name)}</bdi>{" "}
              <span class="muted">
                {t("capture.states", {
                  list: own
                    .slice(-6)
                    .map(({ state }) => state)
                    .join(" "),
                })}
              </span>
            </p>
            <svg class="timeline" viewBox="-28 0 636 64" aria-hidden="true">
              {ROWS_OF_STATES.map((state) => (
                <g key={state}>
                  <path class="grid" d={`M0 ${y(state)}H600`} />
                  <text x="-24" y={y(state) + 4}>
                    {state}
                  </text>
                </g>
              ))}
              <polyline points={points.join(" ")} />
              {own
                .filter(({ trouble }) => trouble)
                .map((one) => (
                  <path key={one.frame} class="mark" d={`M${x(one.time)} 0V64`} />
                ))}
            </svg>
          </div>
        );
      })}
    </section>
  );
}
