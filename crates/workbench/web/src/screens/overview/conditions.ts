import type { Status } from "../../api";
import { t } from "../../text";

/** What must be so that a drive runs. */
export interface Condition {
  name: string;
  /** `null` for a fact that is neither good nor bad. */
  met: boolean | null;
  value: string;
}

interface Word {
  number: number;
  hex: string;
  bits: string[];
  meaning: string | null;
}

/** What keeps something off; where a word has no bit of a known name, its number says that there is a cause. */
function word(
  name: string,
  sources: Word | null,
  held: "condition.off" | "condition.blocked",
  free: string,
): Condition[] {
  if (sources === null) return [];
  const list = sources.bits.length > 0 ? sources.bits.join(", ") : sources.hex;
  return [{ name, met: sources.number === 0, value: sources.number === 0 ? free : t(held, { list }) }];
}

/** Returns the conditions that a drive reports; what it does not report is left out. */
export function conditions(status: Status, owner: string | null): Condition[] {
  const all: Condition[] = [];
  const faults = status.faults.map((fault) => t("condition.fault.is", { number: fault.number }));
  const met = faults.length === 0;
  all.push({ name: t("condition.fault"), met, value: met ? t("condition.none") : faults.join(", ") });
  if (status.torque_allowed !== null) {
    const value = t(status.torque_allowed ? "condition.sto.on" : "condition.sto.off");
    all.push({ name: t("condition.sto"), met: status.torque_allowed, value });
  }
  all.push(...word(t("condition.sources"), status.disable_sources, "condition.off", t("condition.free")));
  const { motion_disable_sources: motion } = status;
  all.push(...word(t("condition.motion"), motion, "condition.blocked", t("condition.unblocked")));
  const switches = [
    status.negative_switch ? t("condition.switch.negative") : "",
    status.positive_switch ? t("condition.switch.positive") : "",
  ].filter((text) => text !== "");
  if (status.negative_switch !== null || status.positive_switch !== null) {
    const free = switches.length === 0;
    all.push({ name: t("condition.switches"), met: free, value: free ? t("condition.none") : switches.join(", ") });
  }
  if (status.homed !== null) {
    all.push({
      name: t("condition.homed"),
      met: status.homed,
      value: t(status.homed ? "condition.yes" : "condition.no"),
    });
  }
  if (status.controller !== null) {
    all.push({
      name: t("condition.controller"),
      met: owner === null ? null : true,
      value: owner ?? t("condition.no"),
    });
  }
  if (status.command_source !== null) {
    const { meaning, number } = status.command_source;
    all.push({ name: t("condition.setpoints"), met: null, value: meaning ?? String(number) });
  }
  if (status.operating_mode !== null) {
    const mode = status.operating_mode;
    const value = mode === 1 ? t("condition.mode.1") : mode === 2 ? t("condition.mode.2") : String(mode);
    all.push({ name: t("condition.mode"), met: null, value });
  }
  if (status.telegram !== null) {
    all.push({ name: t("condition.telegram"), met: null, value: String(status.telegram) });
  }
  return all;
}
