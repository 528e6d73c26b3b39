import { useEffect } from "preact/hooks";
import { foreign, sentence } from "../../parts/format";
import { Icon } from "../../parts/Icon";
import { Loading } from "../../parts/Loading";
import { server } from "../../store/store";
import { t } from "../../text";
import { Devices } from "./Devices";
import { Filters } from "./Filters";
import { Frame } from "./Frame";
import { Rows } from "./Rows";
import { captures, current, failure, frame, list, open, sending, tried, upload } from "./state";
import { Timeline } from "./Timeline";

/** Captures explained: what happened, each field of a frame, and its octets. */
export function Capture() {
  useEffect(() => void tried(list), []);
  const capture = current.value;
  const may = server.value?.role === "control" && sending.value === "";
  return (
    <article
      class="capture"
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file && may) void upload(file);
      }}
    >
      <div class="title">
        <h1>{t("capture.title")}</h1>
        <label class="button">
          <input
            type="file"
            class="unseen"
            accept=".pcap,.pcapng,.cap"
            disabled={!may}
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              if (file) void upload(file);
              event.currentTarget.value = "";
            }}
          />
          {t("capture.upload")}
        </label>
        {captures.value !== null && captures.value.length > 0 && (
          <label>
            <span class="muted small">{t("capture.kept")}</span>
            <select
              value={capture?.id ?? ""}
              onChange={(event) => void tried(() => open(Number(event.currentTarget.value)))}
            >
              <option value="" disabled hidden>
                {t("capture.choose")}
              </option>
              {captures.value.map((one) => (
                <option key={one.id} value={one.id}>
                  {t("capture.option", { id: one.id, frames: one.counts.frames })}
                </option>
              ))}
            </select>
          </label>
        )}
      </div>
      <p class="muted">{t(server.value?.role === "control" ? "capture.private" : "capture.only")}</p>
      {sending.value !== "" && <p role="status">{t("capture.sending", { name: foreign(sending.value) })}</p>}
      {failure.value !== "" && (
        <p class="fault" role="alert">
          <Icon name="cross" /> <bdi>{sentence(failure.value)}</bdi>
        </p>
      )}
      {captures.value === null && failure.value === "" && <Loading what={t("loading.files")} count={8} />}
      {capture && (
        <>
          <p role="status" data-frames={capture.ended ? capture.counts.frames : ""}>
            {t(capture.ended ? "capture.ended" : "capture.reading", {
              frames: capture.counts.frames,
              lasts: capture.lasts.toFixed(3),
              events: capture.events,
            })}
          </p>
          {capture.error !== null && (
            <p class="warn">
              <Icon name="triangle" /> <bdi>{sentence(capture.error)}</bdi>
            </p>
          )}
          {capture.left_out > 0 && <p class="muted">{t("capture.left", { count: capture.left_out })}</p>}
          <Devices capture={capture} />
          {capture.ended && <Timeline capture={capture} />}
          {capture.ended && <Filters capture={capture} />}
          {capture.ended && <Rows />}
          {frame.value && <Frame shown={frame.value} />}
        </>
      )}
    </article>
  );
}
