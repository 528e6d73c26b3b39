import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type uPlot from "uplot";
import type { Frame } from "../../scope/protocol";
import * as scope from "../../store/scope";
import { t } from "../../text";

/** Colours of the signals; those from 9 to 16 repeat them with dashes. */
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#c98500", "#3d9bd6", "#8a7fe0", "#7a8896"];

/** What a signal is drawn with. */
export function penOf(place: number): { colour: string; dash: number[] } {
  return { colour: COLOURS[place % COLOURS.length] ?? "", dash: place < COLOURS.length ? [] : [6, 4] };
}

const AXIS = 72;
/** Height of the unit of an axis. */
const UNIT = 16;
const LANE = 26;
/** Room for half of the last number of the time. */
const RIGHT = 16;
const HEIGHT = 300;

const forced = matchMedia("(forced-colors: active)");
/** What is drawn has no colours of the system by itself. */
const SYSTEM: Readonly<Record<string, string>> = {
  "--text": "CanvasText",
  "--muted": "CanvasText",
  "--surface": "Canvas",
  "--soft": "GrayText",
  "--grid": "GrayText",
  "--accent": "Highlight",
};

function style(name: string): string {
  if (forced.matches) return SYSTEM[name] ?? "CanvasText";
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Series of a plot have a gap where there is no number. Those without one are not copied: it is much work for each picture. */
function series(values: Float64Array = new Float64Array()): (number | null)[] | Float64Array {
  return values.some(Number.isNaN) ? Array.from(values, (value) => (Number.isNaN(value) ? null : value)) : values;
}

interface Drawn {
  main: uPlot;
  lanes: uPlot | null;
  /** What they were built for. */
  key: string;
}

/** The pictures on the screen; for the file with them. */
let drawn: Drawn | null = null;

/** Draws gaps, the trigger and the cursors into a plot. */
function marks(plot: uPlot, frame: Frame, words: boolean): void {
  const { ctx, bbox } = plot;
  const ratio = devicePixelRatio;
  const x = (time: number) => plot.valToPos((time - frame.zero) / 1e6, "x", true);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = `${12 * ratio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "alphabetic";
  for (const gap of frame.gaps) {
    const [from, to] = [x(gap.from), x(gap.to)];
    ctx.fillStyle = style("--soft");
    ctx.globalAlpha = 0.6;
    ctx.fillRect(from, bbox.top, Math.max(ratio, to - from), bbox.height);
    ctx.globalAlpha = 1;
    if (words) {
      ctx.fillStyle = style("--text");
      const text = gap.lost > 0 ? t("scope.lost", { count: gap.lost }) : t("scope.pause");
      ctx.fillText(text, from + 4 * ratio, bbox.top + bbox.height - 6 * ratio);
    }
  }
  const line = (time: number, colour: string, dash: number[], flag: string) => {
    const at = Math.round(x(time));
    ctx.strokeStyle = colour;
    ctx.lineWidth = ratio;
    ctx.setLineDash(dash.map((one) => one * ratio));
    ctx.beginPath();
    ctx.moveTo(at, bbox.top);
    ctx.lineTo(at, bbox.top + bbox.height);
    ctx.stroke();
    ctx.setLineDash([]);
    if (words && flag !== "") {
      // a flag at the right end stands at the left of its line
      const flagAt = Math.min(at, bbox.left + bbox.width - 16 * ratio);
      ctx.fillStyle = colour;
      ctx.fillRect(flagAt, bbox.top, 16 * ratio, 16 * ratio);
      ctx.fillStyle = style("--surface");
      ctx.fillText(flag, flagAt + 4 * ratio, bbox.top + 12 * ratio);
    }
  };
  if (frame.triggered) line(frame.zero, style("--muted"), [2, 3], "");
  frame.cursors?.forEach((time, place) => {
    line(time, style("--accent"), [], place === 0 ? "A" : "B");
  });
  ctx.restore();
}

function build(Uplot: typeof uPlot, host: HTMLElement, width: number, key: string): Drawn {
  host.replaceChildren();
  const signals = scope.chosen();
  const analog = signals.filter(({ bit, column }) => bit === null && column.type !== "u32");
  const bits = signals.filter(({ bit }) => bit !== null);
  const units = [...new Set(analog.map(({ column }) => column.unit))];
  const [text, grid] = [style("--muted"), style("--grid")];
  const font = "12px system-ui, sans-serif";
  const right = Math.max(0, units.length - 1) * (AXIS + UNIT);
  const axis = { stroke: text, font, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 } };
  const pen = (signal: scope.Found) => penOf(signals.indexOf(signal));
  const frame = () => scope.frame.value;
  const draw = (words: boolean) => (plot: uPlot) => {
    const now = frame();
    if (now !== null) marks(plot, now, words);
  };
  const before = (plot: uPlot) => {
    const now = frame();
    if (now !== null) under(plot, now);
  };
  const cursor: uPlot.Cursor = {
    y: false,
    points: { show: false },
    drag: { x: true, y: false, setScale: false },
    bind: {
      click: (plot) => (event: MouseEvent) => {
        const now = frame();
        if (now !== null && plot.select.width < 5) {
          const part = Math.min(1, Math.max(0, (plot.cursor.left ?? 0) / plot.over.clientWidth));
          const [a, b] = scope.cursors.value ?? [0.25, 0.75];
          scope.cursors.value = event.shiftKey ? [a, part] : [part, b];
        }
        return null;
      },
    },
  };
  const select = (plot: uPlot) => {
    const { left, width } = plot.select;
    const now = frame();
    if (width < 5 || now === null || scope.status.value?.running !== false) return;
    const at = (pixel: number) => now.zero + plot.posToVal(pixel, "x") * 1e6;
    scope.move(at(left), at(left + width));
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  };
  const main = new Uplot(
    {
      width,
      height: HEIGHT,
      padding: [8, RIGHT, 0, 0],
      legend: { show: false },
      cursor,
      scales: { x: { time: false }, ...Object.fromEntries(units.map((unit) => [`y ${unit}`, {}])) },
      axes: [
        { ...axis, label: t("scope.time"), labelFont: font, labelSize: 18, size: 30 },
        ...units.map((unit, place) => ({
          ...axis,
          scale: `y ${unit}`,
          side: place === 0 ? (3 as const) : (1 as const),
          size: AXIS,
          label: unit,
          labelFont: font,
          labelSize: UNIT,
          grid: { ...axis.grid, show: place === 0 },
        })),
      ],
      series: [
        {},
        ...analog.map((signal) => ({
          label: signal.column.name,
          scale: `y ${signal.column.unit}`,
          stroke: pen(signal).colour,
          dash: pen(signal).dash,
          width: 1.5,
          points: { show: false },
        })),
      ],
      hooks: { drawAxes: [before], draw: [draw(true)], setSelect: [select] },
    },
    [[], ...analog.map(() => [])],
    host,
  );
  let lanes: uPlot | null = null;
  if (bits.length > 0) {
    const names = bits.map(({ column, bit }) => bitName(column, bit ?? 0));
    const stepped = Uplot.paths.stepped?.({ align: 1 });
    lanes = new Uplot(
      {
        width,
        height: bits.length * LANE + 8,
        padding: [4, RIGHT + right, 4, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false }, lanes: { range: [0, bits.length] } },
        axes: [
          { show: false },
          {
            ...axis,
            scale: "lanes",
            // as wide as the first axis above
            size: units.length === 0 ? AXIS : AXIS + UNIT,
            splits: () => bits.map((_, place) => bits.length - place - 0.6),
            values: () => names,
            grid: { show: false },
          },
        ],
        series: [
          {},
          ...bits.map((signal) => ({
            scale: "lanes",
            stroke: pen(signal).colour,
            dash: pen(signal).dash,
            width: 1.5,
            points: { show: false },
            ...(stepped ? { paths: stepped } : {}),
          })),
        ],
        hooks: { draw: [draw(false)] },
      },
      [[], ...bits.map(() => [])],
      host,
    );
  }
  return { main, lanes, key };
}

/** `ZSW1.3 FAULT` */
export function bitName(column: scope.Found["column"], bit: number): string {
  const name = column.bits?.[bit];
  return name ? name : `${column.name}.${bit}`;
}

function paint({ main, lanes }: Drawn, frame: Frame): void {
  const signals = scope.chosen();
  const x = frame.times.map((time) => (time - frame.zero) / 1e6);
  const of = (signal: scope.Found) => frame.values[frame.columns.indexOf(signal.column.name)];
  const range = { min: (frame.view.from - frame.zero) / 1e6, max: (frame.view.to - frame.zero) / 1e6 };
  const analog = signals.filter(({ bit, column }) => bit === null && column.type !== "u32");
  if (analog.length + 1 === main.series.length) {
    main.batch(() => {
      main.setData([x, ...analog.map((signal) => series(of(signal)))] as uPlot.AlignedData, true);
      main.setScale("x", range);
    });
  }
  const bits = signals.filter(({ bit }) => bit !== null);
  if (lanes !== null && bits.length + 1 === lanes.series.length) {
    const levels = bits.map((signal, place) => {
      const low = bits.length - place - 1 + 0.1;
      return Array.from(of(signal) ?? [], (word) =>
        Number.isNaN(word) ? null : low + ((word >>> (signal.bit ?? 0)) & 1) * 0.7,
      );
    });
    lanes.batch(() => {
      lanes?.setData([x, ...levels] as uPlot.AlignedData, true);
      lanes?.setScale("x", range);
    });
  }
}

/** An earlier run, drawn beneath. */
function under(plot: uPlot, frame: Frame): void {
  const before = frame.overlay;
  if (before === null) return;
  const { ctx, bbox } = plot;
  const signals = scope.chosen();
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = devicePixelRatio;
  ctx.globalAlpha = 0.7;
  ctx.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
  signals.forEach((signal, place) => {
    const values = before.values[before.columns.indexOf(signal.column.name)];
    if (signal.bit !== null || signal.column.type === "u32" || values === undefined) return;
    ctx.strokeStyle = penOf(place).colour;
    ctx.beginPath();
    let begins = true;
    before.times.forEach((time, row) => {
      const value = values[row] ?? Number.NaN;
      if (Number.isNaN(value)) {
        begins = true;
        return;
      }
      const x = plot.valToPos((time - frame.zero) / 1e6, "x", true);
      const y = plot.valToPos(value, `y ${signal.column.unit}`, true);
      if (begins) ctx.moveTo(x, y);
      else ctx.lineTo(x, y);
      begins = false;
    });
    ctx.stroke();
  });
  ctx.restore();
}

/** Returns the picture on the screen as a file, with what it shows; nothing where there is none. */
export async function png(title: string): Promise<Blob | null> {
  if (drawn === null) return null;
  const parts = [drawn.main.ctx.canvas, ...(drawn.lanes === null ? [] : [drawn.lanes.ctx.canvas])];
  const ratio = devicePixelRatio;
  const [head, line] = [28 * ratio, 20 * ratio];
  const signals = scope.chosen();
  const width = Math.max(...parts.map((part) => part.width));
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = head + line + parts.reduce((sum, part) => sum + part.height, 0);
  const pen = canvas.getContext("2d");
  if (pen === null) return null;
  pen.fillStyle = style("--surface");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = style("--text");
  pen.font = `600 ${14 * ratio}px system-ui, sans-serif`;
  pen.fillText(title, 8 * ratio, 19 * ratio);
  let y = head;
  for (const part of parts) {
    pen.drawImage(part, 0, y);
    y += part.height;
  }
  pen.font = `${12 * ratio}px system-ui, sans-serif`;
  let x = 8 * ratio;
  signals.forEach(({ column, bit }, place) => {
    const name = bit === null ? column.name : bitName(column, bit);
    const text = column.unit === "" ? name : `${name} (${column.unit})`;
    pen.strokeStyle = penOf(place).colour;
    pen.lineWidth = 2 * ratio;
    pen.setLineDash(penOf(place).dash.map((one) => one * ratio));
    pen.beginPath();
    pen.moveTo(x, y + 8 * ratio);
    pen.lineTo(x + 20 * ratio, y + 8 * ratio);
    pen.stroke();
    pen.fillText(text, x + 26 * ratio, y + 12 * ratio);
    x += 42 * ratio + pen.measureText(text).width;
  });
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

/** Draws what the worker sends. */
export function Plot({ label }: { label: string }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = host.current;
    if (element === null) return;
    let Uplot: typeof uPlot | null = null;
    let gone = false;
    let theme = 0;
    const sized = new ResizeObserver(() => {
      scope.show(Math.max(100, element.clientWidth - AXIS - UNIT));
      again();
    });
    const again = () => {
      const frame = scope.frame.value;
      if (Uplot === null || gone) return;
      const signals = scope.chosen().map(({ key, column }) => [key, column.unit, column.type]);
      const key = JSON.stringify([signals, element.clientWidth, devicePixelRatio, theme]);
      if (drawn?.key !== key) {
        drawn?.main.destroy();
        drawn?.lanes?.destroy();
        drawn = build(Uplot, element, Math.max(200, element.clientWidth), key);
      }
      if (frame !== null && drawn !== null) paint(drawn, frame);
    };
    const colours = () => {
      theme += 1;
      again();
    };
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", colours);
    forced.addEventListener("change", colours);
    const themed = new MutationObserver(colours);
    themed.observe(document.documentElement, { attributeFilter: ["data-theme"] });
    const end = effect(() => {
      scope.frame.value;
      scope.layout.value;
      again();
    });
    void import("./uplot").then((module) => {
      Uplot = module.default;
      if (!gone) {
        sized.observe(element);
        again();
      }
    });
    return () => {
      gone = true;
      end();
      sized.disconnect();
      themed.disconnect();
      dark.removeEventListener("change", colours);
      forced.removeEventListener("change", colours);
      drawn?.main.destroy();
      drawn?.lanes?.destroy();
      drawn = null;
    };
  }, []);
  return <div class="plots" ref={host} role="img" aria-label={label} />;
}
