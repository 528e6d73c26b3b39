/** Receives, keeps and measures samples. The page gets at most two points for each pixel, 30 times a second. */
import { Acquisition, type Span } from "./acquisition";
import { type Block, type Column, decode, type Header } from "./block";
import { read, write } from "./csv";
import type { Frame, FromWorker, Measured, Status, ToWorker } from "./protocol";
import { picture, type Ring } from "./ring";
import { Source } from "./source";
import { nearest, statistics } from "./statistics";

const post = (message: FromWorker, transfer: Transferable[] = []): void =>
  (self as unknown as { postMessage(message: FromWorker, transfer: Transferable[]): void }).postMessage(
    message,
    transfer,
  );

/** Time between two pictures, and between two measurements of many rows, in ms. */
const FRAME = 33;
const STATUS = 200;
/** Statistics of more rows than this are made as often as the status. */
const MANY = 50_000;

const acquisition = new Acquisition();
let source: Source | null = null;
let drive = "";
/** The drive in the file that is shown. */
let named: string | null = null;
let connected = false;
let visible = true;
/** Messages of the page so far. */
let obeyed = 0;
let reason: string | null = null;
let columns: string[] = [];
let pixels = 800;
let cursors: [number, number] | null = null;
let overlay: { ring: Ring; view: Span } | null = null;
let generator = 0;
/** Something is to be drawn. */
let changed = true;
/** The page has not taken the last picture yet. Those of a page that is too slow would pile up, and be older and older. */
let owed = false;
let statusAt = 0;
let measured: { at: number; key: string; names: string; ring: Ring; values: Measured[] } | null = null;

function places(ring: Ring, names: readonly string[]): number[] {
  return names.map((name) => ring.columns.findIndex((column) => column.name === name)).filter((place) => place >= 0);
}

/** The columns that are shown and there. */
const here = (ring: Ring): string[] => columns.filter((name) => ring.columns.some((column) => column.name === name));

/** Where the cursors are in a picture. */
function cursorsIn(view: Span): [number, number] | null {
  if (cursors === null) return null;
  const at = (part: number) => view.from + part * (view.to - view.from);
  return [at(cursors[0]), at(cursors[1])];
}

function measure(ring: Ring, names: readonly string[], view: Span, now: number): Measured[] {
  const [a, b] = cursorsIn(view) ?? [view.from, view.to];
  const [from, to] = [ring.rowAt(Math.min(a, b)), ring.rowAt(Math.max(a, b) + 1)];
  const key = JSON.stringify([a, b, names, from, to]);
  if (measured !== null && measured.ring === ring) {
    const many = to - from > MANY && measured.names === names.join();
    if (measured.key === key || (many && now - measured.at < STATUS)) return measured.values;
  }
  const [rowA, rowB] = [nearest(ring, a), nearest(ring, b)];
  const at = (place: number, row: number | null) =>
    cursors === null || row === null ? Number.NaN : ring.value(place, row);
  const values = places(ring, names).map((place): Measured => {
    const name = ring.columns[place]?.name ?? "";
    return { name, a: at(place, rowA), b: at(place, rowB), between: statistics(ring, place, from, to) };
  });
  measured = { at: now, key, names: names.join(), ring, values };
  return values;
}

function frame(now: number): void {
  const ring = acquisition.ring;
  const view = acquisition.view();
  if (ring === null || ring.next === 0) return;
  const names = here(ring);
  const [from, to] = [Math.max(ring.first, ring.rowAt(view.from) - 1), ring.rowAt(view.to) + 1];
  const drawn = picture(ring, places(ring, names), from, to, pixels);
  const gaps = ring.gaps
    .filter((gap) => gap.row > from && gap.row < to)
    .map((gap) => ({ from: ring.time(gap.row - 1), to: ring.time(gap.row), lost: gap.lost }));
  let before: Frame["overlay"] = null;
  if (overlay !== null) {
    const old = overlay.ring;
    const shared = names.filter((name) => old.columns.some((column) => column.name === name));
    const past = picture(old, places(old, shared), old.first, old.next, pixels);
    const shift = view.from - overlay.view.from;
    before = { times: past.times.map((time) => time + shift), values: past.values, columns: shared };
  }
  const message: Frame = {
    type: "frame",
    view,
    cursors: cursorsIn(view),
    zero: acquisition.zero ?? ring.time(ring.first),
    triggered: acquisition.zero !== null,
    columns: names,
    ...drawn,
    gaps,
    overlay: before,
    measured: measure(ring, names, view, now),
  };
  const buffers = [message.times, ...message.values, ...(before ? [before.times, ...before.values] : [])];
  post(
    message,
    buffers.map((buffer) => buffer.buffer as ArrayBuffer),
  );
  owed = true;
}

/** A shorter time without values is no pause of the recording, in us. */
const PAUSE = 1e6;

function status(): void {
  const ring = acquisition.ring;
  const kept = ring !== null && ring.next > 0 ? { from: ring.time(ring.first), to: acquisition.latest } : null;
  const message: Status = {
    type: "status",
    obeyed,
    drive,
    header: acquisition.header,
    connected,
    running: acquisition.running,
    waits: acquisition.waits,
    able: acquisition.able,
    rate: acquisition.rate(),
    rows: ring === null ? 0 : ring.next - ring.first,
    lost: acquisition.lost,
    bad: acquisition.bad,
    dropped: acquisition.dropped,
    reason,
    kept,
    pauses: ring?.pauses(PAUSE) ?? [],
    octets: ring?.octets ?? 0,
  };
  post(message);
}

