"""What foreign values do: an error of usage or a result, never anything else."""

from __future__ import annotations

import json

from hypothesis import given, settings
from hypothesis import strategies as st

from profidrive import Plant, Trace, decode
from profidrive._values import document, expectation_text, value_text
from profidrive.errors import LocalError, ProfidriveError, UsageError

from .test_capture import FULL, pcap

# the same cases in each run, so that a test fails for a change and not by chance
settings.register_profile("same", derandomize=True, deadline=None, max_examples=200)
settings.load_profile("same")

WORDS = st.sampled_from(
    [
        "at",
        "within",
        "after",
        "always",
        "never",
        "drive",
        "for",
        "state",
        "fault",
        "speed",
        "tolerance",
        "zsw1",
        "parameter",
        "load",
    ]
)
TEXTS = st.text(max_size=20) | st.sampled_from(
    ["1s", "2s..3s", "S4", "S1|S2", "akd-1", "*", "120rpm", "<=1rpm", "1%", "any", "none"]
)
VALUES = st.recursive(
    TEXTS | st.booleans() | st.integers() | st.floats() | st.none(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS | TEXTS, inner, max_size=3),
    max_leaves=6,
)
TRACE: Trace = Plant.of("akd").run("100ms")


@given(st.dictionaries(WORDS, VALUES, max_size=5))
def test_any_mapping_is_an_expectation_or_an_error_of_usage(expectation: dict[str, object]) -> None:
    try:
        results = TRACE.check(expectation)
    except UsageError:
        return
    assert results
    assert {result.drive for result in results} == {"akd-1"}


@given(TEXTS | st.text(alphabet='{}[]=", \nexpct', max_size=40))
def test_any_text_is_expectations_or_an_error_of_usage(text: str) -> None:
    try:
        TRACE.check(text)
    except UsageError:
        return


@given(st.text(max_size=30), VALUES)
def test_any_change_is_a_plant_or_an_error_of_usage(path: str, value: object) -> None:
    try:
        changed = Plant.of("akd").with_changes({path: value})
    except UsageError:
        return
    assert Plant.from_toml(changed.to_toml()).drives == changed.drives


@given(TEXTS, TEXTS | st.floats() | st.integers())
def test_any_parameter_and_value_is_written_or_an_error(parameter: str, value: str | float) -> None:
    drive = Plant.of("akd").start()["akd-1"]
    try:
        drive.write({parameter: value})
    except ProfidriveError as error:
        assert str(error)


@given(st.floats() | st.text(max_size=10))
def test_any_time_is_run_to_or_an_error_of_usage(time: float | str) -> None:
    world = Plant.of("akd").start()
    try:
        world.run(for_=time if isinstance(time, str) else min(time, 2.0))
    except UsageError:
        assert world.now == 0


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_travel_as_they_are(number: float) -> None:
    assert float(value_text(number)) == number
    assert json.loads(document({"x": number}))["x"] == number
    if number >= 0:
        assert float(json.loads(expectation_text({"at": number}))["at"].removesuffix("s")) == number


OCTETS = FULL.read_bytes()
HEADS = st.sampled_from(
    [b"", *(bytes.fromhex(f"020000000002 020000000001 {kind}") for kind in ("8892fefe", "8892fc01", "88cc", "0800"))]
)


@given(st.lists(st.tuples(HEADS, st.binary(max_size=80)), max_size=5))
def test_any_frames_are_explained(frames: list[tuple[bytes, bytes]]) -> None:
    for pdu in decode(pcap(*(head + rest for head, rest in frames))):
        assert pdu.summary
        assert pdu.tree is None or pdu.tree.name == "frame"


@given(st.integers(0, len(OCTETS) - 1), st.binary(min_size=1, max_size=8))
def test_any_octets_are_a_capture_or_an_error(place: int, other: bytes) -> None:
    try:
        for pdu in decode(OCTETS[:place] + other + OCTETS[place + len(other) :]):
            assert pdu.summary
    except LocalError:
        return
