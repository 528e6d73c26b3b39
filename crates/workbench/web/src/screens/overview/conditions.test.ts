import { expect, test, vi } from "vitest";
import type { Status } from "../../api";

// the texts look at the address of the page for their language
vi.stubGlobal("location", { search: "" });
const { conditions } = await import("./conditions");

const word = (number: number, bits: string[]) => ({ number, hex: "0x0003", bits, meaning: null });

/** A status of which nothing else is known. */
function status(known: Partial<Status>): Status {
  const none = {
    torque_allowed: null,
    disable_sources: null,
    motion_disable_sources: null,
    negative_switch: null,
    positive_switch: null,
    homed: null,
    controller: null,
    command_source: null,
    operating_mode: null,
    telegram: null,
  };
  return { faults: [], ...none, ...known } as unknown as Status;
}

test("what keeps the power stage off is named, and what a drive does not report is left out", () => {
  expect(conditions(status({}), null).map(({ name }) => name)).toEqual(["Faults"]);
  const [, off, blocked] = conditions(
    status({ disable_sources: word(3, ["Software disable", "Fault present"]), motion_disable_sources: word(0, []) }),
    null,
  );
  expect(off).toEqual({ name: "Power stage", met: false, value: "kept off by Software disable, Fault present" });
  expect(blocked).toEqual({ name: "Motion", met: true, value: "not blocked" });
  // a cause without a name is one all the same
  expect(conditions(status({ disable_sources: word(3, []) }), null)[1]?.value).toBe("kept off by 0x0003");
});
