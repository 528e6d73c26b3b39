import type { Station } from "../api";
import { heldAxis, own, session, wasOwn } from "../store/control";
import { named } from "../store/name";
import { received } from "../store/store";
import { age, t } from "../text";
import { faultText, foreign, urgency } from "./format";
import { Icon, type IconName } from "./Icon";

/** What is to be said about a station beside its status. */
export function findings(station: Station): string[] {
  const remarks = station.remarks.map((remark) => t(`remark.${remark}`));
  return station.lost === null ? remarks : [t("remark.lost", { age: age(station.lost) }), ...remarks];
}

/** The sign of a station: its shape and its colour. */
export function sign(station: Station): { icon: IconName; tone: string; word: string } {
  const { status, error } = station;
  switch (urgency(station)) {
    case 0:
      return { icon: "cross", tone: "fault", word: t("verdict.held") };
    case 1:
      return { icon: "cross", tone: "fault", word: t("verdict.unread") };
    case 3:
      return { icon: "triangle", tone: "warn", word: t("verdict.unknown") };
    case 4:
      return { icon: "dash", tone: "muted", word: t("verdict.unknown") };
    default:
      if (status?.verdict === "runs") return { icon: "tick", tone: "ok", word: t("verdict.runs") };
      return {
        icon: "square",
        tone: "accent",
        word: t(error || status?.verdict === "held" ? "verdict.held" : "verdict.waits"),
      };
  }
}

/** In one line why a station needs attention, or that it runs. */
export function reason(station: Station): string {
  const { status, error, unread } = station;
  const found = findings(station);
  if (station.lost !== null) return found.join(", ");
  const fault = status?.faults[0];
  if (fault) return faultText(fault);
  if (error) return foreign(error.message);
  if (status) return foreign(status.sentence);
  if (found.length > 0) return found.join(", ");
  return foreign(unread ?? t("network.unread"));
}

export function Reason({ station }: { station: Station }) {
  const { icon, tone, word } = sign(station);
  return (
    <span class={`reason ${tone}`}>
      <Icon name={icon} />
      <span class="unseen">{word}: </span>
      <bdi title={reason(station)}>{reason(station)}</bdi>
    </span>
  );
}

/** The state of a drive; operation enabled is the only filled one. */
export function State({ station, short }: { station: Station; short?: boolean }) {
  const text = station.status?.state_text;
  if (!text) return <span class="muted">&ndash;</span>;
  const live = text.startsWith("S4");
  return (
    <span class={live ? "state live" : "state"} title={text}>
      {live && <Icon name="live" />}
      {live && <span class="unseen">{t("live.on")}: </span>}
      <span class="cut">{short ? text.split(" ")[0] : text}</span>
    </span>
  );
}

/** Who has the cyclic connection of a drive, in words. */
export function owner(station: Station): string {
  const controller = station.status?.controller ?? station.info?.controller;
  if (!controller) return t("frame.owner.unknown");
  const name = ownerName(station);
  return name === null ? t("frame.owner.none") : t("frame.owner", { name });
}

/** The same, where there is little room. */
export function ownerShort(station: Station): string {
  const axis = heldAxis(station.id);
  if (!axis) return owner(station);
  const name = own(axis.drive) ? t("owner.self.short") : otherPage(axis.holder, axis.claimed_name);
  return t("frame.owner", { name });
}

/** Returns who did something, in words. */
export function person(who: string, claimed?: string | null): string {
  if (who === "token") return t("frame.event.program");
  return who === session.value ? t("frame.event.self") : t("frame.event.session", { who: named(who, claimed) });
}

/** Returns who has or wants a drive that is not this page, in words. */
export function otherPage(who: string, claimed: string | null): string {
  return who === session.value ? t("owner.other") : person(who, claimed);
}

/** Returns who controls a drive, where it is not this page; `null` where nothing else does. */
export function otherOwner(station: Station | undefined): string | null {
  return station !== undefined && own(station.id) !== undefined ? null : ownerName(station);
}

/** The name of the controller that is connected; `null` where none is. An axis of this server names its page. */
export function ownerName(station: Station | undefined): string | null {
  const axis = station && heldAxis(station.id);
  if (axis)
    return own(axis.drive) ? t("owner.self") : t("owner.session", { who: named(axis.holder, axis.claimed_name) });
  const controller = station?.status?.controller ?? station?.info?.controller;
  // what was read before this server released the drive names this server
  if (!station || !controller?.connected || wasOwn(station.id, received.value - (station.age ?? 0) * 1000)) return null;
  return controller.name === null ? t("frame.owner.unnamed") : foreign(controller.name);
}
