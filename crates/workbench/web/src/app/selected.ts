import type { Station } from "../api";
import { stations } from "../store/store";

/** Returns the drive in the address of the page. */
export function selectedId(path: string): string | null {
  const id = /^\/drives\/([^/]+)\//.exec(path)?.[1];
  return id === undefined || id === "none" ? null : decodeURIComponent(id);
}

/** Returns the station of that drive. */
export function selected(path: string): Station | undefined {
  const id = selectedId(path);
  return stations.value?.find((station) => station.id === id);
}

/** The screens. */
export type Screen = "network" | "overview" | "faults" | "virtual";

/** Returns the screen in an address of the page. */
export function screenOf(path: string): Screen {
  if (path.startsWith("/virtual")) return "virtual";
  if (!path.startsWith("/drives/")) return "network";
  return path.endsWith("/faults") ? "faults" : "overview";
}
