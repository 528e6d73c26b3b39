"""Traces: events, samples, expectations."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path

import numpy
import polars
import pyarrow
import pyarrow.parquet
import pytest

from profidrive import Plant, Trace
from profidrive.errors import ExpectationFailed, LocalError, UsageError
from profidrive.events import Event, FaultRaised, Outcome, Sample, StateChanged
from profidrive.types import State

from .conftest import PRESS


@pytest.fixture
def trace(press: Plant) -> Trace:
    return press.run("5s")


def test_events_are_matched_by_their_class(trace: Trace) -> None:
    states = [(event.old, event.new) for event in trace.of("press-1").only(StateChanged)]
    assert states == [(State.S1, State.S2), (State.S2, State.S4)]
    for event in trace.events:
        match event:
            case Sample(drive=drive, speed=speed):
                assert drive in trace.drives
                assert isinstance(speed, float)
            case StateChanged(new=new):
                assert isinstance(new, State)
            case _:
                assert isinstance(event, Event)
        assert event.time == pytest.approx(event.time_ns / 1e9, abs=1e-9)
    assert trace.of("press-1").only(FaultRaised) == ()
    with pytest.raises(UsageError, match="no drive `press-9`; there are: press-1, feeder-1"):
        trace.of("press-9")


def test_events_are_values(trace: Trace) -> None:
    event = trace.events[-1]
    assert pickle.loads(pickle.dumps(event)) == event == copy.deepcopy(event)
    with pytest.raises(AttributeError):
        event.time = 0.0  # type: ignore[misc]


def test_lines_and_documents_are_those_of_the_program(trace: Trace, tmp_path: Path) -> None:
    assert len(trace.lines()) == len(trace.events)
    assert any("S2 ready for switching on -> S4 operation" in line for line in trace.lines())
    trace.write_events(tmp_path / "trace.jsonl")
    lines = [json.loads(line) for line in (tmp_path / "trace.jsonl").read_text().splitlines()]
    assert {"time", "time_ns", "drive", "event"} <= set(lines[0])
    assert len(lines) == len(trace.events)


def test_a_drive_is_known_at_any_time(trace: Trace) -> None:
    before, turning = trace.at("1.4s")["press-1"], trace.at(4)["press-1"]
    assert (before.speed, before.time) == (0.0, 1.4)
    assert turning.speed == pytest.approx(120, abs=2)
    assert turning.zsw1 & 0b100
    assert list(trace.of("feeder-1").at(4)) == ["feeder-1"]
    with pytest.raises(UsageError, match=r"ends at 5\.0 s"):
        trace.at("6s")


def test_samples_are_arrow_columns_without_a_copy(trace: Trace) -> None:
    table = trace.samples
    arrow = pyarrow.table(table)
    assert arrow.column_names == list(table.columns)
    assert arrow.schema.field("speed").metadata[b"unit"] == b"rpm"
    assert arrow.schema.metadata[b"seed"] == b"7"
    plant = Plant.from_file(PRESS)
    hashes = [
        one.run("10ms").samples.metadata["plant_hash"] for one in (plant, plant.with_changes({"drive.press-1.load.friction": 0.3}))
    ]
    assert arrow.schema.metadata[b"plant_hash"].decode() == hashes[0] != hashes[1]
    assert plant.with_changes({}, seed=8).run("10ms").samples.metadata["plant_hash"] == hashes[0]
    speed = table["speed"]
    buffer = arrow["speed"].chunk(0).buffers()[1]
    assert speed.__array_interface__["data"] == (buffer.address, True)
    assert polars.DataFrame(table)["speed"].to_numpy().tolist() == speed.tolist()
    with pytest.raises(ValueError, match="read-only"):
        speed[0] = 1
    del table, arrow, buffer, trace
    assert speed.max() > 100


def test_columns_have_types_units_and_names(trace: Trace) -> None:
    table = trace.samples
    assert table.units["position"] == "rev"
    assert table["t"].dtype == numpy.dtype("m8[ns]")
    assert table["t"][-1] <= numpy.timedelta64(5, "s")
    assert table["zsw1"].dtype == numpy.uint16
    assert set(table["drive"]) == {"press-1", "feeder-1"}
    assert not table["gap"].any()
    assert numpy.isnat(table["wall"]).all()
    assert len(table) == len(table["speed"]) == len(pyarrow.table(table))
    mine = trace.of("press-1").samples
    assert set(mine["drive"]) == {"press-1"}
    with pytest.raises(UsageError, match="no column `torqe`; there are: t, wall"):
        table["torqe"]


@pytest.mark.parametrize("end", ["csv", "arrow", "arrows", "parquet"])
def test_samples_are_written_as_recordings_are(trace: Trace, tmp_path: Path, end: str) -> None:
    file = tmp_path / f"trace.{end}"
    trace.write(file)
    rows = {
        "csv": lambda: len(polars.read_csv(file)),
        "arrow": lambda: len(pyarrow.ipc.open_file(file).read_all()),
        "arrows": lambda: len(pyarrow.ipc.open_stream(file).read_all()),
        "parquet": lambda: len(pyarrow.parquet.read_table(file)),
    }[end]()
    assert rows == len(trace.samples)
    with pytest.raises(LocalError, match="exists"):
        trace.write(file)
    with pytest.raises(UsageError, match="none of csv"):
        trace.write(tmp_path / "trace.xls")


def test_a_picture_needs_no_other_package(trace: Trace, tmp_path: Path) -> None:
    trace.draw(tmp_path / "trace.svg", title="<press>")
    picture = (tmp_path / "trace.svg").read_text()
    assert picture.startswith("<svg")
    assert "<press>" not in picture
    with pytest.raises(UsageError, match="no column `torqe`"):
        trace.draw(tmp_path / "other.svg", ["torqe"])
    with pytest.raises(OSError, match="no-such-folder"):
        trace.draw(tmp_path / "no-such-folder" / "trace.svg")


def test_a_plot_has_units_and_both_drives(trace: Trace) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("svg")
    axes = trace.plot(["speed"])
    labels = [str(line.get_label()) for line in axes.get_lines()]
    assert [label for label in labels if not label.startswith("_")] == ["press-1 speed", "feeder-1 speed"]
    assert axes.get_ylabel() == "speed (rpm)"


def test_expectations_are_mappings_or_texts(press: Plant) -> None:
    trace = press.run()
    results = trace.expect(
        {"at": 4, "drive": "press-1", "state": "S4", "speed": "120rpm", "tolerance": "2rpm"},
        '{ name = "trips", within = "60ms", after = { drive = "press-1", connected = false }, drive = "press-1", fault = 702 }',
        {"never": True, "drive": "feeder-1", "fault": [1, 702]} | {"never": "..19s", "fault": "any"},
    )
    assert [result.name for result in results] == ["expectation 1", "trips", "expectation 3"]
    assert all(result.outcome is Outcome.MET for result in results)
    assert [result.name for result in trace.expect()] == list(press.expectations)


def test_a_lost_expectation_says_what_there_was(press: Plant) -> None:
    trace = press.run("5s")
    with pytest.raises(ExpectationFailed) as lost:
        trace.expect({"at": "4s", "drive": "press-1", "speed": "130rpm", "tolerance": "1%"})
    message = str(lost.value)
    assert message.startswith("1 of 1 expectations lost\npress-1: expectation 1: not met\n"), "no one has seen its line"
    for part in ('speed = "130rpm"', "actual:   speed 120", "last events of press-1", "seed 7"):
        assert part in message
    [result] = lost.value.results
    assert result.nearest is not None
    assert str(result).startswith("press-1: expectation 1: not met: expected at = ")
    assert "last_events" not in repr(result)
    with pytest.raises(ExpectationFailed, match="\nline 2: press-1: expectation 1: not met\n"):
        trace.expect('\nexpect = [{ at = "4s", drive = "press-1", state = "S1" }]')
    assert result.nearest.value == pytest.approx(120, abs=2)
    assert pickle.loads(pickle.dumps(lost.value)).results == lost.value.results


def test_mistakes_in_expectations_are_usage_errors(trace: Trace) -> None:
    for wrong, why in [
        ({"at": "2s", "speed": "120rpm"}, "tolerance"),
        ({"speed": "<=1rpm"}, "exactly one of"),
        ({"at": "2s", "drive": "press-9", "state": "S4"}, "no drive `press-9`"),
        ("{ at = ", "string values must be quoted|expected"),
        ("expect = 5", "list of tables"),
        ({"at": "2s", "parameter": {"DRV.ACC": ">1rpm/s"}}, "keeps no parameters"),
        ({"at": "2s", "state": None}, "null|unit|None"),
        ({"at": "2s", "state": object()}, "neither a number"),
    ]:
        with pytest.raises(UsageError, match=why):
            trace.expect(wrong)  # type: ignore[arg-type]


def test_what_is_expected_of_one_drive(press: Plant) -> None:
    trace = press.run("5s").of("press-1")
    [result] = trace.expect({"always": True, "speed": "-160rpm..160rpm"})
    assert result.drive == "press-1"
    with pytest.raises(UsageError, match="nothing is expected of press-1"):
        trace.expect({"never": True, "drive": "feeder-1", "fault": "any"})
