import type { CaptureReport } from "../../api";
import { Check } from "../../parts/Check";
import { foreign } from "../../parts/format";
import { t } from "../../text";
import { change, filter, from, load, show, tried, view, wantedFrame } from "./state";

/** Which part of a capture is listed. */
export function Filters({ capture }: { capture: CaptureReport }) {
  const { trouble, device, begin, end } = filter.value;
  return (
    <p class="filters">
      <Check checked={trouble} disabled={view.value === "frames"} onChange={(on) => change({ trouble: on })}>
        {t("capture.trouble")}
      </Check>
      <label>
        <span class="muted small">{t("capture.device")}</span>
        <select
          value={device}
          disabled={view.value === "frames"}
          onChange={(event) => change({ device: event.currentTarget.value })}
        >
          <option value="">{t("log.all")}</option>
          {capture.devices.map((one) => (
            <option key={one.mac} value={one.mac}>
              {foreign(one.device)}
            </option>
          ))}
        </select>
      </label>
      <label>
        <span class="muted small">{t("capture.begin")}</span>
        <input
          inputMode="decimal"
          value={begin}
          disabled={view.value === "frames"}
          onChange={(event) => change({ begin: event.currentTarget.value })}
        />
      </label>
      <label>
        <span class="muted small">{t("capture.end")}</span>
        <input
          inputMode="decimal"
          value={end}
          disabled={view.value === "frames"}
          onChange={(event) => change({ end: event.currentTarget.value })}
        />
      </label>
      <label>
        <span class="muted small">{t("capture.view")}</span>
        <select
          value={view.value}
          onChange={(event) => {
            view.value = event.currentTarget.value === "frames" ? "frames" : "events";
            from.value = 0;
            void tried(load);
          }}
        >
          <option value="events">{t("capture.events")}</option>
          <option value="frames">{t("capture.all")}</option>
        </select>
      </label>
      <form
        onSubmit={(submit) => {
          submit.preventDefault();
          const number = Number(wantedFrame.value);
          if (Number.isInteger(number) && number > 0) void show(number);
        }}
      >
        <label>
          <span class="muted small">{t("capture.number")}</span>
          <input
            inputMode="numeric"
            value={wantedFrame.value}
            onInput={(event) => {
              wantedFrame.value = event.currentTarget.value;
            }}
          />
        </label>
        <button type="submit">{t("capture.show")}</button>
      </form>
    </p>
  );
}
