/** Signs with a shape of their own, so that colour is never the only difference. */
const PATHS = {
  cross: "M4 4l8 8M12 4l-8 8",
  triangle: "M8 3l6 10H2zM8 7v3M8 12v.5",
  square: "M3 3h10v10H3z",
  tick: "M3 8.5l3.5 3.5L13 4.5",
  dash: "M3 8h10",
  network: "M8 2v4M4 10V8h8v2M4 10v4M12 10v4M6 2h4v4H6zM2 10h4v4H2zM10 10h4v4h-4z",
  overview: "M2 2h5v12H2zM10 2h4v5h-4zM10 10h4v4h-4z",
  virtual: "M8 3a5 5 0 1 0 0 10A5 5 0 1 0 8 3zM8 8V3",
  parameters: "M2 4h12M2 8h12M2 12h12M5 2.5v3M11 6.5v3M7 10.5v3",
  scope: "M2 13V3M2 13h12M4 10l3-5 3 3 3-5",
  compare: "M2 2h5v12H2zM9 2h5v12H9zM4 6h1M11 6h1M11 10h1",
  machine: "M2 6h4v4H2zM10 2h4v4h-4zM10 10h4v4h-4zM6 7l4-3M6 9l4 3",
  telegram: "M2 4h12v8H2zM5 4v8M8 4v8M11 4v8",
  capture: "M2 3h8M2 6h6M2 9h4M11 8a3 3 0 1 0 0 5A3 3 0 1 0 11 8zM13 13l2 2",
  log: "M3 2h10v12H3zM5.5 5h5M5.5 8h5M5.5 11h3",
  star: "M8 2l1.8 3.9 4.2.5-3.1 2.9.8 4.2L8 11.4l-3.7 2.1.8-4.2L2 6.4l4.2-.5z",
  live: "M3 3l5 5-5 5M8 3l5 5-5 5",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name, tone }: { name: IconName; tone?: string }) {
  return (
    <svg class={`icon ${tone ?? ""}`} viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
