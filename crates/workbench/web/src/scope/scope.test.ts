import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { Acquisition } from "./acquisition";
import { type Block, type Column, columnOf, decode, type Header, type Kind, NO_INTEGER } from "./block";
import { read, recordedAt, shortest, write } from "./csv";
import { derived } from "./maths";
import { picture, Ring } from "./ring";
import { nearest, statistics } from "./statistics";
import { Watch } from "./trigger";

const golden = JSON.parse(readFileSync(new URL("../../../src/live/golden.json", import.meta.url), "utf8")) as {
  name: string;
  stream: number;
  number: number;
  period: number;
  columns: number;
  simulation: boolean;
  lost: number;
  gap: boolean;
  bad: boolean;
  times: number[];
  cells: number[][];
  hex: string;
}[];

function octets(hex: string): ArrayBuffer {
  return Uint8Array.from(hex.match(/../g) ?? [], (pair) => Number.parseInt(pair, 16)).buffer;
}

function column(name: string, type: Kind = "f32", more: Partial<Column> = {}): Column {
  return { name, role: "", unit: "", type, scale: 1, bits: null, from: null, ...more };
}

/** A generator of numbers that is the same in each run. */
function numbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return state;
  };
}

describe("blocks", () => {
  for (const one of golden) {
    test(`golden: ${one.name}`, () => {
      const block = decode(octets(one.hex));
      expect(block).toMatchObject({
        stream: one.stream,
        number: one.number,
        period: one.period,
        columns: one.columns,
        rows: one.times.length,
        lost: one.lost,
        gap: one.gap,
        bad: one.bad,
        simulation: one.simulation,
      });
      expect([...(block?.times ?? [])]).toEqual(one.times);
      for (let place = 0; place < one.columns; place += 1) {
        const cells = columnOf(block as Block, place, "u32");
        expect([...cells]).toEqual(one.cells.map((row) => row[place]));
      }
    });
  }

  test("whole numbers of positions are exact", () => {
    const block = decode(octets(golden[0]?.hex ?? "")) as Block;
    expect([...columnOf(block, 1, "i32")]).toEqual([16_777_217, -16_777_217, 0x7fff_ffff]);
    expect([...columnOf(block, 0, "f32")]).toEqual([0, 19.75, -0.5]);
  });

  test("what was changed on the way is dropped or still a block, and never an error", () => {
    const next = numbers(7);
    const acquisition = new Acquisition();
    acquisition.begin(header([column("a"), column("b", "i32"), column("c", "u32")], 7));
    let valid = 0;
    let wrong = 0;
    for (const { hex } of golden) {
      for (let round = 0; round < 2000; round += 1) {
        const bytes = new Uint8Array(octets(hex).slice(0));
        const length = round % 3 === 0 ? next() % (bytes.length + 1) : bytes.length;
        const copy = bytes.slice(0, length);
        for (let change = 0; change <= next() % 4 && length > 0; change += 1) copy[next() % length] = next() & 0xff;
        const block = decode(copy.buffer);
        if (block === null) wrong += 1;
        else {
          valid += 1;
          expect(copy.length).toBeGreaterThanOrEqual(32 + block.rows * block.columns * 4);
        }
        acquisition.take(block);
      }
    }
    expect(valid).toBeGreaterThan(100);
    expect(acquisition.dropped).toBeGreaterThanOrEqual(wrong);
    expect(wrong).toBeGreaterThan(1000);
    for (const strange of [new ArrayBuffer(0), new ArrayBuffer(31), new ArrayBuffer((1 << 20) + 1)]) {
      expect(decode(strange)).toBe(null);
    }
  });
});

function header(columns: Column[], id = 1, period = 1000): Header {
  const times = { t_us: 0, unix_ms: Date.UTC(2026, 0, 2, 3, 4, 5) };
  const rest = { topic: "", reason: null, telegram: 1, simulation: true, refused: [] as [string, string][] };
  return { ...rest, ...times, id, source: "cyclic", period_us: period, columns };
}

