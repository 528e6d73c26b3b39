import { signal } from "@preact/signals";
import type { Station } from "../api";
import { stations } from "../store/store";

/** Returns the drive in the address of the page. */
export function selectedId(path: string): string | null {
  const id = /^\/drives\/([^/]+)\//.exec(path)?.[1];
  return id === undefined || id === "none" ? null : decodeURIComponent(id);
}

/** The drive that was selected last: screens that show all drives do not end the selection. */
const last = signal<string | null>(null);

/** Notes the drive in the address of the page. */
export function remember(path: string): void {
  last.value = selectedId(path) ?? last.value;
}

/** Returns the drive in the address of the page, or else the one that was selected last. */
export function recent(path: string): string | null {
  return selectedId(path) ?? last.value;
}

/** Returns the station of the drive in the address of the page. */
export function selected(path: string): Station | undefined {
  return stationOf(selectedId(path));
}

/** Returns the station of a drive. */
export function stationOf(id: string | null): Station | undefined {
  return stations.value?.find((station) => station.id === id);
}

/** The screens of a drive. */
export const OF_DRIVE = [
  "overview",
  "control",
  "parameters",
  "scope",
  "faults",
  "compare",
  "machine",
  "telegram",
] as const;

/** The screens. */
export type Screen = "network" | "virtual" | "capture" | "log" | (typeof OF_DRIVE)[number];

/** Returns the screen in an address of the page. */
export function screenOf(path: string): Screen {
  const whole = (["virtual", "capture", "log"] as const).find((screen) => path === `/${screen}`);
  if (whole !== undefined) return whole;
  if (!path.startsWith("/drives/")) return "network";
  return OF_DRIVE.find((screen) => path.endsWith(`/${screen}`)) ?? "overview";
}

/** Returns the address of a screen of a drive; without one where the page says that none is selected. */
export function address(id: string | null, screen: Screen): string {
  return `/drives/${encodeURIComponent(id ?? "none")}/${screen}`;
}
