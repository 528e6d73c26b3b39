/** The line of the command-line tool that shows what a screen shows. */
import type { Server, Station } from "../api";

/** Returns a word as a shell takes it. */
function quoted(word: string): string {
  return /^[\w./:=@%+,-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

type Where = Pick<Server, "simulation" | "interface" | "source">;
type Of = Pick<Station, "name" | "ip" | "mac">;

/** Returns the line of a command for a drive, or for the network; nothing for drives in the memory of a server. */
export function commandLine(where: Where, verb: string, of: Of | null, more: readonly string[] = []): string | null {
  if (where.simulation) return null;
  const drive = of === null ? [] : [where.source === "addresses" ? (of.ip ?? "") : of.name || of.mac];
  const on = where.interface === null ? [] : ["-i", where.interface];
  return ["profidrive", verb, ...drive, ...more, ...on].map(quoted).join(" ");
}
