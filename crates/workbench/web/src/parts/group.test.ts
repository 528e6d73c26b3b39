import { expect, test } from "vitest";
import { groupOf, groups } from "./group";

test("the group of a parameter is in its name or its number", () => {
  for (const [name, number, group] of [
    ["DRV.ACC", "p2108", "DRV"],
    ["Ramp 1 ramp up time", "3-41", "3-"],
    ["Telegram selection", "p0922", "PROFIdrive"],
    ["Telegram selection", "922", "PROFIdrive"],
    ["Motor speed", "ID 2", "ID"],
    ["Something", "p1082", ""],
    [null, "r2108[3]", ""],
  ] as const) {
    expect(groupOf({ name, number }), number).toBe(group);
  }
  const all = ["14-01", "3-41", "9-15", "3-42", "p1082"].map((number) => ({ name: "", number }));
  expect(groups(all)).toEqual(["3-", "9-", "14-", ""]);
});
