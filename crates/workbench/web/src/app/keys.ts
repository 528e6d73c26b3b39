import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { leases } from "../store/control";
import { server } from "../store/store";
import { pressStop } from "./Frame";
import { address, recent } from "./selected";

/** Two keys of a sequence come within this time, in ms. */
const SEQUENCE = 1000;

/** Returns whether letters typed there are text, or select an entry of a list. Boxes and sliders take no letters. */
export function takesText(target: EventTarget | null): boolean {
  const fields =
    "input:not([type=checkbox]):not([type=radio]):not([type=range]):not([type=file]), textarea, select, [contenteditable]";
  return target instanceof HTMLElement && target.matches(fields);
}

/** `g` and a letter open screens; Ctrl+Space and twice Escape are STOP everywhere. */
export function useKeys(): void {
  const { path, route } = useLocation();
  useEffect(() => {
    let before = { key: "", time: 0 };
    const press = (event: KeyboardEvent) => {
      const last = performance.now() - before.time < SEQUENCE ? before.key : "";
      before = { key: event.key, time: performance.now() };
      if (event.repeat) {
        return;
      }
      if ((event.ctrlKey && event.code === "Space") || (event.key === "Escape" && last === "Escape")) {
        event.preventDefault();
        void pressStop();
        return;
      }
      // while this page has an axis the space bar is STOP, except in a field for text and in a list
      const typing = takesText(event.target);
      if (event.code === "Space" && leases.value.size > 0 && !typing) {
        event.preventDefault();
        void pressStop();
        return;
      }
      if (typing || event.ctrlKey || event.altKey || event.metaKey || last !== "g") {
        return;
      }
      const id = recent(path);
      const screen = {
        n: "/network",
        o: address(id, "overview"),
        c: address(id, "control"),
        p: address(id, "parameters"),
        s: address(id, "scope"),
        f: address(id, "faults"),
        d: address(id, "compare"),
        m: address(id, "machine"),
        t: address(id, "telegram"),
        e: "/capture",
        l: "/log",
        v: "/virtual",
      }[event.key];
      if (screen !== undefined && (event.key !== "v" || server.value?.simulation)) {
        route(screen + location.search);
      }
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, [path, route]);
}
