import { t } from "../text";

/** What a screen shows that has nothing to show, with the way on. */
export function Nothing({ title, text }: { title: string; text: string }) {
  return (
    <section class="nothing">
      <h1>{title}</h1>
      <p>{text}</p>
      <p>
        <a href={`/network${location.search}`}>{t("overview.none.action")}</a>
      </p>
    </section>
  );
}
