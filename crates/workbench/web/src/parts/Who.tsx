import { signal } from "@preact/signals";
import { claim, LONGEST, name } from "../store/name";
import { t } from "../text";

/** Why the name was not taken; empty where it was. */
const failure = signal("");

async function keep(text: string): Promise<void> {
  if (text.trim() === name.value) return;
  try {
    await claim(text);
    failure.value = "";
  } catch (error) {
    failure.value = error instanceof Error ? error.message : String(error);
  }
}

/** Asks for the name that stands in the log and beside what this page controls. It may stay empty. */
export function Who() {
  return (
    <>
      <label class="field">
        <span>{t("who.name")}</span>
        <input
          value={name.value}
          maxLength={LONGEST}
          autocomplete="off"
          onChange={(event) => void keep(event.currentTarget.value)}
        />
      </label>
      {failure.value !== "" && (
        <p class="warn small" role="alert">
          <bdi>{failure.value}</bdi>
        </p>
      )}
    </>
  );
}