describe("rings", () => {
  test("the pyramid has the extremes of each range", () => {
    const next = numbers(3);
    const ring = new Ring([column("a"), column("w", "u32"), column("p", "i32", { scale: 1 / 1_048_576 })], 12_288);
    const all: [number, number, number][] = [];
    for (let row = 0; row < 40_000; row += 1) {
      const value = next() % 97 === 0 ? Number.NaN : Math.fround((next() / 2 ** 32 - 0.5) * 1000);
      const values: [number, number, number] = [value, next() & 0xffff, (next() | 0) >> 2];
      all.push(values);
      ring.add(
        [row * 1000],
        values.map((one) => [one]),
        false,
        0,
      );
    }
    expect(ring.first).toBe(40_000 - 12_288);
    for (let round = 0; round < 500; round += 1) {
      const from = ring.first + (next() % (ring.next - ring.first));
      const to = from + (next() % (ring.next - from + 1));
      const rows = all.slice(from, to);
      const values = rows.map((row) => row[0]).filter((value) => !Number.isNaN(value));
      const found = ring.extremes(0, from, to);
      expect(found.some).toBe(values.length > 0);
      if (found.some) {
        expect(found).toMatchObject({ low: Math.min(...values), high: Math.max(...values) });
        const words = ring.extremes(1, from, to);
        expect(words.low >>> 0).toBe(rows.reduce((bits, row) => bits & row[1], 0xffff_ffff) >>> 0);
        expect(words.high >>> 0).toBe(rows.reduce((bits, row) => bits | row[1], 0) >>> 0);
        expect(ring.extremes(2, from, to).low).toBe(Math.min(...rows.map((row) => row[2])));
      }
    }
    expect(ring.value(2, ring.next - 1)).toBe((all.at(-1)?.[2] ?? 0) / 1_048_576);
  });

  test("one sample of 600,000 stays visible, with two points for each pixel", () => {
    const ring = new Ring([column("a")], 602_112);
    const length = 600_000;
    const values = new Float32Array(length);
    values[123_457] = 100;
    ring.add(
      Float64Array.from({ length }, (_, row) => row * 1000),
      [values],
      false,
      0,
    );
    const pixels = 1000;
    const { times, values: drawn } = picture(ring, [0], 0, length, pixels);
    const points = drawn[0] ?? new Float64Array();
    expect(points.length).toBeLessThanOrEqual(2 * pixels);
    expect(points.filter((value) => value === 100)).toHaveLength(1);
    const at = times[points.indexOf(100)] ?? 0;
    expect(Math.abs(at - 123_457_000)).toBeLessThan(600_000);
    // buffers do not grow: 16 signals of 10 minutes with a row each ms
    const all = new Ring(
      Array.from({ length: 16 }, (_, place) => column(`s${place}`)),
      600_000,
    );
    expect(all.octets).toBeLessThan(50e6);
  });

  test("few rows are points of their own, and a gap breaks the line", () => {
    const ring = new Ring([column("a")], 100);
    ring.add([0, 10, 20], [[1, 2, 3]], false, 0);
    ring.add([60, 70], [[4, 5]], true, 3);
    const { times, values } = picture(ring, [0], 0, ring.next, 800);
    expect([...times]).toEqual([0, 10, 20, 40, 60, 70]);
    expect([...(values[0] ?? [])]).toEqual([1, 2, 3, Number.NaN, 4, 5]);
    expect(ring.gaps).toEqual([{ row: 3, lost: 3 }]);
    const part = ring.slice(2, 5);
    expect([part.next, part.gaps]).toEqual([3, [{ row: 1, lost: 3 }]]);
    // a time in it was not recorded; a short gap is none that a person sees
    expect(ring.pauses(30)).toEqual([{ from: 20, to: 60 }]);
    expect(ring.pauses(40)).toEqual([]);
  });
});

test("statistics are those of the rows between two cursors", () => {
  const ring = new Ring([column("a")], 100);
  ring.add([0, 10, 20, 30, 40], [[9, 3, Number.NaN, -4, 9]], false, 0);
  const found = statistics(ring, 0, ring.rowAt(10), ring.rowAt(31));
  expect(found).toEqual({ rows: 2, first: 3, last: -4, low: -4, high: 3, mean: -0.5, rms: Math.sqrt(12.5) });
  expect(statistics(ring, 0, 2, 3)).toBe(null);
  expect([nearest(ring, 14), nearest(ring, 16), nearest(ring, 1e9), nearest(ring, -1)]).toEqual([1, 2, 4, 0]);
});

