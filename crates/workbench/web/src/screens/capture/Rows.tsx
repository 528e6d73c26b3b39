import { foreign, sentence } from "../../parts/format";
import { t } from "../../text";
import { events, frame, frames, from, load, ROWS, show, tried, view } from "./state";

interface Line {
  frame: number;
  time: number;
  from: string;
  to: string;
  text: string;
  tone: string;
}

function lines(): { all: Line[]; total: number } {
  if (view.value === "frames") {
    const page = frames.value;
    const rows = page?.frames.map((row) => ({
      ...row,
      from: row.source,
      to: row.destination,
      text: row.text || t("capture.plain", { length: row.length }),
      tone: row.text ? "" : "muted",
    }));
    return { all: rows ?? [], total: page?.total ?? 0 };
  }
  const page = events.value;
  const rows = page?.events.map((row) => ({
    ...row,
    text: `${row.topic}: ${row.text}`,
    tone: row.weight === "error" ? "fault" : row.trouble ? "warn" : "",
  }));
  return { all: rows ?? [], total: page?.total ?? 0 };
}

/** The events or frames of a capture, page by page. */
export function Rows() {
  const { all, total } = lines();
  const turn = (step: number) => {
    from.value = Math.max(0, from.value + step);
    void tried(load);
  };
  return (
    <section class="capture-rows">
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("capture.list")}>
        <table>
          <caption class="unseen">{t("capture.list")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("capture.frame")}</th>
              <th scope="col">{t("capture.time")}</th>
              <th scope="col">{t("machine.from")}</th>
              <th scope="col">{t("machine.to")}</th>
              <th scope="col">{t("log.result")}</th>
            </tr>
          </thead>
          <tbody>
            {all.map((row, number) => (
              <tr key={`${row.frame} ${number}`} class={frame.value?.frame === row.frame ? "chosen" : ""}>
                <td class="number">
                  <button type="button" class="plain" onClick={() => void show(row.frame)}>
                    {row.frame}
                  </button>
                </td>
                <td class="number">{row.time.toFixed(6)}</td>
                <td>
                  <bdi>{foreign(row.from, 40)}</bdi>
                </td>
                <td>
                  <bdi>{foreign(row.to, 40)}</bdi>
                </td>
                <td class={`long ${row.tone}`}>
                  <bdi>{sentence(row.text)}</bdi>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </section>
      <p class="buttons">
        <button type="button" disabled={from.value === 0} onClick={() => turn(-ROWS)}>
          {t("capture.before")}
        </button>
        <button type="button" disabled={from.value + ROWS >= total} onClick={() => turn(ROWS)}>
          {t("capture.after")}
        </button>
        <span class="muted small">
          {t("capture.page", { first: total === 0 ? 0 : from.value + 1, last: from.value + all.length, total })}
        </span>
      </p>
    </section>
  );
}
