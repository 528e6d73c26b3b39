import type { Page } from "@playwright/test";

/** Every screen with what it can show: what it is called in pictures, and its path. */
export async function screens(page: Page): Promise<[string, string][]> {
  const answer = await page.request.get("/api/v1/stations");
  const { stations } = (await answer.json()) as { stations: { id: string; name: string | null }[] };
  const named = (name: string) => {
    const id = stations.find((one) => one.name === name)?.id;
    if (id === undefined) throw new Error(`no station is called ${name}`);
    return encodeURIComponent(id);
  };
  return [
    ["network", "/network"],
    ["overview", `/drives/${named("fan-1")}/overview`],
    ["overview-fault", `/drives/${named("axis-2")}/overview`],
    ["overview-watch", `/drives/${named("press-1")}/overview`],
    ["overview-none", "/drives/none/overview"],
    ["faults", `/drives/${named("axis-2")}/faults`],
    ["faults-none", "/drives/none/faults"],
    ["control", `/drives/${named("axis-1")}/control`],
    ["control-none", "/drives/none/control"],
    ["scope", `/drives/${named("press-1")}/scope`],
    ["parameters", `/drives/${named("axis-1")}/parameters`],
    ["parameters-none", "/drives/none/parameters"],
    ["compare", `/drives/${named("axis-1")}/compare`],
    ["virtual", "/virtual"],
    ["machine", `/drives/${named("press-1")}/machine`],
    ["telegram", `/drives/${named("press-1")}/telegram`],
    ["capture", "/capture"],
    ["log", "/log"],
  ];
}
