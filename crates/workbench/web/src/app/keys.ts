import { useEffect } from "preact/hooks";
import { useLocation } from "preact-iso";
import { leases } from "../store/control";
import { server } from "../store/store";
import { LETTERS, pathOf, screens } from "./commands";
import { pressStop } from "./Frame";
import { recent } from "./selected";
import { isShortcut, shortcuts, shown, takesText } from "./shortcuts";

/** Two keys of a sequence come within this time, in ms. */
const SEQUENCE = 1000;

/** Ctrl+Space and twice Escape are STOP everywhere. `g` and a letter open screens, `/` the search, Ctrl+K the palette, `?` a list. */
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
      if (event.code === "Space" && leases.value.size > 0 && !takesText(event.target)) {
        event.preventDefault();
        void pressStop();
        return;
      }
      if (shortcuts.value && event.ctrlKey && event.key.toLowerCase() === "k") {
        event.preventDefault();
        shown.value = shown.value === "palette" ? "" : "palette";
        return;
      }
      if (!isShortcut(event)) {
        return;
      }
      if (last === "g") {
        const screen = screens(server.value?.simulation ?? false).find((one) => LETTERS[one] === event.key);
        if (screen !== undefined) route(pathOf(screen, recent(path)) + location.search);
      } else if (event.key === "?") {
        shown.value = shown.value === "keys" ? "" : "keys";
      } else if (event.key === "/") {
        const field = document.querySelector<HTMLInputElement>("#content input[type=search]");
        if (field === null) return;
        event.preventDefault();
        field.focus();
      }
    };
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, [path, route]);
}
