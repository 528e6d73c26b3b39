/** Work of the workbench that takes longer than a request. */
import { type Job, request } from "../api";

/** Time between two looks at a job, in ms. */
const LOOK = 300;

/** Waits for the end of a job and shows how far it is. Throws for one that failed. */
export async function follow(begun: Job, show: (job: Job) => void): Promise<Job> {
  let job = begun;
  while (job.phase === "working") {
    show(job);
    await new Promise((resolve) => setTimeout(resolve, LOOK));
    job = await request<Job>(`jobs/${job.id}`);
  }
  if (job.phase === "failed") {
    throw new Error([job.problem?.message ?? "", ...(job.problem?.details ?? [])].join(": "));
  }
  return job;
}

/** Returns why something did not work, in words. */
export function reason(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
