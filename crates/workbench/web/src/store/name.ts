/** What the people of this page call themselves, for the log and for other pages. Nothing verifies it. */
import { signal } from "@preact/signals";
import { request } from "../api";
import { t } from "../text";

const KEY = "profidrive-name";
/** The longest name that the server keeps, in characters. */
export const LONGEST = 40;

/** The name as it is kept by this browser; empty where none was given. */
export const name = signal(localStorage.getItem(KEY) ?? "");

/** Gives the session another name; what the server keeps of it is shown. */
export async function claim(text: string): Promise<void> {
  const body = JSON.stringify({ name: text });
  const kept = await request<{ name: string | null }>("session", {
    method: "PUT",
    headers: { "Content-Type": "application/json" },
    body,
  });
  name.value = kept.name ?? "";
  localStorage.setItem(KEY, name.value);
}

/** Returns a session by its number, with the name that it claims. */
export function named(who: string, claimed: string | null | undefined): string {
  return claimed ? t("who.claimed", { who, name: claimed }) : who;
}
