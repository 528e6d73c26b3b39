/** What is edited of a drive: values that were typed, the plan of them, and what became of it. */
import { signal } from "@preact/signals";
import {
  type Description,
  type Diff,
  type Job,
  type List,
  post,
  request,
  type SettingChange,
  type Unsaved,
  type Value,
  type Values,
} from "../../api";
import { follow, reason } from "../../store/jobs";
import { whenRestarted } from "../../store/store";

/** One row: a parameter, or one element of it. */
export interface Line {
  /** How it is named in requests: `p2108`, `p0915[3]`. */
  key: string;
  /** Its element; nothing where it has only one. */
  element: number | null;
  of: Description;
  /** What a search looks through. */
  words: string;
}

/** A value, and when it came by the clock of this page, in ms. */
export interface Read {
  value: Value;
  received: number;
}

/** Elements of an array that have rows of their own. */
const ELEMENTS = 64;
/** Values in one request. */
const PART = 100;
/** Time without typing after which a plan is made, in ms. */
const PAUSE = 300;

/** The drive of all this. */
export const drive = signal("");
export const lines = signal<readonly Line[] | null>(null);
export const failure = signal("");
export const values = signal<ReadonlyMap<string, Read>>(new Map());
/** What was typed, by row. */
export const edits = signal<ReadonlyMap<string, string>>(new Map());
/** Whether the drive is to save the new values. */
export const save = signal(false);
/** The plan of what is typed now; nothing while it is made. */
export const plan = signal<Job | null>(null);
/** What was written last, until the next edit. */
export const applied = signal<Job | null>(null);
/** Why the last request failed. */
export const refused = signal("");
export const busy = signal(false);
/** The rows that were written by this server and that the drive has not saved. */
export const unsaved = signal<ReadonlySet<string>>(new Set());

/** Reads them. */
export async function readUnsaved(): Promise<void> {
  const id = drive.value;
  const { parameters } = await request<Unsaved>(`drives/${encodeURIComponent(id)}/unsaved`);
  const before = unsaved.value;
  if (drive.value !== id || (parameters.length === before.size && parameters.every((key) => before.has(key)))) return;
  unsaved.value = new Set(parameters);
}

/** The rows of a change that was written, as requests name them. */
function keyOf({ index, new: { number } }: SettingChange): string {
  return index === null || number.includes("[") ? number : `${number}[${index}]`;
}

/** Puts the parameters first that are called exactly like this: others have the name as a common one, or in their text. */
export function exactFirst(all: readonly Line[], text: string): Line[] {
  const name = text.trim().toLowerCase();
  if (name === "") return [...all];
  const [exact, others]: [Line[], Line[]] = [[], []];
  for (const line of all) {
    const { key, of } = line;
    const is = [key, of.number, of.name].some((one) => one.length === name.length && one.toLowerCase() === name);
    (is ? exact : others).push(line);
  }
  return [...exact, ...others];
}

function linesOf(list: List): Line[] {
  const known = list.parameters.flatMap((of): Line[] => {
    const words = [
      of.number,
      of.name,
      of.description,
      of.unit,
      ...of.common_names,
      ...of.choices.map((one) => one.text),
    ]
      .join(" ")
      .toLowerCase();
    if (of.elements <= 1 || of.index !== null) return [{ key: of.number, element: null, of, words }];
    const count = Math.min(of.elements, ELEMENTS);
    return Array.from({ length: count }, (_, element) => ({ key: `${of.number}[${element}]`, element, of, words }));
  });
  const numbers = list.numbers.map((pnu): Line => {
    const of: Description = {
      pnu,
      index: null,
      number: `${pnu}`,
      name: "",
      common_names: [],
      description: "",
      unit: "",
      access: "read",
      elements: 1,
      octets: 0,
      signed: false,
      high: null,
      saved: false,
      minimum: null,
      maximum: null,
      default: null,
      choices: [],
      bits: [],
      source: "",
    };
    return { key: of.number, element: null, of, words: of.number };
  });
  return [...known, ...numbers];
}

/** What was typed for drives that are not shown now. */
const kept = new Map<string, ReadonlyMap<string, string>>();

/** Whether anything was typed and not written, for whichever drive. */
export function waits(): boolean {
  return edits.value.size > 0 || [...kept.values()].some((one) => one.size > 0);
}

/** Begins with a drive. What was typed for another one waits until that is shown again. */
export async function open(id: string): Promise<void> {
  if (drive.value === id && lines.value !== null) return;
  kept.set(drive.value, edits.value);
  drive.value = id;
  lines.value = null;
  values.value = new Map();
  unsaved.value = new Set();
  changed.value = null;
  failure.value = "";
  edits.value = kept.get(id) ?? new Map();
  kept.delete(id);
  planLater();
  applied.value = null;
  try {
    const list = await request<List>(`drives/${encodeURIComponent(id)}/parameters`);
    if (drive.value === id) lines.value = linesOf(list);
  } catch (error) {
    if (drive.value === id) failure.value = reason(error);
  }
}

/** Forgets the drive that was open. */
function forget(): void {
  drive.value = "";
  lines.value = null;
  values.value = new Map();
  unsaved.value = new Set();
  changed.value = null;
  kept.clear();
  discard();
  applied.value = null;
}
whenRestarted(forget);

