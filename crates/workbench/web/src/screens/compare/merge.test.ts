import { beforeAll, expect, test, vi } from "vitest";
import type { Difference } from "../../api";

vi.stubGlobal("location", { search: "" });
let module: typeof import("./merge");
beforeAll(async () => {
  module = await import("./merge");
});

function side(number: string, text: string): NonNullable<Difference["left"]> {
  return { number, text, unit: "rpm/s", error: null } as NonNullable<Difference["left"]>;
}

function differs(number: string, left: string, right: string): Difference {
  return {
    connection: false,
    index: null,
    pnu: 1,
    name: number,
    left: side(number, left),
    right: side(number, right),
  };
}

test("with a base each difference says which side was changed, and from what", () => {
  const all = [differs("a", "2", "1"), differs("b", "1", "3"), differs("c", "2", "3")];
  const sides = {
    left: [differs("a", "1", "2"), differs("c", "1", "2"), differs("d", "1", "5")],
    right: [differs("b", "1", "3"), differs("c", "1", "3"), differs("d", "1", "5")],
  };
  const rows = module.merge(all, sides);
  expect(rows.map(({ of, base, changed }) => [of.name, base?.text, changed])).toEqual([
    ["a", "1", "left"],
    ["b", "1", "right"],
    ["c", "1", "both"],
  ]);
  expect(module.merge(all, null).every(({ base, changed }) => base === null && changed === null)).toBe(true);
});

test("reports have no formula and no markup of a drive", () => {
  const report = { title: "a <b>", head: ["Name", "Left"], rows: [["=1+1", '<img src=x onerror="1">']] };
  expect(module.csv(report)).toBe('Name,Left\r\n\'=1+1,"<img src=x onerror=""1"">"\r\n');
  const page = module.html(report);
  expect(page).toContain("&lt;img src=x onerror=&quot;1&quot;&gt;");
  expect(page).not.toContain("<img");
  expect(page).toContain("<title>a &lt;b&gt;</title>");
});
