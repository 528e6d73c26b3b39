/** What the palette offers, and the keys that open screens. */
import type { Station } from "../api";
import { label, sorted } from "../parts/format";
import { t } from "../text";
import { address, OF_DRIVE, type Screen } from "./selected";

/** The letter behind `g` of each screen. */
export const LETTERS: Readonly<Record<Screen, string>> = {
  network: "n",
  overview: "o",
  control: "c",
  parameters: "p",
  scope: "s",
  faults: "f",
  compare: "d",
  machine: "m",
  telegram: "t",
  capture: "e",
  log: "l",
  virtual: "v",
};

/** Something that the palette does. */
export interface Command {
  text: string;
  /** Its keys; empty where it has none. */
  keys: string;
  /** Where it leads. */
  path: string;
}

/** Returns the screens there are, in the order of the navigation. */
export function screens(simulation: boolean): Screen[] {
  return (Object.keys(LETTERS) as Screen[]).filter((screen) => screen !== "virtual" || simulation);
}

/** Returns the address of a screen; of a drive where it shows one. */
export function pathOf(screen: Screen, id: string | null): string {
  return (OF_DRIVE as readonly string[]).includes(screen) ? address(id, screen) : `/${screen}`;
}

/** Returns everything that the palette offers: each screen, and each drive in the present screen of a drive. */
export function commands(
  all: readonly Station[],
  id: string | null,
  here: Screen,
  simulation: boolean,
): readonly Command[] {
  const ofDrive = OF_DRIVE.find((screen) => screen === here) ?? "overview";
  return [
    ...screens(simulation).map((screen) => ({
      text: t(`nav.${screen}`),
      keys: `g ${LETTERS[screen]}`,
      path: pathOf(screen, id),
    })),
    ...sorted(all).map((station) => ({
      text: t("palette.drive", { name: label(station), screen: t(`nav.${ofDrive}`) }),
      keys: "",
      path: address(station.id, ofDrive),
    })),
  ];
}

/** Returns the commands with all these words, those that begin with the first word first. */
export function matching(all: readonly Command[], text: string): readonly Command[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const found = all.filter((command) => words.every((word) => command.text.toLowerCase().includes(word)));
  const begins = (command: Command) => command.text.toLowerCase().startsWith(words[0] ?? "");
  return [...found.filter(begins), ...found.filter((command) => !begins(command))];
}
