"""An axis under control, in virtual time: motions, and the rules that each of them keeps."""

from __future__ import annotations

import gc
import itertools
import sys
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any, TypeAlias

import numpy
import pytest

import profidrive
from profidrive import Drive, Plant, State, Stw1, World, Zsw1
from profidrive.errors import (
    AxisFault,
    ConnectionLost,
    ExpectationFailed,
    InterruptedCall,
    MisuseError,
    NotReached,
    ProfidriveError,
    RefusedError,
    SafetyError,
    UnsupportedError,
    UsageError,
)
from profidrive.events import ParameterWritten, Released, StateChanged

from .conftest import output_when_interrupted, until

TraceFunction: TypeAlias = "Callable[[FrameType, str, Any], TraceFunction | None]"


@pytest.fixture
def world() -> World:
    return Plant.of("akd", "vlt").start()


@pytest.fixture
def akd(world: World) -> Drive:
    return world.network["akd-1"]


def assert_at_rest(world: World, drive: str = "akd-1") -> None:
    assert abs(world[drive].speed) < 1
    assert world[drive].state in (State.S1, State.S2)


def test_motions_follow_each_other(world: World, akd: Drive) -> None:
    with akd.control(max_speed="1000rpm") as axis:
        assert world["akd-1"].state != State.S4, "taken, not enabled"
        turned = axis.run("600rpm", for_="500ms")
        assert turned.reached
        assert turned.highest_speed is not None
        assert turned.highest_speed.value == pytest.approx(600, abs=10)
        assert world["akd-1"].speed == pytest.approx(0, abs=1)
        assert axis.state == State.S4
        axis.run(-300)
        assert world["akd-1"].speed == pytest.approx(-300, abs=10)
        assert axis.speed == pytest.approx(-300, abs=10)
        stats = axis.stats
        assert stats is not None
        assert (stats.received > 10, stats.missed) == (True, 0)
        assert 0 < stats.longest_gap < 0.1
        axis.stop()
        assert_at_rest(world)
        axis.run("200rpm")
    assert_at_rest(world)
    [released] = world.trace.of("akd-1").only(Released)
    assert released.time > 1


def test_an_axis_is_kept_while_a_world_runs_until_something(world: World, akd: Drive) -> None:
    recording = akd.record("p922", every="100ms")
    with pytest.raises(AxisFault), akd.control(max_speed="1000rpm", lease="30s") as axis:
        axis.run("300rpm")
        with pytest.raises(ExpectationFailed):
            world.run_until("akd-1", speed=0, tolerance="1rpm", timeout="2s")
        assert world["akd-1"].speed == pytest.approx(300, abs=5)
        world["akd-1"].inject("fault=439")
        raised = world.run_until("akd-1", state="S1", timeout="100ms")
        assert isinstance(raised, StateChanged)
        assert [fault.number for fault in world["akd-1"].faults] == [439]
        axis.run("300rpm", for_="1s")
    recording.stop()
    assert len(recording) > 20
    assert recording.gaps() == ()


def test_a_stop_that_takes_too_long_goes_on(world: World, akd: Drive) -> None:
    akd.write({"DRV.DEC": "100rpm/s"})
    with akd.control(max_speed="1000rpm") as axis:
        axis.run("600rpm")
        with pytest.raises(NotReached, match=r"0\.5 s"):
            axis.stop(timeout="500ms")
        slower = world["akd-1"].speed
        assert 500 < slower < 600
        assert axis.zsw1 is not None
        assert Zsw1.NO_OFF2 in axis.zsw1
        assert Stw1.CTRL_PLC in world["akd-1"].stw1
        assert axis.stop(timeout="20s").reached
    assert_at_rest(world)


