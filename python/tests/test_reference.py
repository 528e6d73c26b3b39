"""Expectations against a reference of their own: what the samples of a trace say, without a monitor that sees them one by one."""

from __future__ import annotations

from typing import Any, NamedTuple

from hypothesis import given, settings
from hypothesis import strategies as st

from profidrive import Plant, Trace

from .conftest import PRESS

TRACE: Trace = Plant.from_file(PRESS).run("22s")
MS = 1_000_000
"""Of a time in ns. No time of an expectation is that of a sample: all end with 137, or with 271 where they last."""


class Stretch(NamedTuple):
    """A time in which something holds, up to the next sample."""

    begin: int
    end: int


def stretches(drive: str, conditions: dict[str, Any]) -> list[Stretch]:
    """Where all conditions hold, joined; the end of the run is the end of the last one."""
    times, samples = SAMPLES[drive]
    found: list[Stretch] = []
    for time, end, sample in zip(times, [*times[1:], END], samples, strict=True):
        if all(HOLDS[key](sample[key], value) for key, value in conditions.items()):
            begin = found.pop().begin if found and found[-1].end == time else time
            found.append(Stretch(begin, end))
    return found


def outcome(rule: str, times: tuple[int, int, int], holding: list[Stretch]) -> str:
    """What comes of an expectation whose window begins and ends, and that is to hold for a time."""
    begin, end, lasts = times
    if begin > END:
        return "not_ended" if rule == "at" else "never_started"
    inside = [one for one in holding if one.begin <= min(end, END) and (one.end > begin or one.end == END)]
    if rule == "never":
        return "not_met" if inside else "met" if end <= END else "not_ended"
    if rule in ("at", "always"):
        end = begin + lasts if rule == "at" else end
        covers = any(one.begin <= begin and (one.end > end or one.end == END) for one in inside)
        return "not_met" if not covers else "met" if end <= END else "not_ended"
    for one in inside:
        since = max(one.begin, begin)
        if since + lasts < one.end or since + lasts <= END == one.end:
            return "met"
        if one.end == END:
            return "not_ended"
    return "not_met" if end <= END else "not_ended"


HOLDS: dict[str, Any] = {
    "state": lambda seen, states: seen in states,
    "zsw1": lambda seen, bits: seen & bits[1] == bits[0],
    "speed": lambda seen, span: span[0] <= seen <= span[1],
    "current": lambda seen, most: seen <= most,
}


def samples_of(drive: str) -> tuple[list[int], list[dict[str, Any]]]:
    """The times of the samples of a drive, and what it was like at each."""
    samples = TRACE.of(drive).samples
    columns = {key: samples[key].tolist() for key in HOLDS}
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    return samples["t"].astype("int64").tolist(), rows


SAMPLES = {drive: samples_of(drive) for drive in TRACE.drives}
END = 22_000 * MS

CONDITIONS = st.fixed_dictionaries(
    {},
    optional={
        "state": st.lists(st.sampled_from([1, 2, 3, 4, 5]), min_size=1, max_size=3, unique=True),
        "zsw1": st.sampled_from([(0x0004, 0x0004), (0, 0x0004), (0x0008, 0x0008), (0x0200, 0x0208), (0x0080, 0x0080)]),
        "speed": st.lists(st.sampled_from([-200, -1, 0, 1, 60, 119, 121, 130]), min_size=2, max_size=2).map(sorted),
        "current": st.sampled_from([0.0, 0.5, 1.0, 2.0]),
    },
).filter(bool)
WRITTEN: dict[str, Any] = {
    "state": lambda states: "|".join(f"S{state}" for state in states),
    "zsw1": lambda bits: f"0x{bits[0]:04X}/0x{bits[1]:04X}",
    "speed": lambda span: f"{span[0]}rpm..{span[1]}rpm",
    "current": lambda most: f"<={most}A",
}
TIMES = st.integers(0, 24_000).map(lambda time: time * MS + 137)
SPANS = st.integers(0, 3_000).map(lambda time: time * MS + 271)


def seconds(time: int) -> str:
    return f"{time / 1e9:.9f}s"


@given(st.data())
@settings(max_examples=100)
def test_expectations_are_what_their_reference_says(data: st.DataObject) -> None:
    drive = data.draw(st.sampled_from(TRACE.drives))
    conditions = data.draw(CONDITIONS)
    begin, span, lasts = data.draw(TIMES), data.draw(SPANS), data.draw(st.just(0) | SPANS)
    rule = data.draw(st.sampled_from(["at", "always", "never", "within"]))
    written: dict[str, object] = {key: WRITTEN[key](value) for key, value in conditions.items()}
    window = begin, begin + span, lasts
    if rule == "at":
        written |= {"at": seconds(begin)} | ({"for": seconds(lasts)} if lasts else {})
    elif rule == "within":
        after: object = seconds(begin)
        if data.draw(st.booleans()):
            other, starts = data.draw(st.sampled_from(TRACE.drives)), data.draw(CONDITIONS)
            starting = stretches(other, starts)
            after = {"drive": other, **{key: WRITTEN[key](value) for key, value in starts.items()}}
            begin = starting[0].begin if starting else END + 1
            window = begin, begin + span, lasts
        written |= {"within": seconds(span), "after": after} | ({"for": seconds(lasts)} if lasts else {})
    else:
        if data.draw(st.booleans()):
            written[rule], window = f"{seconds(begin)}..{seconds(begin + span)}", (begin, begin + span, 0)
        else:
            written[rule], window = f"{seconds(begin)}..", (begin, END, 0)
    [result] = TRACE.of(drive).check({"drive": drive, **written})
    assert result.outcome.value == outcome(rule, window, stretches(drive, conditions)), written
