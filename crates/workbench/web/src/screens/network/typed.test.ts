import { expect, test } from "vitest";
import { typed } from "./typed";

test("an address is checked when all of it is typed", () => {
  expect(typed(" 10.0.0.2", "255.255.255.0", "")).toEqual({ ip: "10.0.0.2", mask: "255.255.255.0", gateway: null });
  expect(typed("10.0.0.2", "255.255.255.0", "10.0.0.254 ")?.gateway).toBe("10.0.0.254");
  for (const [ip, mask, gateway] of [
    ["10.0.0", "255.255.255.0", ""],
    ["10.0.0.256", "255.255.255.0", ""],
    ["10.0.0.02", "255.255.255.0", ""],
    ["10.0.0.2", "", ""],
    ["10.0.0.2", "255.255.255.0", "10"],
  ] as const) {
    expect(typed(ip, mask, gateway)).toBeNull();
  }
});