def test_positions_need_the_mode_and_put_it_back(world: World, akd: Drive) -> None:
    with pytest.raises(SafetyError) as wrong, akd.control(max_speed="600rpm", mode="position"):
        pass
    assert (wrong.value.rule, wrong.value.drive) == ("mode", "akd-1")
    with pytest.raises(UsageError, match="mode"):
        akd.control(max_speed="600rpm", set_mode=True)
    for nothing in (0, "0rpm", -0.0):
        with pytest.raises(UsageError, match="above 0"):
            akd.control(max_speed=nothing).__enter__()
    with akd.control(max_speed="600rpm", mode="position", set_mode=True) as axis:
        with pytest.raises(SafetyError, match="homed") as unhomed:
            axis.move_to("3rev", speed="300rpm")
        assert unhomed.value.rule == "move"
        assert axis.home().homed
        moved = axis.move_to("3rev", speed="300rpm", acceleration="3000rpm/s")
        assert moved.reached
        assert moved.position is not None
        assert moved.position.value == pytest.approx(3, abs=0.01)
        axis.move_by("-1rev", speed=300)
        assert axis.position == pytest.approx(2, abs=0.01)
        # a number is in the unit that `position` and `speed` have
        axis.move_by(1.5, speed=300)
        there = axis.position
        assert there is not None
        assert there == pytest.approx(3.5, abs=0.01)
        axis.move_by(numpy.float32(-1.5), speed=numpy.int16(300))
        axis.move_to(there, speed=300)
        assert axis.position == pytest.approx(there, abs=0.01)
        axis.jog("60rpm", for_=1)
        axis.move_by("20rev", speed="300rpm", wait=False)
        world.run(for_="500ms")
        assert world["akd-1"].speed == pytest.approx(300, abs=10)
        with pytest.raises((SafetyError, RefusedError, UsageError, UnsupportedError)):
            axis.task(77)
        with pytest.raises((SafetyError, RefusedError, UsageError, UnsupportedError)):
            axis.task(77, wait=False)
        with pytest.raises(SafetyError) as wrong:
            axis.run(100)
        assert wrong.value.rule == "mode"
    assert_at_rest(world)
    assert akd.read("p930").value == 1


def test_a_speed_is_a_round_trip(akd: Drive) -> None:
    with akd.control(max_speed="600rpm") as axis:
        axis.run(300)
        speed = axis.speed
        assert speed is not None
        assert speed == pytest.approx(300, abs=10)
        axis.run(speed)
        assert axis.speed == pytest.approx(300, abs=10)


def test_rule_1_nothing_moves_without_a_block_and_no_limit_is_assumed(world: World, akd: Drive) -> None:
    akd.control(max_speed=100)
    akd.read("p930")
    world.run(for_=1)
    assert not world["akd-1"].connected
    with pytest.raises(TypeError):
        akd.control()  # type: ignore[call-arg]
    assert world.trace.of("akd-1").only(ParameterWritten) == ()
    with akd.control(max_speed="100rpm") as axis:
        axis.run(100)
        for speed in (101, -101, "2rps", float("nan"), float("inf")):
            with pytest.raises((SafetyError, UsageError)) as refused:
                axis.run(speed)
            assert getattr(refused.value, "rule", "speed_limit") == "speed_limit"
        assert world["akd-1"].speed == pytest.approx(100, abs=5), "it goes on as before"


@pytest.mark.parametrize("failure", [RuntimeError("in the program"), KeyboardInterrupt(), SystemExit(3)])
def test_rule_2_however_the_block_ends_the_axis_is_released(world: World, akd: Drive, failure: BaseException) -> None:
    with pytest.raises(type(failure)), akd.control(max_speed="600rpm") as axis:
        axis.run("600rpm")
        raise failure
    assert_at_rest(world)
    assert not world["akd-1"].connected


def test_rule_3_a_program_without_calls_loses_the_axis(world: World, akd: Drive) -> None:
    with akd.control(max_speed="600rpm", lease="1s") as axis:
        axis.run("600rpm")
        for _ in range(5):
            world.run(for_="800ms")
            axis.keep_alive()
        assert world["akd-1"].speed > 580
        world.run(for_="2s")
        assert_at_rest(world)
        with pytest.raises(SafetyError) as ended:
            axis.run("600rpm")
        assert ended.value.rule == "lease"
        assert_at_rest(world)
        axis.run("600rpm", for_="5s")  # a call that waits renews it
    with pytest.raises(SafetyError) as ended, akd.control(max_speed="600rpm", lease="1s") as axis:
        axis.run("600rpm")
        world.run(for_="2s")
    assert ended.value.rule == "lease"


