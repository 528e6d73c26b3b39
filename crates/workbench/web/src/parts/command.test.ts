import { expect, test } from "vitest";
import { commandLine } from "./command";

test("a command names the drive as this server reaches it, and quotes what a shell would read otherwise", () => {
  const eth = { simulation: false, interface: "eth0", source: "interface" };
  const axis = { name: "axis-1", ip: "10.0.0.2", mac: "02:00:00:00:00:01" };
  expect(commandLine(eth, "status", axis)).toBe("profidrive status axis-1 -i eth0");
  expect(commandLine(eth, "read", axis, ["r947[0]"])).toBe("profidrive read axis-1 'r947[0]' -i eth0");
  expect(commandLine(eth, "status", { ...axis, name: null })).toBe("profidrive status 02:00:00:00:00:01 -i eth0");
  expect(commandLine(eth, "status", { ...axis, name: "a'; rm" })).toBe("profidrive status 'a'\\''; rm' -i eth0");
  expect(commandLine(eth, "scan", null)).toBe("profidrive scan -i eth0");
  const addresses = { simulation: false, interface: null, source: "addresses" };
  expect(commandLine(addresses, "faults", axis, ["--history"])).toBe("profidrive faults 10.0.0.2 --history");
  expect(commandLine({ ...eth, simulation: true }, "status", axis)).toBe(null);
});