/** Types a value into the row of a parameter, as `NAME=VALUE`. It is a plan then, which is reviewed as any other one. */
export function set(text: string): void {
  const [name = "", value = ""] = text.split("=");
  const row = lines.value?.find(({ of, element }) => {
    return (element ?? 0) === 0 && [of.number, of.name, ...of.common_names].includes(name);
  });
  if (row !== undefined && value !== "") edit(row.key, value);
}

/** The number with which a drive says that it does not have a parameter. */
const ABSENT = 0;

/** Returns whether the drive has said that it does not have this: it is not asked again and again. */
export function isAbsent(key: string): boolean {
  return values.value.get(key)?.value.error?.number === ABSENT;
}

/** The settings that differ from those as delivered, by number and element; nothing before they were read. */
export const changed = signal<ReadonlySet<string> | null>(null);
/** Time for reading all of them, in ms. */
const SETTINGS = 25_000;

function placeOf(pnu: number | null, index: number | null): string {
  return `${pnu}[${index ?? ""}]`;
}

/** Returns whether a row differs from its value as delivered. */
export function isChanged({ of, element }: Line): boolean {
  const index = of.index === null ? element : of.index + (element ?? 0);
  return changed.value?.has(placeOf(of.pnu, index)) ?? false;
}

/** Reads which settings differ from those as delivered. */
export async function readChanged(): Promise<void> {
  const id = drive.value;
  const path = `drives/${encodeURIComponent(id)}/changed`;
  try {
    const { differences } = await request<Diff>(path, { signal: AbortSignal.timeout(SETTINGS) });
    if (drive.value === id) changed.value = new Set(differences.map(({ pnu, index }) => placeOf(pnu, index)));
  } catch (error) {
    if (drive.value === id) failure.value = reason(error);
  }
}

/** Reads these rows. */
export async function read(keys: readonly string[]): Promise<void> {
  const id = drive.value;
  for (let from = 0; from < keys.length; from += PART) {
    const part = keys.slice(from, from + PART);
    const path = `drives/${encodeURIComponent(id)}/values/${encodeURIComponent(part.join(","))}`;
    const report = await request<Values>(path);
    if (drive.value !== id) return;
    const next = new Map(values.value);
    const received = performance.now();
    part.forEach((key, place) => {
      const value = report.parameters[place];
      // a row for each request: with another number of answers they are of other rows
      if (value !== undefined && report.parameters.length === part.length) next.set(key, { value, received });
    });
    values.value = next;
  }
}

let timer = 0;
/** Counts what was typed: the plan of before is no plan of now. */
let revision = 0;

/** Whether the focus goes to "Apply" once the plan is there, as Enter in a value says. */
export const leads = signal(false);

/** Notes what was typed; nothing takes it back. */
export function edit(key: string, text: string | null): void {
  leads.value = false;
  const next = new Map(edits.value);
  if (text === null) next.delete(key);
  else next.set(key, text);
  edits.value = next;
  applied.value = null;
  planLater();
}

export function choose(saved: boolean): void {
  save.value = saved;
  planLater();
}

export function discard(): void {
  edits.value = new Map();
  planLater();
}

function planLater(): void {
  revision += 1;
  plan.value = null;
  refused.value = "";
  clearTimeout(timer);
  if (edits.value.size > 0) timer = window.setTimeout(() => void makePlan(), PAUSE);
}

function changes(): { parameter: string; value: string }[] {
  return [...edits.value].map(([parameter, value]) => ({ parameter, value }));
}

async function makePlan(): Promise<void> {
  const of = revision;
  const path = `drives/${encodeURIComponent(drive.value)}/plans`;
  try {
    const begun = await post<Job>(path, { changes: changes(), save: save.value });
    const job = await follow(begun, () => {});
    if (of === revision) plan.value = job;
  } catch (error) {
    if (of === revision) refused.value = reason(error);
  }
}

/** Writes what is planned. */
export async function apply(): Promise<void> {
  const planned = plan.value;
  if (planned === null || busy.value) return;
  busy.value = true;
  try {
    applied.value = await follow(await post<Job>(`plans/${planned.id}/apply`, {}), () => {});
    discard();
  } catch (error) {
    // the drive has changed: the plan is made again, and its old values are those of now
    planLater();
    refused.value = reason(error);
  }
  busy.value = false;
  void readUnsaved().catch(() => {});
  void read([...values.value.keys()].slice(0, PART)).catch(() => {});
}

/** Writes the values of before again. */
export async function undo(): Promise<void> {
  const done = applied.value;
  if (done === null || busy.value) return;
  busy.value = true;
  try {
    applied.value = await follow(await post<Job>(`plans/${done.id}/undo`, {}), () => {});
    refused.value = "";
  } catch (error) {
    refused.value = reason(error);
  }
  busy.value = false;
}

/** Plans the values that were written once more, so that the drive saves them. */
export function keep(): void {
  const done = applied.value?.plan?.changes ?? [];
  edits.value = new Map(
    done.map((change) => {
      const text = change.new.text ?? "";
      return [keyOf(change), change.new.unit === "" ? text : `${text} ${change.new.unit}`];
    }),
  );
  save.value = true;
  planLater();
}
