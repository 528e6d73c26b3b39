"""A press whose cable is pulled at any moment, on a lossy network, with many seeds; `tools/python-bench campaign` runs it.

Each run lasts 30 s of the plant. What fails is run again here, which must give the same digest, made small and saved as a plant
file.
The same command goes on where it ended. It exits with 5 where an expectation failed, with 1 where a failure is not the same again.
"""

from __future__ import annotations

import argparse
import collections
import sys
import time
from pathlib import Path

from profidrive import Plant, choice, sweep, uniform
from profidrive.campaign import Failure, Progress

PLANT = """
duration = "30s"
expect = [
    { drive = "press-1", within = "700ms", after = "1.5s", speed = "120rpm", tolerance = "1rpm", for = "200ms", name = "starts" },
    { drive = "press-1", within = "60ms", after = { drive = "press-1", connected = false }, fault = 702, name = "trips" },
    { drive = "press-1", within = "1s", after = { drive = "press-1", connected = false }, moving = false, name = "stops" },
    { name = "no overspeed", always = true, drive = "*", speed = "-350rpm..350rpm" },
    { name = "never faster than commanded", always = true, drive = "press-1", speed = "-130rpm..130rpm" },
    { name = "the feeder goes on", never = "..28s", drive = "feeder-1", fault = "any" },
]

[[drive]]
name = "press-1"
ip = "192.168.0.11/24"
load = { inertia = 1e-3, friction = 0.1 }
parameters = { "DRV.ACC" = "5000rpm/s", "DRV.DEC" = "5000rpm/s" }
event = [
    { at = "6s", do = "load=0.2Nm", for = "2s" },
    { at = "12s", do = "cable=pulled", for = "400ms" },
    { at = "2.3s", do = "loss=0%" },
]

[[drive]]
name = "feeder-1"
ip = "192.168.0.12/24"
event = [{ at = "3s", do = "loss=2%" }, { at = "3s", do = "jitter=2ms" }]

[[controller]]
drive = "press-1"
telegram = 1
step = [
    { at = "1s", send = { STW1 = "0x047E" } },
    { at = "1.5s", send = { STW1 = "0x047F", NSOLL_A = "120rpm" } },
    { at = "28s", send = { STW1 = "0x047E" } },
    { at = "29s", connection = "release" },
]

[[controller]]
drive = "feeder-1"
telegram = 350
watchdog = 6
step = [
    { at = "1s", send = { STW1 = "0x047E" } },
    { at = "1.5s", send = { STW1 = "0x047F", NSOLL_A = "300rpm" } },
    { at = "28s", send = { STW1 = "0x047E" } },
]
"""

# the friction holds the load where the motor does not, and frames are lost from after the start on
VARY = {
    "drive.press-1.event.1.at": uniform("3s", "27s"),
    "drive.press-1.event.2.at": uniform("2.5s", "27s"),
    "drive.press-1.event.2.for": uniform("0.1s", "3s"),
    "drive.press-1.event.3.do": choice("loss=0%", "loss=0.5%", "loss=1%"),
    "drive.press-1.load.inertia": uniform(0.0005, 0.005),
    "drive.press-1.load.friction": uniform(0.25, 0.5),
    "drive.feeder-1.event.1.do": choice("loss=1%", "loss=2%", "loss=5%"),
    "drive.feeder-1.event.2.do": choice("jitter=0ms", "jitter=1ms", "jitter=2ms"),
}


def look_at(failures: list[Failure], folder: Path) -> int:
    """Runs failures again and makes them small; returns how many are not the same again."""
    different = 0
    for failure in failures:
        name = failure.results[0].name
        file = folder / f"seed-{failure.seed}.toml"
        try:
            trace = failure.trace()
            assert trace.digest == failure.digest
            small = failure.shrink(budget="60s")
            small.save(file)
            print(f"seed {failure.seed}: {name}: {small.reason} ({small.runs} runs, {file})", flush=True)
        except Exception as error:
            different += 1
            print(f"seed {failure.seed}: {name}: NOT THE SAME AGAIN: {type(error).__name__}: {error}", flush=True)
    return different


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000, help="number of seeds (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="the first one (default: %(default)s)")
    parser.add_argument(
        "--out", type=Path, default=Path("target/python-campaign"), help="folder for what is done (default: %(default)s)"
    )
    parser.add_argument("--shrink", type=int, default=20, help="failures of each expectation to make small (default: %(default)s)")
    wanted = parser.parse_args()
    begin = shown = time.monotonic()

    def progress(done: Progress) -> None:
        nonlocal shown
        if time.monotonic() - shown >= 10 or done.done == done.total:
            shown = time.monotonic()
            print(f"{done.done} of {done.total}, {done.failures} failed, {shown - begin:.0f} s", flush=True)

    seeds = range(wanted.first, wanted.first + wanted.count)
    result = sweep(Plant.from_toml(PLANT), seeds=seeds, vary=VARY, out=wanted.out, progress=progress)
    took = time.monotonic() - begin
    each = sum(row.wall for row in result) / max(len(result), 1)
    print(f"{len(result)} runs in {took:.0f} s, {1000 * each:.1f} ms each, {len({row.digest for row in result})} different ones")
    by_name: dict[str, list[Failure]] = collections.defaultdict(list)
    for failure in result.failures:
        for lost in failure.results:
            by_name[f"{lost.name}: {lost.outcome.value}"].append(failure)
    for name, failures in sorted(by_name.items()):
        print(f"{name}: {len(failures)} failed, first seeds {[failure.seed for failure in failures[:5]]}")
    chosen = {failure.seed: failure for failures in by_name.values() for failure in failures[: wanted.shrink]}
    different = look_at(list(chosen.values()), wanted.out)
    return 1 if different else 5 if by_name else 0


if __name__ == "__main__":
    sys.exit(main())
