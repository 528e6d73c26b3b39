/** What the library advises next: where it is done on this page. */
import type { Status } from "../../api";
import type { Screen } from "../../app/selected";
import type { Key } from "../../text/en";

/** Where a step is done: a screen of the drive, what is behind its address, and its words. */
export interface Step {
  screen: Screen;
  hash?: Record<string, string>;
  text: Key;
  name?: string;
}

/** Where things are done that have a button on a screen of the drive. */
const SCREENS: Readonly<Record<string, Step>> = {
  faults: { screen: "faults", text: "step.faults" },
  monitor: { screen: "scope", text: "step.monitor" },
  backup: { screen: "compare", text: "step.backup" },
  disable: { screen: "control", text: "step.control" },
  run: { screen: "control", text: "step.control" },
  jog: { screen: "control", text: "step.control" },
  move: { screen: "control", text: "step.control" },
  home: { screen: "control", text: "step.home" },
};
/** What is chosen under "Options" of Control. */
const OPTIONS = ["mode", "run-on", "speed-limit"];

/** Returns where an action of the library is done on this page; nothing for what has its place on Overview, or none. */
export function stepOf({ action, arguments: [first = ""] }: Status["actions"][number]): Step | null {
  const parameters: Screen = "parameters";
  switch (action) {
    case "read":
    case "find":
    case "describe":
      return first === "" ? null : { screen: parameters, hash: { q: first }, text: "step.show", name: first };
    case "write": {
      const [name = ""] = first.split("=");
      return { screen: parameters, hash: { q: name, set: first }, text: "step.set", name: first };
    }
    case "choose":
      return OPTIONS.includes(first) ? { screen: "control", text: "step.options" } : null;
    default:
      return SCREENS[action] ?? null;
  }
}

/** Returns the steps of all actions, each once. */
export function stepsOf(actions: Status["actions"]): Step[] {
  const all = actions.flatMap((action) =>
    action.action === "read"
      ? action.arguments.map((one) => stepOf({ ...action, arguments: [one] }))
      : [stepOf(action)],
  );
  const known = new Map(all.flatMap((step) => (step === null ? [] : [[`${step.text} ${step.name ?? ""}`, step]])));
  return [...known.values()];
}
