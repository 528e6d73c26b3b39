import { beforeAll, expect, test, vi } from "vitest";
import type { LogPage } from "../../api";
import { lastChange } from "./lastChange";

vi.stubGlobal("location", { search: "" });
vi.stubGlobal("localStorage", { getItem: () => null, setItem: () => {} });
let edit: typeof import("./edit");
let favourites: typeof import("./favourites");
beforeAll(async () => {
  edit = await import("./edit");
  favourites = await import("./favourites");
});

test("the last change is that of this parameter, and was carried out", () => {
  const record = (time: string, result: string | null, changes: string[]) => ({ time, result, changes });
  const records = [
    record("4", null, ["DRV.ACC (p2108): 3000 -> 9000"]),
    record("3", "1 of 1 written", ["DRV.ACCZERO (p3333): 1 -> 2"]),
    record("2", "1 of 1 written", ["DRV.DEC (p2109): 1 -> 2", "DRV.ACC (p2108): 3000 -> 8000 rpm/s, verified"]),
    record("1", "1 of 1 written", ["DRV.ACC (p2108): 1 -> 3000"]),
  ] as unknown as LogPage["records"];
  expect(lastChange(records, "DRV.ACC")?.record.time).toBe("2");
  expect(lastChange(records, "DRV.ACC")?.change).toContain("8000");
  expect(lastChange(records, "3-41")).toBe(null);
});

test("favourites that are no list of texts are none", () => {
  expect([...favourites.parsed('["p2108", 3, "p1"]')]).toEqual(["p2108", "p1"]);
  for (const text of [null, "{", "{}", "3"]) expect(favourites.parsed(text).size).toBe(0);
});

test("a parameter with the exact name is before those that only have it in their text", () => {
  const line = (number: string, name: string) => ({ key: number, of: { number, name } }) as never;
  const all = [line("p0108", "DRV_ACC"), line("p2108", "DRV.ACC"), line("p2109", "DRV.DEC")];
  expect(edit.exactFirst(all, " drv.acc ").map(({ key }) => key)).toEqual(["p2108", "p0108", "p2109"]);
  expect(edit.exactFirst(all, "acc")).toEqual(all);
  expect(edit.exactFirst(all, "P2109")[0]?.key).toBe("p2109");
});