describe("triggers", () => {
  const ring = () => new Ring([column("a"), column("ZSW1", "u32", { role: "status" })], 100);
  const find = (condition: Watch["condition"], rows: [number, number][], gap = -1) => {
    const one = ring();
    const watch = new Watch(one, condition, 0);
    const found: number[] = [];
    rows.forEach(([a, w], row) => {
      one.add([row], [[a], [w]], row === gap, 1);
      const hit = watch.look();
      if (hit !== null) found.push(hit);
    });
    return found;
  };
  test("edges of a signal, of a bit and of a fault, and the end of rest", () => {
    const rows: [number, number][] = [
      [0, 0],
      [0, 8],
      [5, 8],
      [6, 0],
      [2, 8],
      [7, 0],
    ];
    const edge = (edge: "rising" | "falling" | "either") => ({ kind: "edge", signal: "a", edge, level: 4 }) as const;
    expect(find(edge("rising"), rows)).toEqual([2, 5]);
    expect(find(edge("falling"), rows)).toEqual([4]);
    expect(find(edge("either"), rows)).toEqual([2, 4, 5]);
    expect(find({ kind: "fault" }, rows)).toEqual([1, 4]);
    expect(find({ kind: "bit", signal: "ZSW1", bit: 3, edge: "falling" }, rows)).toEqual([3, 5]);
    expect(find({ kind: "change", role: "status" }, rows)).toEqual([1, 4]);
    expect(find(edge("rising"), rows, 2)).toEqual([5]);
    expect(find({ kind: "edge", signal: "b", edge: "rising", level: 0 }, rows)).toEqual([]);
    expect(find(edge("rising"), [[9, 0]])).toEqual([]);
  });
});

function blockOf(values: number[], from: number, more: Partial<Block> = {}): Block {
  const octets = new Float32Array(values).buffer;
  const times = Float64Array.from(values, (_, row) => from + row * 1000);
  const facts = {
    stream: 1,
    number: 0,
    period: 1000,
    columns: 1,
    lost: 0,
    gap: false,
    bad: false,
    simulation: true,
    start: 0,
  };
  return { ...facts, rows: values.length, times, octets, ...more };
}

describe("acquisition", () => {
  test("rows that the drive marked as not valid are counted, and are no values", () => {
    const one = new Acquisition();
    one.begin(header([column("a", "f32")]));
    one.take(blockOf([1, 2], 1000));
    one.take(blockOf([Number.NaN, Number.NaN], 3000, { bad: true }));
    one.take(blockOf([3], 5000));
    expect([one.bad, one.lost, one.dropped]).toEqual([2, 0, 0]);
    expect([0, 1, 2, 3, 4].map((row) => one.ring?.value(0, row))).toEqual([1, 2, Number.NaN, Number.NaN, 3]);
  });

  const condition = { kind: "edge", signal: "a", edge: "rising", level: 1 } as const;
  test("a single shot has its part before the trigger and stops", () => {
    const one = new Acquisition();
    one.span = 10_000;
    one.begin(header([column("a", "f32")]));
    one.single({ mode: "single", condition, pre: 0.2 });
    expect([one.waits, one.able]).toEqual([true, true]);
    for (let row = 0; row < 40; row += 1) one.take(blockOf([row < 20 ? 0 : 2], row * 1000));
    expect([one.running, one.zero, one.shown]).toEqual([false, 20_000, { from: 18_000, to: 28_000 }]);
    const rows = one.ring?.next;
    one.take(blockOf([2], 50_000));
    expect(one.ring?.next).toBe(rows);
    one.run();
    one.take(blockOf([2], 60_000));
    expect([one.running, one.ring?.gaps.length, one.lost]).toEqual([true, 1, 0]);
  });

  test("normal keeps the last event, auto runs on without one", () => {
    const one = new Acquisition();
    one.span = 10_000;
    one.begin(header([column("a", "f32")]));
    one.set({ mode: "normal", condition, pre: 0 });
    const rows = (count: number, value: number, from: number) => {
      for (let row = 0; row < count; row += 1) one.take(blockOf([value], from + row * 1000));
    };
    rows(5, 0, 0);
    rows(20, 2, 5000);
    expect(one.zero).toBe(5000);
    rows(5, 0, 25_000);
    rows(20, 2, 30_000);
    expect([one.zero, one.running]).toEqual([30_000, true]);
    one.set({ mode: "auto", condition, pre: 0 });
    rows(5, 0, 50_000);
    rows(20, 2, 55_000);
    expect(one.zero).toBe(55_000);
    rows(1200, 2, 75_000);
    expect([one.zero, one.shown]).toEqual([null, null]);
  });

  test("loss is counted, foreign streams and columns are not recorded, and the same columns go on", () => {
    const one = new Acquisition();
    one.begin(header([column("a")]));
    one.take(blockOf([1, 2], 0));
    one.take(blockOf([3], 9000, { lost: 6, gap: true }));
    one.take(blockOf([3], 10_000, { stream: 2 }));
    one.take(blockOf([3, 4], 10_000, { columns: 2, rows: 1 }));
    one.take(blockOf([3], 0));
    one.take(null);
    expect([one.ring?.next, one.lost, one.dropped]).toEqual([3, 6, 3]);
    one.begin(header([column("a")], 5));
    one.take(blockOf([4], 90_000, { stream: 5 }));
    expect([one.ring?.next, one.ring?.gaps]).toEqual([
      4,
      [
        { row: 2, lost: 6 },
        { row: 3, lost: 0 },
      ],
    ]);
    one.begin(header([column("b")], 6));
    expect([one.ring?.next, one.lost]).toEqual([0, 0]);
  });

  test("a recording that was stopped keeps its rows whatever begins meanwhile", () => {
    const one = new Acquisition();
    one.begin(header([column("a")]));
    one.take(blockOf([1, 2], 0));
    one.stop();
    one.begin(header([column("b")], 2));
    expect([one.ring?.next, one.header?.columns[0]?.name]).toEqual([2, "a"]);
    one.run();
    expect([one.ring?.next, one.header?.columns[0]?.name]).toEqual([0, "b"]);
  });
});

