/** Signal, name and IP address of a station: what the workbench says about them before and after. */
import { signal } from "@preact/signals";
import { type Addressed, type Named, post } from "../../api";
import { reason } from "../../store/jobs";
import { t } from "../../text";
import type { Address } from "./typed";

/** The station whose name and address are shown. */
export const shown = signal<string | null>(null);
/** The station that blinks. */
export const blinking = signal<string | null>(null);
/** What became of the last action, of which station, and whether it failed. */
export const said = signal<{ id: string; text: string; failed: boolean } | null>(null);

/** What speaks against a value that is not set yet; `good` where nothing does. */
export interface Finding {
  good: boolean;
  text: string;
  /** A valid name that resembles the one that is not. */
  converted: string | null;
}

function path(id: string, what: string): string {
  return `stations/${encodeURIComponent(id)}/${what}`;
}

async function act(id: string, does: () => Promise<string>): Promise<void> {
  said.value = null;
  said.value = await does().then(
    (text) => ({ id, text, failed: false }),
    (error: unknown) => ({ id, text: reason(error), failed: true }),
  );
}

export async function blink(id: string, name: string): Promise<void> {
  if (blinking.value !== null) return;
  blinking.value = id;
  await act(id, async () => {
    await post(path(id, "blink"), {});
    return t("address.blinked", { name });
  });
  blinking.value = null;
}

function finding(refusal: Named["refusal"], good: string, converted: string | null): Finding {
  if (refusal === null) return { good: true, text: good, converted: null };
  // what resembles a name that is not valid has a button
  const hint = converted === null ? refusal.hint : null;
  return { good: false, text: [refusal.message, ...(hint === null ? [] : [hint])].join(". "), converted };
}

const failed = (error: unknown): Finding => ({ good: false, text: reason(error), converted: null });

export function checkName(id: string, name: string, permanent: boolean): Promise<Finding> {
  return post<Named>(`${path(id, "name")}?dry_run=true`, { name, permanent }).then(
    ({ refusal, converted }) => finding(refusal, t(name === "" ? "address.none" : "address.good"), converted),
    failed,
  );
}

export function checkAddress(id: string, address: Address, permanent: boolean): Promise<Finding> {
  return post<Addressed>(`${path(id, "ip")}?dry_run=true`, { ...address, permanent }).then(
    ({ refusal }) => finding(refusal, t("address.free"), null),
    failed,
  );
}

export async function setName(id: string, name: string, permanent: boolean): Promise<void> {
  await act(id, async () => {
    await post<Named>(path(id, "name"), { name, permanent });
    return t(name === "" ? "address.unnamed" : "address.named", { name });
  });
}

export async function setAddress(id: string, address: Address, permanent: boolean): Promise<void> {
  await act(id, async () => {
    const { report } = await post<Addressed>(path(id, "ip"), { ...address, permanent });
    return t("address.addressed", { ip: report?.ip ?? address.ip });
  });
}
