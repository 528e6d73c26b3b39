import { effect, signal } from "@preact/signals";

export type Theme = "system" | "light" | "dark";
const KEY = "profidrive.theme";

function stored(): Theme {
  const theme = localStorage.getItem(KEY);
  return theme === "light" || theme === "dark" ? theme : "system";
}

export const theme = signal<Theme>(stored());

effect(() => {
  localStorage.setItem(KEY, theme.value);
  document.documentElement.dataset.theme = theme.value;
});
