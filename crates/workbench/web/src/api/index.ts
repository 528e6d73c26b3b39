import type { components } from "./schema";

type Schemas = components["schemas"];
export type Station = Schemas["KnownStation"];
export type Named = Schemas["Named"];
export type Addressed = Schemas["Addressed"];
export type Stations = Schemas["StationsReport"];
export type Status = Schemas["StatusReport"];
export type Server = Schemas["ServerReport"];
export type Stopped = Schemas["StoppedReport"];
export type StopFrame = Schemas["StopFrame"];
export type StopOffer = Schemas["StopOffer"];
export type Shaft = Schemas["VirtualDrive"];
export type Quantity = Schemas["Quantity"];
export type Fault = Schemas["Fault"];
export type FaultsTopic = Schemas["FaultsTopic"];
export type PlantCheck = Schemas["PlantCheck"];
export type PlantStarted = Schemas["PlantStarted"];
export type Plant = Schemas["VirtualDrives"];
export type Possible = Schemas["Possible"];
export type List = Schemas["ListReport"];
export type Description = Schemas["ParameterDescription"];
export type Value = Schemas["Parameter"];
export type Values = Schemas["ParametersReport"];
export type Job = Schemas["JobReport"];
export type SettingChange = Schemas["SettingChange"];
export type Unsaved = Schemas["Unsaved"];
export type Backups = Schemas["BackupsReport"];
export type Difference = Schemas["Difference"];
export type StateMachine = Schemas["StateMachine"];
export type MachineTopic = Schemas["MachineTopic"];
export type TelegramTopic = Schemas["TelegramTopic"];
export type LinkTopic = Schemas["LinkTopic"];
export type Diff = Schemas["DiffReport"];
export type TelegramLayout = Schemas["TelegramLayout"];
export type Info = Schemas["InfoReport"];
export type FrameNode = Schemas["FrameNode"];
export type LogPage = Schemas["LogPage"];
export type LogTopic = Schemas["LogTopic"];
export type Troubles = Schemas["TroublesReport"];
export type CaptureReport = Schemas["CaptureReport"];
export type Captures = Schemas["CapturesReport"];
export type EventPage = Schemas["EventPage"];
export type FramePage = Schemas["FramePage"];
export type FrameReport = Schemas["FrameReport"];
export type RecordReport = Schemas["RecordReport"];
type Problem = Schemas["Problem"];

/** Time for an answer, in ms. */
const LIMIT = 5000;

/** An answer that says no. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
    /** What kind of problem it is, as the interface calls it. */
    readonly kind = "",
  ) {
    super(message);
  }
}

/** Makes a request of the interface. Throws `Refused` for a problem, another error where there is no answer. */
export async function ask(path: string, options: RequestInit = {}): Promise<Response> {
  const answer = await fetch(`/api/v1/${path}`, { signal: AbortSignal.timeout(LIMIT), ...options });
  if (!answer.ok) {
    const problem = (await answer.json().catch(() => null)) as Problem | null;
    const details = problem?.details ?? [];
    throw new Refused(
      answer.status,
      [problem?.detail ?? answer.statusText, details.join("; ")].filter(Boolean).join(": "),
      problem?.kind,
    );
  }
  return answer;
}

/** The same for an answer in JSON. */
export async function request<T>(path: string, options: RequestInit = {}): Promise<T> {
  return (await (await ask(path, options)).json()) as T;
}

/** Time for something that changes a drive, in ms: the drive may take its time, and the workbench has a limit of its own. */
const CHANGE = 25_000;

/** Posts what is wanted. */
export function post<T>(path: string, body: unknown): Promise<T> {
  const headers = { "Content-Type": "application/json" };
  const signal = AbortSignal.timeout(CHANGE);
  return request<T>(path, { method: "POST", headers, body: JSON.stringify(body), signal });
}