setInterval(() => {
  const now = performance.now();
  if (changed && visible && !owed) {
    changed = false;
    frame(now);
  }
  if (now - statusAt >= STATUS) {
    statusAt = now;
    status();
  }
}, FRAME);

function take(block: Block | null): void {
  const ran = acquisition.running;
  changed = acquisition.take(block) || changed;
  // a single shot that has ended is shown at once
  if (ran !== acquisition.running) statusAt = 0;
}

function open(message: ToWorker & { type: "open" }): void {
  close();
  if (drive !== message.drive) acquisition.clear();
  drive = message.drive;
  source = new Source(message.drive, message.address, message.parameters, message.wanted, visible, {
    header: (header) => {
      reason = null;
      acquisition.begin(header);
      status();
    },
    block: (octets) => take(decode(octets)),
    nothing: (why) => {
      reason = why;
      status();
    },
    connected: (on) => {
      connected = on;
      status();
    },
  });
  status();
}

function close(): void {
  source?.close();
  source = null;
  connected = false;
  named = null;
  reason = null;
  clearInterval(generator);
}

function header(name: Header["source"], columns: Column[], period: number): Header {
  return {
    topic: "",
    id: 0,
    source: name,
    reason: null,
    period_us: period,
    telegram: null,
    simulation: true,
    t_us: 0,
    unix_ms: 0,
    columns,
    refused: [],
  };
}

/** Makes rows of sines in the pace of the clock. */
function generate({ columns: count, rate }: ToWorker & { type: "generate" }): void {
  close();
  acquisition.clear();
  acquisition.run();
  drive = "";
  const period = 1e6 / rate;
  const names = Array.from({ length: count }, (_, place): Column => {
    const name = `test ${place + 1}`;
    return { name, role: "", unit: "rpm", type: "f32", scale: 1, bits: null, from: null };
  });
  acquisition.begin(header("test", names, period));
  let row = 0;
  const begin = performance.now();
  generator = setInterval(() => {
    const due = Math.floor(((performance.now() - begin) * rate) / 1000) - row;
    const rows = Math.min(due, 4000);
    if (rows <= 0) return;
    const times = new Float64Array(rows).map((_, at) => Math.round((row + at) * period));
    const octets = new ArrayBuffer(rows * count * 4);
    const values = new Float32Array(octets);
    for (let place = 0; place < count; place += 1) {
      for (let at = 0; at < rows; at += 1) {
        const time = ((row + at) * period) / 1e6;
        values[place * rows + at] = 10 * place + 5 * Math.sin(time * (place + 1));
      }
    }
    const facts = { stream: 0, number: 0, period, lost: 0, gap: false, bad: false, simulation: true, start: 0 };
    take({ ...facts, rows, columns: count, times, octets });
    row += rows;
  }, FRAME) as unknown as number;
}

function save(between: boolean, name: string): void {
  const ring = acquisition.ring;
  if (ring === null || ring.next === 0) return;
  const marks = between ? cursorsIn(acquisition.view()) : null;
  const from = marks === null ? ring.first : ring.rowAt(Math.min(...marks));
  const to = marks === null ? ring.next : ring.rowAt(Math.max(...marks) + 1);
  const clock = acquisition.header !== null && acquisition.header.unix_ms > 0 ? acquisition.header : null;
  post({ type: "saved", text: write({ drive: named ?? name, ring }, from, to, clock) });
}

function load(text: string, name: string): void {
  try {
    const sheet = read(text, acquisition.ring?.columns ?? []);
    close();
    drive = name;
    acquisition.open(header("file", [...sheet.ring.columns], 0), sheet.ring);
    named = sheet.drive;
    changed = true;
  } catch (error) {
    post({ type: "failed", text: error instanceof Error ? error.message : String(error) });
  }
  status();
}

function keep(on: boolean): void {
  const ring = acquisition.ring;
  const view = acquisition.view();
  overlay =
    on && ring !== null
      ? { ring: ring.slice(ring.rowAt(view.from), ring.rowAt(view.to) + 1), view: { ...view } }
      : null;
}

function obey(message: Exclude<ToWorker, { type: "drawn" }>): void {
  switch (message.type) {
    case "open":
      open(message);
      return;
    case "close":
      close();
      return;
    case "forget":
      acquisition.clear();
      source?.again();
      return;
    case "visible":
      visible = message.visible;
      source?.setVisible(visible);
      return;
    case "show":
      ({ columns, pixels, cursors } = message);
      acquisition.span = message.span;
      return;
    case "move":
      if (!acquisition.running) acquisition.shown = message.view;
      return;
    case "run":
      acquisition.run();
      return;
    case "stop":
      acquisition.stop();
      return;
    case "single":
      acquisition.single(message.trigger);
      return;
    case "trigger":
      acquisition.set(message.trigger);
      return;
    case "calculate":
      acquisition.calculate(message.maths);
      return;
    case "save":
      save(message.between, message.drive);
      return;
    case "load":
      load(message.text, message.name);
      return;
    case "overlay":
      keep(message.keep);
      return;
    case "generate":
      generate(message);
      return;
  }
}

addEventListener("message", ({ data }: MessageEvent<ToWorker>) => {
  obeyed += 1;
  if (data.type === "drawn") {
    owed = false;
    return;
  }
  obey(data);
  changed = true;
  statusAt = 0;
});
