"""Plants, worlds and virtual drives."""

from __future__ import annotations

import gc
import threading
from datetime import timedelta
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy
import pint
import pytest

from profidrive import Plant, State, Zsw1
from profidrive._values import value_text
from profidrive.errors import (
    ExpectationFailed,
    LocalError,
    RefusedError,
    UnknownParameter,
    UsageError,
)
from profidrive.events import FaultRaised, Injected, ParameterWritten, ReadingValue, WrittenBy

from .conftest import PRESS, output_when_interrupted


def test_a_plant_of_models_names_its_drives() -> None:
    plant = Plant.of("akd", "vlt", "akd")
    assert plant.drives == ("akd-1", "vlt-1", "akd-2")
    world = plant.start()
    assert world["vlt-1"].state is State.S1
    assert str(world["akd-2"].state) == "S1 switching on inhibited"


def test_mistakes_in_plants_are_usage_errors_with_their_line(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no model `sinamics`; there are: akd, vlt, vacon"):
        Plant.of("sinamics")
    with pytest.raises(UsageError, match="at least one drive"):
        Plant.of()
    with pytest.raises(UsageError) as wrong:
        Plant.from_toml('[[drive]]\nname = "akd-1"\nmodel = "cvt"')
    assert wrong.value.line == 3
    file = tmp_path / "line.toml"
    file.write_text('[[drive]]\nname = "Bad_Name"')
    with pytest.raises(UsageError, match=r"line\.toml, line 2: `Bad_Name` is not a valid station name") as wrong:
        Plant.from_file(file)
    assert wrong.value.line == 2
    with pytest.raises(LocalError, match=r"no-such\.toml") as missing:
        Plant.from_file(tmp_path / "no-such.toml")
    assert missing.value.errno == 2
    assert isinstance(missing.value, OSError)


def test_a_run_is_the_same_for_the_same_seed_however_it_is_divided(press: Plant) -> None:
    whole = press.run()
    world = press.start()
    for step in (1.5, "2s", timedelta(seconds=2.8), 12.1):
        world.run(step)
    world.run(for_="7.9s")
    parts = world.run(until=30)
    assert (whole.seed, whole.end, whole.digest) == (7, 30.0, parts.digest)
    assert len(whole.events) > 50
    assert whole.events == parts.events
    assert press.run(seed=8).digest != whole.digest


def test_time_is_virtual_and_passes_only_while_it_is_waited_for(press: Plant) -> None:
    world = press.start()
    assert world.now == 0
    world.run(for_="250ms")
    assert world.now == 0.25
    with pytest.raises(UsageError, match="cannot go back"):
        world.run("200ms")
    with pytest.raises(UsageError, match="not both"):
        world.run("2s", for_="1s")
    with pytest.raises(UsageError, match="a time needs its unit"):
        world.run("5")
    for wrong in (-1, float("nan"), float("inf"), 1e12):
        with pytest.raises(UsageError):
            world.run(for_=wrong)
    with pytest.raises(UsageError, match="how long"):
        Plant.of("akd").run()


def test_a_run_waits_for_conditions_and_returns_the_event(press: Plant) -> None:
    world = press.start()
    moving = world.run_until("press-1", speed=">100rpm", timeout="3s")
    assert 1.5 < moving.time < 2.0
    assert world.now == pytest.approx(moving.time)
    world["press-1"].inject("cable=pulled", for_="400ms")
    begin = world.now
    lost = world.run_until("press-1", fault=702, timeout="100ms")
    assert isinstance(lost, FaultRaised)
    assert lost.fault.number == 702
    assert lost.time < begin + 0.06
    assert world["press-1"].faults[0].number == 702
    # the constants of the package are conditions too
    world.run_until("press-1", state=State.S1, zsw1=Zsw1.FAULT, timeout="100ms")
    world.run_until("press-1", moving=False, for_=0.1, timeout=5)
    assert not world["press-1"].moving


def test_what_did_not_happen_in_time_is_a_lost_expectation() -> None:
    world = Plant.of("akd").start()
    with pytest.raises(ExpectationFailed, match="state") as lost:
        world.run_until("akd-1", state="S4", timeout="200ms")
    [result] = lost.value.results
    assert (result.drive, result.outcome.value) == ("akd-1", "not_met")
    assert lost.value.drive == "akd-1"
    assert world.now == 0.2
    assert isinstance(lost.value, AssertionError)
    with pytest.raises(UsageError, match="^unknown key `colour`"):
        world.run_until("akd-1", colour="red", timeout=1)
    with pytest.raises(UsageError, match="no drive `akd-7`; there are: akd-1"):
        world.run_until("akd-7", state="S4", timeout=1)


def test_a_parameter_is_read_and_written_as_people_write_it() -> None:
    world = Plant.of("akd", "vlt").start()
    drive = world["akd-1"]
    assert drive.read("DRV.ACC").value == 3000
    speed = pint.UnitRegistry().Quantity(5000, "rpm/s")
    exact = pint.UnitRegistry(non_int_type=Decimal).Quantity(Decimal(5000), "rpm/s")
    numbers = (5000, 5000.0, numpy.float64(5000), numpy.float32(5000), numpy.int16(5000), Decimal(5000), Fraction(5000))
    values: list[Any] = ["5000rpm/s", speed, numpy.float32(1) * speed, Decimal(1) * exact, *numbers]
    for value in values:
        [written] = drive.write({"DRV.ACC": value})
        assert written.value == pytest.approx(5000, abs=2)
        assert (written.name, written.parameter, written.pnu, written.unit) == ("DRV.ACC", "p2108", 2108, "rpm/s")
    assert drive.read("p2108") == written
    [event, *_] = world.run(for_=0.01).only(ParameterWritten)
    assert (event.drive, event.by, event.reading.name) == ("akd-1", WrittenBy.OTHER, "DRV.ACC")
    text: ReadingValue = world["vlt-1"].write({"p37": "HELLO"})[0].value
    assert text == "HELLO"


def test_a_value_is_not_cut(press: Plant) -> None:
    texts: dict[Any, str] = {
        numpy.float32(0.5): "0.5",
        Decimal("0.25"): "0.25",
        1e-7: "0.0000001",
        numpy.float16(1.5) * pint.UnitRegistry()("rpm"): "1.5rpm",
        numpy.int8(-3): "-3",
        numpy.True_: "1",
    }
    for value, text in texts.items():
        assert value_text(value) == text
    assert value_text(2, "rev") == "2rev"
    mistakes: list[Any] = [None, 1j, [1], numpy.array([1, 2]), float("nan"), Decimal("inf"), object()]
    for wrong in mistakes:
        with pytest.raises(UsageError, match="value"):
            value_text(wrong)
    world = press.start()
    for span in (numpy.float32(0.25), Decimal("0.25"), numpy.int8(1)):
        world.run(for_=span)  # type: ignore[arg-type]
    world.run_until("press-1", moving=True, for_=numpy.float32(0.25), timeout=numpy.float32(1))
    with pytest.raises(UsageError, match="seconds"):
        world.run(for_=object())  # type: ignore[arg-type]


def test_refusals_of_a_parameter_have_what_a_program_needs() -> None:
    drive = Plant.of("akd").start()["akd-1"]
    with pytest.raises(UnknownParameter, match=r"DRV\.ACX") as unknown:
        drive.read("DRV.ACX")
    assert "DRV.ACC" in unknown.value.nearest
    assert isinstance(unknown.value, KeyError)
    assert "nearest names" in (unknown.value.hint or "")
    with pytest.raises(UsageError, match="A"):
        drive.write({"DRV.ACC": "5A"})
    with pytest.raises(UsageError, match="index"):
        drive.read("p947")
    with pytest.raises((RefusedError, UsageError)):
        drive.write({"p947[0]": 1})


def test_something_that_happens_at_the_start_of_every_run() -> None:
    plant = Plant.of("akd")
    plant["akd-1"].inject("warning=107", for_="50ms")
    for _ in range(2):
        events = plant.run("100ms").only(Injected)
        assert [(event.time, event.action, event.duration) for event in events] == [(0.0, "warning=107", 0.05)]
        assert Plant.from_toml(plant.to_toml()).run("100ms").digest == plant.run("100ms").digest
    assert plant.run("100ms").digest != Plant.of("akd").run("100ms").digest
    with pytest.raises(UsageError, match="no fault 999"):
        plant["akd-1"].inject("fault=999")
    with pytest.raises(UsageError, match="nearest key: cable"):
        plant.start()["akd-1"].inject("cabel=pulled")


def test_a_plant_is_changed_by_paths_and_keeps_its_comments(press: Plant) -> None:
    stiff = press.with_changes({"drive.press-1.load.friction": 0.4}, seed=11)
    assert stiff.seed == 11
    assert stiff.to_toml() == PRESS.read_text().replace("friction = 0.1", "friction = 0.4").replace("seed = 7", "seed = 11")
    assert press.seed == 7
    with pytest.raises(UsageError, match=r"drive\.press-2\.model: no `press-2`; there are: press-1, feeder-1"):
        press.with_changes({"drive.press-2.model": "vlt"})
    with pytest.raises(UsageError):
        press.with_changes({"seed": object()})
    with pytest.raises(UsageError):
        press.with_changes({"seed": None})
    for seed in (-1, 1 << 63, 1 << 64, 1.5, "7"):
        with pytest.raises(UsageError, match="seed"):
            press.start(seed=seed)  # type: ignore[arg-type]
        with pytest.raises(UsageError, match="seed"):
            press.with_changes({}, seed=seed)  # type: ignore[arg-type]


def test_expectations_of_the_plant_file_are_checked_while_it_runs(press: Plant) -> None:
    world = press.start()
    world.run()
    assert [result.name for result in world.expect()] == list(press.expectations)
    changed = press.with_changes({"expect.reaches speed.speed": "130rpm"}).start()
    changed.run()
    with pytest.raises(ExpectationFailed, match="1 of 5 expectations lost") as lost:
        changed.expect()
    assert [result.outcome.value for result in lost.value.results].count("met") == 4


def test_ctrl_c_ends_a_run() -> None:
    program = (
        "import profidrive, sys\n"
        "plant = profidrive.Plant.of(*['akd'] * 40)\n"
        "world = plant.start()\n"
        "try:\n"
        "    print('runs', flush=True)\n"
        "    world.run(20_000_000)\n"
        "except KeyboardInterrupt:\n"
        "    print('ended', world.now < 20_000_000, flush=True)\n"
    )
    assert output_when_interrupted(program) == "ended True\n"


def test_ctrl_c_ends_a_wait_for_conditions() -> None:
    program = (
        "import profidrive\n"
        "world = profidrive.Plant.of(*['akd'] * 40).start()\n"
        "try:\n"
        "    print('runs', flush=True)\n"
        "    world.run_until('akd-1', fault='any', timeout=20_000_000)\n"
        "except KeyboardInterrupt:\n"
        "    print('ended', world.now < 20_000_000, flush=True)\n"
        "    world['akd-1'].inject('fault=439')\n"
        "    print(world.run_until('akd-1', fault=439, timeout='1s').fault.number)\n"
    )
    assert output_when_interrupted(program) == "ended True\n439\n"


def test_threads_run_worlds_of_their_own_and_share_one(press: Plant) -> None:
    expected = press.run("5s").digest
    digests: list[str] = []
    threads = [threading.Thread(target=lambda: digests.append(press.run("5s").digest), daemon=True) for _ in range(4)]
    shared = press.start()
    threads += [threading.Thread(target=lambda: [shared["press-1"].speed for _ in range(50)], daemon=True) for _ in range(2)]
    for thread in threads:
        thread.start()
    trace = shared.run("5s")
    for thread in threads:
        thread.join(60)
    assert digests == [expected] * 4
    assert trace.digest == expected


def test_a_world_that_is_forgotten_leaves_its_trace_whole(press: Plant) -> None:
    world = press.start()
    early = world.run("2s")
    late = world.run("4s")
    del world
    gc.collect()
    assert (early.end, late.end) == (2.0, 4.0)
    assert early.digest == press.run("2s").digest
    assert len(early.events) < len(late.events)
