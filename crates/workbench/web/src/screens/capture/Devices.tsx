import type { CaptureReport } from "../../api";
import { foreign } from "../../parts/format";
import { t } from "../../text";

function ms(seconds: number | null): string {
  return seconds === null ? "\u2013" : (seconds * 1000).toFixed(3);
}

/** How regular the cyclic frames of each device are. */
export function Devices({ capture }: { capture: CaptureReport }) {
  if (capture.devices.length === 0) return null;
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys
    <section class="scroll" tabIndex={0} aria-label={t("capture.devices")}>
      <table>
        <caption class="unseen">{t("capture.devices")}</caption>
        <thead>
          <tr>
            <th scope="col">{t("capture.device")}</th>
            <th scope="col">{t("capture.direction")}</th>
            <th scope="col">{t("capture.frames")}</th>
            <th scope="col">{t("capture.cycle")}</th>
            <th scope="col">{t("capture.jitter")}</th>
            <th scope="col">{t("telegram.missed")}</th>
            <th scope="col">{t("capture.gap")}</th>
            <th scope="col">{t("capture.losses")}</th>
            <th scope="col">{t("capture.faults")}</th>
          </tr>
        </thead>
        <tbody>
          {capture.devices.flatMap((device) =>
            device.streams.map((stream, number) => (
              <tr key={`${device.mac}${number}`}>
                <th scope="row">
                  <bdi>{foreign(device.device)}</bdi>
                </th>
                <td>{stream.direction}</td>
                <td class="number">{stream.frames}</td>
                <td class="number">{ms(stream.cycle)}</td>
                <td class="number">{ms(stream.jitter_p99)}</td>
                <td class={stream.lost > 0 ? "number fault" : "number"}>{stream.lost}</td>
                <td class="number">{ms(stream.longest_gap)}</td>
                <td class={device.connection_losses > 0 ? "number fault" : "number"}>{device.connection_losses}</td>
                <td class={device.faults > 0 ? "number fault" : "number"}>{device.faults}</td>
              </tr>
            )),
          )}
        </tbody>
      </table>
    </section>
  );
}
