/** Where the states and transitions of the diagram are, made of the table that the workbench sends. */
import type { StateMachine } from "../../api";

export type State = StateMachine["states"][number]["state"];

/** All transitions from one state to another. */
export interface Edge {
  from: State;
  to: State;
  reasons: string[];
}

/** Size of a state, and of the diagram. */
export const WIDTH = 104;
export const HEIGHT = 60;
export const SIZE = { width: 640, height: 308 };

/** The centre of each state: the way to operation from left to right, the way out above it. */
const PLACES: Record<State, [number, number]> = {
  S1: [64, 196],
  S2: [236, 196],
  S3: [404, 196],
  S4: [576, 196],
  S5: [404, 40],
};

/** Returns the name of a state in one line or two, divided at the space nearest to its middle. */
export function lines(name: string): string[] {
  if (name.length < 16) return [name];
  const middle = name.length / 2;
  const spaces = [...name.matchAll(/ /g)].map(({ index }) => index);
  const at = spaces.sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle))[0];
  return at === undefined ? [name] : [name.slice(0, at), name.slice(at + 1)];
}

/** `T2` before `T16`. */
const numbers = new Intl.Collator("en", { numeric: true });

/** Returns the transitions by their states, each reason once, in the order of their numbers. */
export function edges({ transitions }: StateMachine): Edge[] {
  const all: Edge[] = [];
  for (const { from, to, reason } of transitions) {
    const known = all.find((edge) => edge.from === from && edge.to === to);
    if (from === to) continue;
    if (known === undefined) all.push({ from, to, reasons: [reason] });
    else if (!known.reasons.includes(reason)) known.reasons.push(reason);
  }
  for (const { reasons } of all) reasons.sort(numbers.compare);
  return all;
}

export function place(state: State): [number, number] {
  return PLACES[state];
}

/** Returns where a line from the centre of a state leaves it. */
function leaves([x, y]: [number, number], [toX, toY]: [number, number]): [number, number] {
  const [dx, dy] = [toX - x, toY - y];
  const share = Math.min(
    dx === 0 ? Number.POSITIVE_INFINITY : WIDTH / 2 / Math.abs(dx),
    dy === 0 ? Number.POSITIVE_INFINITY : HEIGHT / 2 / Math.abs(dy),
  );
  return [x + dx * share, y + dy * share];
}

/** Half the size of a name in the diagram: of each character, and its height. */
const HALF_CHARACTER = 3.6;
const HALF_LINE = 6;
/** Between a line and its name. */
const CLEAR = 4;

/** Returns the path of a transition and where its name stands. Both directions between two states are beside each other. */
export function curve({ from, to, reasons }: Edge): { path: string; x: number; y: number } {
  const [a, b] = [place(from), place(to)];
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(dx, dy);
  // past a state that is between them: below the row, and from above it at the far side
  const past = dy === 0 && length > 200;
  const off = past ? Math.min(90, length * 0.18) : length > 300 ? -40 : 14;
  const [nx, ny] = [dy / length, -dx / length];
  const control: [number, number] = [(a[0] + b[0]) / 2 + 2 * nx * off, (a[1] + b[1]) / 2 + 2 * ny * off];
  const [start, end] = [leaves(a, control), leaves(b, control)];
  const path = `M${start[0]} ${start[1]}Q${control[0]} ${control[1]} ${end[0]} ${end[1]}`;
  // a slanting line passes the corner of its name; between two lines below the row a name is above its own
  const half = reasons.join(" ").length * HALF_CHARACTER * Math.abs(nx) + HALF_LINE * Math.abs(ny);
  const beside = (half + CLEAR) * Math.sign(off) * (past ? -1 : 1);
  return {
    path,
    x: (start[0] + 2 * control[0] + end[0]) / 4 + nx * beside,
    y: (start[1] + 2 * control[1] + end[1]) / 4 + ny * beside + 4,
  };
}
