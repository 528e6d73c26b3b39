import { beforeAll, expect, test, vi } from "vitest";

// the texts look at the address of the page
vi.stubGlobal("location", { search: "" });
let format: typeof import("./format");
beforeAll(async () => {
  format = await import("./format");
});

test("foreign text is shown as text, cut with a count", () => {
  expect(format.foreign("<img src=x>")).toBe("<img src=x>");
  expect(format.foreign("a\u202eb\u0000c")).toBe("a\u{fffd}b\u{fffd}c");
  expect(format.foreign("x".repeat(65_536))).toBe(`${"x".repeat(120)} .. (+65416)`);
});

test("numbers have fixed decimals and no negative zero", () => {
  const rpm = (value: number) => format.digits({ value, unit: "rpm", beyond: null });
  expect([rpm(120), rpm(-0.01), rpm(-1.25)]).toEqual(["120.0", "0.0", "\u22121.3"]);
  expect(format.digits({ value: 200, unit: "%", beyond: ">" })).toBe(">200.0");
});

test("a cell of a table is never calculated by a spreadsheet", () => {
  for (const text of ["=1+1", "+1", "-1", "@SUM(A1)"]) {
    expect(format.cell(text)).toBe(`'${text}`);
  }
  expect(format.cell('a "b", c')).toBe('"a ""b"", c"');
  expect(format.cell("axis-1")).toBe("axis-1");
});
