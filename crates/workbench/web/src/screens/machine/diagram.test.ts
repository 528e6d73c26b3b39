import { expect, test } from "vitest";
import type { StateMachine } from "../../api";
import { curve, edges, HEIGHT, lines, place, SIZE, type State, WIDTH } from "./diagram";

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
    { from: "S2", to: "S1", reasons: ["T2", "T16"] },
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

/** The transitions of the profile. */
const ALL = `S1 S2 T1, S2 S1 T2, S2 S3 T3, S3 S2 T4, S3 S1 T5, S3 S4 T6, S4 S3 T7, S4 S5 T8, S4 S5 T9, S4 S1 T10, S5 S4 T11, S5 S2 T12,
  S5 S1 T14, S5 S1 T15, S2 S1 T16, S3 S1 T16, S4 S1 T16, S4 S5 T16, S5 S1 T16`;

test("no name touches a line, a state or another name", () => {
  const transitions = ALL.split(",").map((text) => {
    const [from, to, reason] = text.trim().split(" ") as [State, State, string];
    return { ...row, from, to, reason };
  });
  const drawn = edges({ states: [], transitions }).map((edge) => ({ edge, ...curve(edge) }));
  const boxes = drawn.map(({ edge, x, y }) => {
    const half = edge.reasons.join(" ").length * 3.5;
    return { name: edge.reasons.join(" "), left: x - half, right: x + half, top: y - 10, bottom: y + 2 };
  });
  const inside = (box: (typeof boxes)[number], x: number, y: number) =>
    x > box.left && x < box.right && y > box.top && y < box.bottom;
  const touched: string[] = [];
  for (const box of boxes) {
    for (const { edge, path } of drawn) {
      const [x0, y0, x1, y1, x2, y2] = path.slice(1).split(/[Q ]/).map(Number) as [
        number,
        number,
        number,
        number,
        number,
        number,
      ];
      for (let part = 0; part <= 1; part += 0.005) {
        const [a, b, c] = [(1 - part) ** 2, 2 * part * (1 - part), part ** 2];
        if (inside(box, a * x0 + b * x1 + c * x2, a * y0 + b * y1 + c * y2)) {
          touched.push(`${box.name} on ${edge.from} ${edge.to}`);
          break;
        }
      }
    }
    for (const state of ["S1", "S2", "S3", "S4", "S5"] as const) {
      const [x, y] = place(state);
      const apart =
        box.right < x - WIDTH / 2 ||
        box.left > x + WIDTH / 2 ||
        box.bottom < y - HEIGHT / 2 ||
        box.top > y + HEIGHT / 2;
      if (!apart) touched.push(`${box.name} on ${state}`);
    }
    for (const other of boxes) {
      const apart =
        box.right < other.left || box.left > other.right || box.bottom < other.top || box.top > other.bottom;
      if (other !== box && !apart) touched.push(`${box.name} on ${other.name}`);
    }
    if (box.left < 0 || box.right > SIZE.width || box.top < 0 || box.bottom > SIZE.height)
      touched.push(`${box.name} outside`);
  }
  expect(touched).toEqual([]);
});
