/** The fields of a frame in the order of their octets. */
import type { FrameNode } from "../../api";

export interface Leaf {
  /** The names from the frame down to the field. */
  path: string[];
  node: FrameNode;
}

/** Returns the fields without fields of their own. */
export function leaves(node: FrameNode, path: string[] = []): Leaf[] {
  const here = [...path, node.name];
  const children = node.children ?? [];
  return children.length === 0 ? [{ path: here, node }] : children.flatMap((child) => leaves(child, here));
}

/** Returns octets in hexadecimal, as they come with blanks between them. */
export function octets(hex: string): string[] {
  return hex === "" ? [] : hex.split(" ");
}

/** The words by which the cyclic data of a drive begin. */
const WORDS = ["STW1", "ZSW1", "CTW", "STW", "PKW"];

/** Returns the octets of the telegram of a drive in a frame; `null` where none is known. */
export function telegramOctets(tree: FrameNode, hex: string): string | null {
  const children = tree.children ?? [];
  if (children.some((child) => WORDS.includes(child.name))) {
    return octets(hex).slice(tree.start, tree.end).join("");
  }
  for (const child of children) {
    const found = telegramOctets(child, hex);
    if (found !== null) return found;
  }
  return null;
}

/** Returns octets as bits, where they are a word. */
export function bits(all: string[]): string {
  if (all.length > 2) return "";
  const digits = all.join("").split("");
  return digits.map((digit) => Number.parseInt(digit, 16).toString(2).padStart(4, "0")).join(" ");
}

/** Reads a whole number, decimal or `0x` hexadecimal, up to a bound; nothing where it is none. */
export function wholeNumber(text: string, most: number): number | null {
  const plain = text.trim();
  if (!/^(\d+|0x[0-9a-f]+)$/i.test(plain)) return null;
  const number = Number(plain);
  return number <= most ? number : null;
}
