import { expect, test } from "vitest";
import type { FrameNode } from "../../api";
import { bits, leaves, telegramOctets, wholeNumber } from "./nodes";

function node(name: string, start: number, end: number, children: FrameNode[] = []): FrameNode {
  return { name, value: "", start, end, weight: "normal", children };
}

const frame = node("frame", 0, 8, [
  node("Ethernet", 0, 2),
  node("data", 2, 7, [node("slot 1/1", 2, 7, [node("data", 2, 6, [node("STW1", 2, 4), node("NSOLL_A", 4, 6)])])]),
]);

test("the fields of a frame come in the order of their octets", () => {
  expect(leaves(frame).map(({ node, path }) => `${path.length} ${node.name}`)).toEqual([
    "2 Ethernet",
    "5 STW1",
    "5 NSOLL_A",
  ]);
});

test("the octets of the telegram are those of the data with the control word", () => {
  expect(telegramOctets(frame, "00 01 04 7F 20 00 80 00")).toBe("047F2000");
  expect(telegramOctets(node("frame", 0, 2), "00 01")).toBe(null);
});

test("words are shown as bits, longer fields are not", () => {
  expect(bits(["04", "7F"])).toBe("0000 0100 0111 1111");
  expect(bits(["00", "00", "00", "00"])).toBe("");
});

test("numbers of records are decimal or hexadecimal", () => {
  const of = (text: string) => wholeNumber(text, 0xffff);
  expect([of("1"), of(" 0xAFF0 "), of("65535")]).toEqual([1, 0xaff0, 65535]);
  expect([of(""), of("65536"), of("-1"), of("1.5"), of("AFF0"), of("0x")]).toEqual(Array(6).fill(null));
});
