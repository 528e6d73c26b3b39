/** Whether keys open screens and lists. STOP has its keys always. */
import { effect, signal } from "@preact/signals";

const KEY = "profidrive.shortcuts";

export const shortcuts = signal(localStorage.getItem(KEY) !== "off");
effect(() => {
  localStorage.setItem(KEY, shortcuts.value ? "on" : "off");
});

/** The dialog that is shown: the list of keys, or the palette. */
export const shown = signal<"" | "keys" | "palette">("");

/** Returns whether letters typed there are text, or select an entry of a list. Boxes and sliders take no letters. */
export function takesText(target: EventTarget | null): boolean {
  const fields =
    "input:not([type=checkbox]):not([type=radio]):not([type=range]):not([type=file]), textarea, select, [contenteditable]";
  return target instanceof HTMLElement && target.matches(fields);
}

/** Returns whether a key without Ctrl, Alt and Meta is a shortcut where it was pressed. */
export function isShortcut(event: KeyboardEvent): boolean {
  return shortcuts.value && !event.ctrlKey && !event.altKey && !event.metaKey && !takesText(event.target);
}
