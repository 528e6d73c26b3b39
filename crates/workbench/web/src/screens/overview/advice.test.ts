import { expect, test } from "vitest";
import { stepsOf } from "./advice";

const action = (name: string, ...list: string[]) => ({ action: name, arguments: list, command: null });

test("each action of the library leads to where it is done, and none twice", () => {
  const steps = stepsOf([
    action("read", "VBUS.VALUE", "VBUS.UVFTHRESH"),
    action("write", "930=1"),
    action("run"),
    action("jog"),
    action("choose", "run-on"),
    action("choose", "interface"),
    action("acknowledge"),
    action("read"),
  ]);
  expect(steps.map(({ screen, hash, name }) => [screen, hash?.q, hash?.set, name])).toEqual([
    ["parameters", "VBUS.VALUE", undefined, "VBUS.VALUE"],
    ["parameters", "VBUS.UVFTHRESH", undefined, "VBUS.UVFTHRESH"],
    ["parameters", "930", "930=1", "930=1"],
    ["control", undefined, undefined, undefined],
    ["control", undefined, undefined, undefined],
  ]);
});
