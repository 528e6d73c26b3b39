import type { components } from "./schema";

type Schemas = components["schemas"];
export type Station = Schemas["KnownStation"];
export type Stations = Schemas["StationsReport"];
export type Status = Schemas["StatusReport"];
export type Server = Schemas["ServerReport"];
export type Stopped = Schemas["StoppedReport"];
export type Shaft = Schemas["VirtualDrive"];
export type Quantity = Schemas["Quantity"];
type Problem = Schemas["Problem"];

/** Time for an answer, in ms. */
const LIMIT = 5000;

/** An answer that says no. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

/** Makes a request of the interface. Throws `Refused` for a problem, another error where there is no answer. */
export async function request<T>(path: string, options: RequestInit = {}): Promise<T> {
  const answer = await fetch(`/api/v1/${path}`, { signal: AbortSignal.timeout(LIMIT), ...options });
  if (!answer.ok) {
    const problem = (await answer.json().catch(() => null)) as Problem | null;
    throw new Refused(answer.status, problem?.detail ?? answer.statusText);
  }
  return (await answer.json()) as T;
}
