import { expect, test } from "vitest";
import type { Fault } from "../../api";
import { history } from "./history";

function fault(number: number, situation: number): Fault {
  const none = {
    cleared: null,
    meaning: null,
    needs_restart: null,
    parameters: [],
    reaction: null,
    remedy: null,
    time: null,
    value: null,
  };
  return { ...none, number, situation, position: 0, acknowledged: situation > 0 };
}

test("a fault that came again and again is one line", () => {
  const lines = history([fault(7, 0), fault(439, 1), fault(439, 2), fault(439, 3), fault(1, 4), fault(439, 5)]);
  expect(lines.map(({ fault, count, situation }) => [fault.number, count, situation])).toEqual([
    [439, 3, "1"],
    [1, 1, "4"],
    [439, 1, "5"],
  ]);
});

test("two faults of one situation are two lines", () => {
  expect(history([fault(5, 1), fault(5, 1)]).length).toBe(2);
});
