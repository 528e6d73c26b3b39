import { beforeAll, expect, test, vi } from "vitest";
import type { Station } from "../api";

vi.stubGlobal("location", { search: "" });
let module: typeof import("./commands");
beforeAll(async () => {
  module = await import("./commands");
});

function station(name: string): Station {
  return { id: name, name, mac: name, remarks: [], lost: null, error: null, status: null } as unknown as Station;
}

test("each screen has a letter of its own", () => {
  const letters = Object.values(module.LETTERS);
  expect(new Set(letters).size).toBe(letters.length);
  expect(module.screens(false)).not.toContain("virtual");
  expect(module.screens(true)).toHaveLength(12);
});

test("the palette finds screens and drives by their words, and keeps the screen of a drive", () => {
  const all = module.commands([station("axis-10"), station("axis-2")], "axis-2", "parameters", true);
  const found = (text: string) => module.matching(all, text).map(({ path }) => path);
  expect(found("para")).toEqual([
    "/drives/axis-2/parameters",
    "/drives/axis-2/parameters",
    "/drives/axis-10/parameters",
  ]);
  expect(found("AXIS 10")).toEqual(["/drives/axis-10/parameters"]);
  expect(found("log")).toEqual(["/log"]);
  expect(found("nothing like it")).toEqual([]);
  expect(found("")).toHaveLength(14);
  const whole = module.commands([station("axis-2")], null, "log", false);
  expect(module.matching(whole, "axis").map(({ path }) => path)).toEqual(["/drives/axis-2/overview"]);
});
