import { expect, test } from "vitest";
import { type Record, rows } from "./rows";

function record(time: string, action: string, result: string | null, more: Partial<Record> = {}): Record {
  const of = {
    boot: "1",
    who: "1",
    claimed_name: null,
    drive: "a",
    name: "axis-1",
    serial: null,
    engine_us: null,
    epoch: null,
  };
  return { time, ...of, action, value: null, changes: [], result, ...more };
}

test("an action has one row: its result, with the time of its request", () => {
  const log = [
    record("5", "jog", null, { value: "20 rpm" }),
    record("4", "enable", "done"),
    record("3", "enable", null),
    record("2", "write", "1 of 1 written", { changes: [] }),
    record("1", "write", null, { changes: ["DRV.ACC: 3000 -> 8000"] }),
  ];
  const all = rows(log);
  expect(all.map(({ record, requested }) => [record.action, record.result, requested])).toEqual([
    ["jog", null, null],
    ["enable", "done", "3"],
    ["write", "1 of 1 written", "1"],
  ]);
  expect(all[2]?.record.changes).toEqual(["DRV.ACC: 3000 -> 8000"]);
});

test("equal actions, those of others and what has no request keep their rows", () => {
  const log = [
    record("6", "stop", "STOP 1: axis-1", { drive: null }),
    record("5", "inject", "second"),
    record("4", "inject", "first"),
    record("3", "inject", null),
    record("2", "inject", null, { boot: "0" }),
    record("1", "inject", null),
  ];
  expect(rows(log).map(({ record, requested }) => [record.result, requested])).toEqual([
    ["STOP 1: axis-1", null],
    ["second", "3"],
    ["first", "1"],
    [null, null],
  ]);
});
