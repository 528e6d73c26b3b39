import { expect, test } from "vitest";
import type { StateMachine } from "../../api";
import { curve, edges, lines } from "./diagram";

const row = { text: "", bits: [], also: [] };
const machine: StateMachine = {
  states: [],
  transitions: [
    { ...row, from: "S2", to: "S1", reason: "T16" },
    { ...row, from: "S2", to: "S1", reason: "T2" },
    { ...row, from: "S2", to: "S1", reason: "T2" },
    { ...row, from: "S1", to: "S2", reason: "T1" },
    { ...row, from: "S5", to: "S5", reason: "T13" },
  ],
};

test("rows between the same states are one line with each reason once", () => {
  expect(edges(machine)).toEqual([
    { from: "S2", to: "S1", reasons: ["T16", "T2"] },
    { from: "S1", to: "S2", reasons: ["T1"] },
  ]);
});

test("a long name has two lines", () => {
  expect(["operation", "ready for switching on"].map(lines)).toEqual([["operation"], ["ready for", "switching on"]]);
});

test("both directions have lines and names of their own", () => {
  const [back, forth] = edges(machine).map(curve);
  expect(back?.path).not.toBe(forth?.path);
  expect(Math.abs((back?.y ?? 0) - (forth?.y ?? 0))).toBeGreaterThan(24);
});
