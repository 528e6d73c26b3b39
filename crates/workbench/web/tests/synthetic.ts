/** Parameters that no drive of the demo has: the answers of the server are changed on their way to the page. */
import type { Page } from "@playwright/test";
import type { Value, Values } from "../src/api";

/** How many parameters a page has to manage. */
export const MANY = 5000;
/** The number of the first of them; numbers below are those of drives. */
const FIRST = 20_000;

const one = { format: 0x43, writable: true, index: null, unit: "", word: null, beyond: null, error: null };

/** A connection that was kept may be closed by the server at that moment. */
const KEPT = { maxRetries: 2 };

/** Returns a number as letters from a to j, which no name and no number of these parameters has. */
export function letters(digits: string): string {
  return digits.replace(/\d/g, (digit) => "abcdefghij"[Number(digit)] ?? "");
}

/** Returns the name, the number and the value of one of them. */
function named(place: number): { number: string; name: string; text: string } {
  return { number: `p${FIRST + place}`, name: `SYN.${String(place).padStart(4, "0")}`, text: String(place * 3) };
}

/** Lets each drive have 5,000 parameters, `SYN.0001` and following, each with a value. */
export async function synthetic(page: Page): Promise<void> {
  await page.route("**/api/v1/drives/*/parameters", async (route) => {
    const answer = await route.fetch(KEPT);
    const list = (await answer.json()) as { parameters: { number: string }[] };
    const [like] = list.parameters;
    const parameters = Array.from({ length: MANY }, (_, at) => {
      const { number, name } = named(at + 1);
      const description = letters(name.slice(-4));
      const pnu = FIRST + at + 1;
      const more = { elements: 1, index: null, choices: [], bits: [], common_names: [], high: null, unit: "" };
      return { ...like, ...more, pnu, number, name, access: "read_write", description };
    });
    await route.fulfill({ response: answer, json: { ...list, parameters } });
  });
  await page.route("**/api/v1/drives/*/values/*", async (route) => {
    const wanted = decodeURIComponent(new URL(route.request().url()).pathname.split("/").at(-1) ?? "").split(",");
    if (!wanted.every((number) => number.startsWith("p2"))) return route.continue();
    const parameters = wanted.map((number) => {
      const place = Number(number.slice(1)) - FIRST;
      const { name, text } = named(place);
      return {
        ...one,
        pnu: FIRST + place,
        number,
        name,
        text,
        value: place * 3,
        raw: place * 3,
        meaning: null,
        hex: "00",
      };
    });
    return route.fulfill({ json: { parameters } });
  });
}

/** Lets each drive have parameters beside its own of which it reports the numbers alone, as drives without tables do. */
export async function unknown(page: Page, octets: ReadonlyMap<number, Partial<Value>>): Promise<void> {
  await page.route("**/api/v1/drives/*/parameters", async (route) => {
    const answer = await route.fetch(KEPT);
    const list = (await answer.json()) as { numbers: number[] };
    await route.fulfill({ response: answer, json: { ...list, numbers: [...octets.keys()] } });
  });
  await page.route("**/api/v1/drives/*/values/*", async (route) => {
    const url = new URL(route.request().url());
    const path = url.pathname.split("/");
    const wanted = decodeURIComponent(path.pop() ?? "").split(",");
    const own = wanted.filter((number) => !octets.has(Number(number)));
    let parameters: Value[] = [];
    let report: Partial<Values> = {};
    if (own.length > 0) {
      url.pathname = `${path.join("/")}/${encodeURIComponent(own.join(","))}`;
      report = (await (await route.fetch({ ...KEPT, url: url.href })).json()) as Values;
      parameters = report.parameters ?? [];
    }
    const all = wanted.map((number) => {
      const found = octets.get(Number(number));
      if (found === undefined) return parameters.shift();
      return { ...one, pnu: Number(number), number, name: null, meaning: null, writable: null, ...found };
    });
    await route.fulfill({ json: { ...report, parameters: all } });
  });
}