def test_rule_4_a_drive_that_runs_on_alone_needs_consent() -> None:
    plant = Plant.of("vlt").with_changes({"drive.vlt-1.parameters": {"8-04": 0}})
    world = plant.start()
    drive = world.network["vlt-1"]
    with pytest.raises(SafetyError) as alone, drive.control(max_speed=300):
        pass
    assert alone.value.rule == "controller_loss"
    assert "accept_no_timeout=True" in (alone.value.hint or "")
    with pytest.raises(ConnectionLost) as lost, drive.control(max_speed=300, accept_no_timeout=True) as axis:
        axis.run(300)
        world["vlt-1"].inject("cable=pulled")
        axis.run(200)
    assert lost.value.drive_continues is True
    world.run(for_=3)
    assert world["vlt-1"].speed > 250


def test_rule_5_a_forgotten_axis_is_stopped(world: World, akd: Drive) -> None:
    axis = akd.control(max_speed="600rpm").__enter__()
    axis.run("600rpm")
    axes = [axis]
    del axis
    with pytest.warns(ResourceWarning, match="akd-1"):
        axes.clear()
    gc.collect()
    world.run(for_=2)
    assert_at_rest(world)
    assert not world["akd-1"].connected


def test_rule_6_no_attribute_writes_to_a_drive(world: World, akd: Drive) -> None:
    with akd.control(max_speed="600rpm") as axis:
        with pytest.raises(AttributeError):
            axis.velocity = 100  # type: ignore[attr-defined]
        with pytest.raises(AttributeError):
            axis.speed = 100  # type: ignore[misc]
    with pytest.raises(AttributeError):
        akd.acceleration = 100  # type: ignore[attr-defined]


def test_rule_7_after_a_lost_connection_the_drive_is_usable_and_the_axis_is_not(world: World, akd: Drive) -> None:
    with pytest.raises(ConnectionLost) as lost, akd.control(max_speed="600rpm") as axis:
        axis.run("600rpm")
        world["akd-1"].inject("cable=pulled", for_="3s")
        with pytest.raises(ConnectionLost):
            axis.run("600rpm", for_="10s")
        axis.run("600rpm")
    assert (lost.value.drive, lost.value.drive_continues) == ("akd-1", False)
    world.run(for_=3)
    with pytest.raises(MisuseError, match="released"):
        axis.run("600rpm")
    assert akd.read("DRV.ACC").value == 3000
    with akd.control(max_speed="600rpm") as axis:
        axis.ack()
        axis.run("600rpm", for_="100ms")
    assert_at_rest(world)


def test_a_fault_is_an_error_with_its_number(world: World, akd: Drive) -> None:
    with akd.control(max_speed="600rpm") as axis:
        axis.run("600rpm")
        world["akd-1"].inject("fault=439")
        with pytest.raises(AxisFault) as fault:
            axis.run("300rpm", for_="10s")
        assert fault.value.fault is not None
        assert fault.value.fault.number == 439
        assert fault.value.motion is not None
        assert not fault.value.motion.reached
        axis.ack()
        axis.run("300rpm", for_="100ms")
    assert_at_rest(world)


def test_a_stop_from_another_thread_ends_the_motion(world: World, akd: Drive) -> None:
    network = world.network
    for stop in (network.stop_all, lambda: network.stop_all(quick=True), akd.stop):
        with akd.control(max_speed="600rpm") as axis:
            axis.run("600rpm")
            other = threading.Thread(target=stop, daemon=True)
            other.start()
            other.join(30)
            assert not other.is_alive()
            world.run(for_="500ms")
            assert_at_rest(world)
            with pytest.raises(InterruptedCall):
                axis.keep_alive()


def test_an_axis_is_moved_by_one_thread_at_a_time(world: World, akd: Drive) -> None:
    outcomes: list[object] = []
    with akd.control(max_speed="600rpm") as axis:

        def move() -> None:
            try:
                outcomes.append(axis.run("600rpm", for_=100_000))
            except ProfidriveError as error:
                outcomes.append(type(error))

        mover = threading.Thread(target=move, daemon=True)
        mover.start()
        until(lambda: axis.state == State.S4, "operation")
        with pytest.raises(MisuseError, match="another thread"):
            axis.run("300rpm")
        axis.stop()
        mover.join(30)
    assert outcomes == [InterruptedCall]
    assert_at_rest(world)


