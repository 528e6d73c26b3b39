import { expect, test } from "vitest";
import { pause } from "./socket";

test("tries come after longer and longer pauses, up to a bound", () => {
  expect(pause(0, 1)).toBe(250);
  expect(pause(0, 0)).toBe(125);
  expect(pause(3, 1)).toBe(2000);
  expect(pause(30, 1)).toBe(5000);
  expect(pause(2000, 0.5)).toBe(3750);
});
