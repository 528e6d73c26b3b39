/** What the library advises next, as links to where it is done. Nothing is done by a link, and a drive is stopped by a button. */
import { useLocation } from "preact-iso";
import type { Station } from "../../api";
import { besideOf, pressStop } from "../../app/Frame";
import { address } from "../../app/selected";
import { foreign, label } from "../../parts/format";
import { server, silent } from "../../store/store";
import { t } from "../../text";
import { shown } from "../network/address";
import { stepsOf } from "./advice";

/** Links to what comes next, and to the dialog for name and address where the station has none. */
export function Steps({ station }: { station: Station }) {
  const { route } = useLocation();
  const nameless = station.remarks.some((remark) => remark === "no_name" || remark === "no_address");
  const names = nameless && server.value?.searches && server.value.role === "control";
  const advised = station.status?.actions.some(({ action }) => action === "stop") ?? false;
  const stops = advised ? besideOf(station) : null;
  return (
    <>
      {stepsOf(station.status?.actions ?? []).map(({ screen, hash, text, name = "" }) => (
        <a
          key={text + name}
          class={screen === "faults" ? "" : "roomy"}
          href={`${address(station.id, screen)}${location.search}${hash ? `#${new URLSearchParams(hash)}` : ""}`}
        >
          {t(text, { name: foreign(name) })}
        </a>
      ))}
      {stops && (
        <button type="button" class="primary" disabled={silent.value !== null} onClick={() => void pressStop()}>
          {t(`stop.beside.${stops}`, { name: label(station) })}
        </button>
      )}
      {names && (
        <button
          type="button"
          onClick={() => {
            shown.value = station.id;
            route(`/network${location.search}`);
          }}
        >
          {t("step.name")}
        </button>
      )}
    </>
  );
}
