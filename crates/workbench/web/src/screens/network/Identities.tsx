import { foreign, label } from "../../parts/format";
import { stations } from "../../store/store";
import { t } from "../../text";
import { identities } from "./selection";

const dash = "\u2013";

/** Who the stations that were selected are, as they reported it when it was read. */
export function Identities() {
  const read = identities.value;
  if (read === null) return null;
  const name = (id: string) => {
    const station = stations.value?.find((one) => one.id === id);
    return station ? label(station) : id;
  };
  return (
    <section class="identities" aria-labelledby="identities">
      <div class="title">
        <h2 id="identities">{t("network.identity")}</h2>
        <button
          type="button"
          onClick={() => {
            identities.value = null;
          }}
        >
          {t("network.identity.close")}
        </button>
      </div>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls is reached by keys */}
      <section class="scroll" tabIndex={0} aria-label={t("network.identity")}>
        <table>
          <caption class="unseen">{t("network.identity")}</caption>
          <thead>
            <tr>
              <th scope="col">{t("network.name")}</th>
              <th scope="col">{t("identity.order")}</th>
              <th scope="col">{t("identity.serial")}</th>
              <th scope="col">{t("identity.firmware")}</th>
              <th scope="col">{t("identity.hardware")}</th>
              <th scope="col">{t("identity.function")}</th>
              <th scope="col">{t("identity.location")}</th>
              <th scope="col">{t("identity.installed")}</th>
              <th scope="col">{t("network.modules")}</th>
              <th scope="col">{t("network.neighbours")}</th>
            </tr>
          </thead>
          <tbody>
            {read.map(({ id, info, failed }) => {
              const identity = info?.identity;
              const cells = [
                identity?.order_id,
                identity?.serial_number,
                identity?.software_revision,
                identity ? String(identity.hardware_revision) : "",
                identity?.function,
                identity?.location,
                identity?.installed,
                info?.modules.map(({ slot, ident }) => `${slot}: 0x${ident.toString(16).toUpperCase()}`).join(", "),
                info?.neighbours.map(({ station, mac }) => station ?? mac).join(", "),
              ];
              return (
                <tr key={id}>
                  <th scope="row">
                    <bdi>{name(id)}</bdi>
                  </th>
                  {info === null ? (
                    <td class="fault" colSpan={cells.length}>
                      <bdi>{foreign(failed, 300)}</bdi>
                    </td>
                  ) : (
                    cells.map((text, place) => (
                      <td key={place}>
                        <bdi>{foreign(text?.trim() || dash)}</bdi>
                      </td>
                    ))
                  )}
                </tr>
              );
            })}
          </tbody>
        </table>
      </section>
    </section>
  );
}
