import { effect, signal } from "@preact/signals";

const THEMES = ["system", "light", "dark", "contrast"] as const;
export type Theme = (typeof THEMES)[number];
const KEY = "profidrive.theme";

function stored(): Theme {
  const theme = localStorage.getItem(KEY);
  return THEMES.find((one) => one === theme) ?? "system";
}

export const theme = signal<Theme>(stored());

effect(() => {
  localStorage.setItem(KEY, theme.value);
  document.documentElement.dataset.theme = theme.value;
});
