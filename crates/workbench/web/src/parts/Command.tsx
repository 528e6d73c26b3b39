import { signal } from "@preact/signals";
import type { Station } from "../api";
import { server } from "../store/store";
import { t } from "../text";
import { commandLine } from "./command";

/** The line that was copied last. */
const copied = signal("");

/** A line for a shell, with a button that copies it. */
export function Line({ text }: { text: string }) {
  return (
    <p class="command">
      <code>{text}</code>
      <button
        type="button"
        onClick={() => {
          void navigator.clipboard?.writeText(text).then(() => {
            copied.value = text;
          });
        }}
      >
        {t("telegram.copy")}
      </button>
      <span role="status">{copied.value === text ? t("telegram.copied") : ""}</span>
    </p>
  );
}

/** The command that shows what a screen shows; nothing where its drives are in the memory of the server. */
export function Command({ verb, station, more = [] }: { verb: string; station: Station | null; more?: string[] }) {
  const line = server.value === null ? null : commandLine(server.value, verb, station, more);
  return line === null ? null : <Line text={line} />;
}
