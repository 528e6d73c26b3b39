import { useLocation } from "preact-iso";
import { selectedId } from "../app/selected";
import { searched, stations } from "../store/store";
import { t } from "../text";
import { Loading } from "./Loading";

/** What a screen of a drive shows without one: that it waits for the drive in the address, or the way on. */
export function Nothing({ title, select }: { title: string; select: string }) {
  const chosen = selectedId(useLocation().path) !== null;
  const waits = chosen && (stations.value === null || searched.value === null);
  return (
    <section class={waits ? "" : "nothing"}>
      <h1>{title}</h1>
      {waits ? (
        <Loading what={t("loading.search")} count={12} />
      ) : (
        <>
          <p>{chosen ? t("overview.unknown") : select}</p>
          <p>
            <a href={`/network${location.search}`}>{t("overview.none.action")}</a>
          </p>
        </>
      )}
    </section>
  );
}