def test_control_is_for_one_block_and_one_controller(world: World, akd: Drive) -> None:
    control = akd.control(max_speed=100)
    with control as axis:
        with pytest.raises(SafetyError, match="already") as taken, world.network["akd-1"].control(max_speed=100):
            pass
        assert taken.value.rule == "control"
        axis.run(100)
    with pytest.raises(MisuseError), control:
        pass
    with pytest.raises(MisuseError, match="released"):
        axis.run(100)
    assert axis.speed == pytest.approx(0, abs=1), "as it was seen last"


def test_a_frequency_is_the_speed_of_a_converter(world: World) -> None:
    with world.network["vlt-1"].control(max_speed="50Hz", accept_no_timeout=True) as axis:
        axis.run("10Hz")
        assert world["vlt-1"].speed == pytest.approx(300, abs=15)
        with pytest.raises(UsageError):
            axis.run("10A")


def test_leaving_a_network_brings_its_axes_to_rest(world: World, akd: Drive) -> None:
    with world.network as network, warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        axis = network["akd-1"].control(max_speed="600rpm").__enter__()
        axis.run("600rpm")
    world.run(for_="10ms")
    assert_at_rest(world)
    with pytest.raises(MisuseError, match="closed"):
        axis.run("600rpm")
    with pytest.raises(MisuseError, match="closed"):
        akd.read("DRV.ACC")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        del axis
        gc.collect()


SCRIPT = """
network = world.network
drive = network["akd-1"]
drive.write({"DRV.ACC": "5000rpm/s"})
with drive.control(max_speed="600rpm", mode="position", set_mode=True) as axis:
    axis.home()
    axis.move_to("1rev", speed="300rpm")
    axis.move_by("30rev", speed="300rpm", wait=False)
    world.run(for_="200ms")
drive.status()
"""
LINES = {"script", *(str(Path(profidrive.__file__).parent / name) for name in ("_sync.py", "_waiting.py", "plant.py"))}


def killed_at(number: int) -> tuple[World, bool]:
    """Runs the script until Ctrl-C comes before the line of this number, of it or of the package. False where it ended before."""
    world, lines = Plant.of("akd").start(), 0

    def line(frame: FrameType, event: str, _: object) -> TraceFunction | None:
        nonlocal lines
        # what is raised in a finalizer is lost
        if frame.f_code.co_filename not in LINES or frame.f_code.co_name == "__del__":
            return None
        if event == "line":
            lines += 1
            if lines == number:
                raise KeyboardInterrupt
        return line

    before = sys.gettrace()
    sys.settrace(line)
    try:
        exec(compile(SCRIPT, "script", "exec"), {"world": world})
    except KeyboardInterrupt:
        return world, True
    finally:
        sys.settrace(before)
    return world, False


@pytest.mark.parametrize("part", range(4))
def test_a_script_that_is_interrupted_at_any_line_leaves_its_axis_at_rest(part: int) -> None:
    with warnings.catch_warnings():
        # a line of the package that takes or leaves control may be one of them
        warnings.simplefilter("ignore", ResourceWarning)
        for number in itertools.count(1 + part, 4):
            world, interrupted = killed_at(number)
            gc.collect()
            world.run(for_="3s")
            assert_at_rest(world)
            assert not world["akd-1"].connected, number
            assert world.network["akd-1"].read("p930").value == 1, number
            if not interrupted:
                break
    assert number > 60


CONTROLLED = """
import threading
import profidrive
world = profidrive.Plant.of("akd").start()
drive = world.network["akd-1"]
"""


def test_ctrl_c_ramps_down_before_it_is_raised() -> None:
    program = (
        CONTROLLED
        + """
try:
    with drive.control(max_speed="600rpm") as axis:
        def watch():
            while (axis.speed or 0) < 590:
                pass
            print("runs", flush=True)
        threading.Thread(target=watch, daemon=True).start()
        try:
            axis.run("600rpm", for_=30_000_000)
        except KeyboardInterrupt:
            print(f"{world['akd-1'].speed:.0f}", world["akd-1"].state.name)
            raise
except KeyboardInterrupt:
    print("released", not world["akd-1"].connected)
"""
    )
    assert output_when_interrupted(program).replace("-0 ", "0 ") in ("0 S2\nreleased True\n", "0 S1\nreleased True\n")