describe("files", () => {
  const columns = [
    column("NIST_A", "f32", { unit: "rpm", role: "speed" }),
    column("XIST_A", "i32", { unit: "rev", scale: 1 / 1_048_576 }),
    column("ZSW1", "u32", { bits: ["RTSO"] }),
    column('=x, "y"', "f32"),
  ];
  test("what was written is read again, number by number", () => {
    const next = numbers(5);
    const ring = new Ring(columns, 1000);
    let time = 5_000_000;
    for (let row = 0; row < 500; row += 1) {
      time += 1000 + (next() % 3);
      const gap = row % 100 === 50;
      if (gap) time += 7000;
      const value = Math.fround((next() / 2 ** 32) * 300 - 150);
      const values = [value, (next() | 0) >> 1, next() & 0xffff, row % 7 === 0 ? Number.NaN : value];
      ring.add(
        [time],
        values.map((one) => [one]),
        gap,
        gap ? 6 : 0,
      );
    }
    const text = write({ drive: "=axis-1", ring }, 0, ring.next, header(columns));
    expect(text.split("\n")[0]).toBe(`t,wall,drive,gap,NIST_A [rpm],XIST_A [rev],ZSW1,"'=x, ""y"""`);
    expect(text.split("\n")[1]).toMatch(/^0\.000000000,2026-01-02T03:04:10\.\d{3}Z,'=axis-1,false,/);
    const sheet = read(text, columns);
    expect(sheet.drive).toBe("=axis-1");
    expect(sheet.ring.columns.map(({ name, unit, bits }) => ({ name, unit, bits }))).toEqual(
      columns.map(({ name, unit, bits }) => ({ name, unit, bits })),
    );
    expect(sheet.ring.gaps).toEqual(ring.gaps);
    expect(sheet.ring.next).toBe(ring.next);
    for (let row = 0; row < ring.next; row += 1) {
      expect(sheet.ring.time(row)).toBe(ring.time(row) - ring.time(0));
      columns.forEach((one, place) => {
        const value = sheet.ring.value(place, row);
        expect(one.type === "f32" ? Math.fround(value) : value).toBe(ring.value(place, row));
      });
    }
    // the lines of gaps too, whose times belong to no row
    const unstamped = (lines: string) => lines.replaceAll(/,2026-[^,]*,/g, ",,");
    const again = { drive: sheet.drive, ring: sheet.ring };
    expect(write(again, 0, sheet.ring.next, null)).toBe(unstamped(text));
  });

  test("numbers of 32 bits are written as short as they can be", () => {
    expect([
      shortest(Math.fround(0.1)),
      shortest(19.75),
      shortest(Math.fround(1 / 3)),
      shortest(Math.fround(118.257256)),
    ]).toEqual(["0.1", "19.75", "0.33333334", "118.257256"]);
  });

  test("a file of something else is refused with its line", () => {
    for (const [text, reason] of [
      ["", /line 1/],
      ["a,b,c\n1,2,3", /line 1/],
      ["t,wall,drive,gap,a\n0,,x,false", /line 2/],
      ["t,wall,drive,gap,a\n0,,x,false,1\n,,x,false,1", /line 3/],
      ["t,wall,drive,gap,a\n0,,x,false,<b>", /line 2: `<b>` is not a number/],
      ["t,wall,drive,gap,a\n", /no row/],
    ] as const) {
      expect(() => read(text, []), text).toThrow(reason);
    }
  });
});

describe("differences", () => {
  const columns = [
    column("set", "f32", { unit: "rpm" }),
    column("actual", "i32", { unit: "rpm", scale: 0.5 }),
    column("word", "u32"),
    column("position", "f32", { unit: "rev" }),
  ];
  const maths = [
    { key: "one", a: "set", b: "actual" },
    { key: "units", a: "set", b: "position" },
    { key: "word", a: "word", b: "set" },
    { key: "missing", a: "set", b: "nothing" },
  ];

  function rows(acquisition: Acquisition): Acquisition {
    const ring = new Ring(columns, 100);
    ring.add(
      [0, 1, 2],
      [
        [1, 2, 3],
        [4, NO_INTEGER, 8],
        [1, 2, 3],
        [0, 0, 0],
      ],
      false,
      0,
    );
    ring.add([10], [[5], [2], [4], [0]], true, 7);
    acquisition.open(header(columns, 1), ring);
    return acquisition;
  }

  test("only of numbers that are there, in one unit", () => {
    expect(derived(columns, maths).map(({ column }) => [column.name, column.unit, column.role])).toEqual([
      ["set - actual", "rpm", "one"],
    ]);
    // a file that has the difference already
    expect(derived([...columns, column("set - actual")], maths)).toEqual([]);
  });

  test("what is recorded has them too, with its gaps and what is missing", () => {
    const acquisition = rows(new Acquisition());
    acquisition.calculate(maths);
    const { ring } = acquisition;
    expect(ring?.columns.map(({ name }) => name)).toEqual(["set", "actual", "word", "position", "set - actual"]);
    expect([0, 1, 2, 3].map((row) => ring?.value(4, row))).toEqual([-1, Number.NaN, -1, 4]);
    expect(ring?.gaps).toEqual([{ row: 3, lost: 7 }]);
    acquisition.calculate([]);
    expect(acquisition.ring?.columns).toHaveLength(4);
    expect(acquisition.header?.columns).toHaveLength(4);
  });

  test("what comes has them, and a file as well", () => {
    const acquisition = new Acquisition();
    acquisition.calculate([{ key: "d", a: "a", b: "b" }]);
    acquisition.begin(header([column("a"), column("b", "i32"), column("c", "u32")], golden[0]?.stream ?? 0));
    expect(acquisition.take(decode(octets(golden[0]?.hex ?? "")))).toBe(true);
    expect(acquisition.ring?.value(3, 1)).toBe(19.75 + 16_777_217);
    const opened = new Acquisition();
    opened.calculate(maths);
    expect(rows(opened).ring?.value(4, 0)).toBe(-1);
  });
});

test("a recording has the time of day of its values, as far as it is known", () => {
  const clock = { t_us: 5_000_000, unix_ms: Date.UTC(2026, 10, 26, 20, 58, 24, 500) };
  expect(recordedAt(clock, 4_669_000)).toBe("2026-11-26 20:58:24.169 UTC");
  // a file has no clock
  expect(recordedAt({ t_us: 0, unix_ms: 0 }, 4_669_000)).toBeNull();
  expect(recordedAt(clock, null)).toBeNull();
});
