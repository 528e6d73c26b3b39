import type { Fault } from "../../api";

interface Line {
  key: string;
  situation: string;
  fault: Fault;
  count: number;
}

/** Returns the faults of before; one that came again and again is one line with a count. */
export function history(faults: readonly Fault[]): Line[] {
  const lines: Line[] = [];
  for (const fault of faults.filter(({ acknowledged }) => acknowledged)) {
    const last = lines.at(-1);
    if (last && last.fault.number === fault.number && last.fault.situation !== fault.situation) {
      last.count += 1;
      continue;
    }
    const situation = String(fault.situation);
    lines.push({ key: `${situation} ${fault.position}`, situation, fault, count: 1 });
  }
  return lines;
}
