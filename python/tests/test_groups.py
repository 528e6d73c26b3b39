"""The axes of many drives in one block, and the groups of a machine file."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from profidrive import Axis, Plant, State, World
from profidrive.errors import AxisFault, ConnectionLost, DriveGroupError, MisuseError, SafetyError, UsageError
from profidrive.events import Released, StateChanged

DRIVES = ("akd-1", "akd-2", "akd-3")

MACHINE = """
[[drive]]
name = "akd-1"
model = "akd"
groups = ["line1"]
max-speed = "200rpm"

[[drive]]
name = "akd-3"
model = "akd"
groups = ["line1", "line2"]
"""


@pytest.fixture
def world() -> World:
    return Plant.of("akd", "akd", "akd").start()


def assert_all_at_rest(world: World) -> None:
    for drive in DRIVES:
        assert abs(world[drive].speed) < 1, drive
        assert world[drive].state in (State.S1, State.S2)
        assert not world[drive].connected


def test_all_axes_turn_at_once_and_are_stopped_at_once(world: World) -> None:
    drives = world.network.select("akd-*")
    drives.write({"DRV.DEC": "300rpm/s"})
    with drives.control(max_speed="1000rpm") as axes:
        assert list(axes) == list(DRIVES)
        for axis in axes.values():
            axis.run("600rpm")
        assert all(world[drive].speed == pytest.approx(600, abs=10) for drive in DRIVES)
        end = world.now
    assert_all_at_rest(world)
    # a ramp of 2 s for all of them, not for one after the other
    assert world.now - end < 3.5
    released = [event.drive for event in world.trace.only(Released) if event.time >= end]
    assert sorted(released) == list(DRIVES)


def test_an_axis_that_fails_stops_all(world: World) -> None:
    with pytest.raises(AxisFault) as fault, world.network.select("akd-*").control(max_speed="1000rpm") as axes:
        for axis in axes.values():
            axis.run("600rpm")
        world["akd-2"].inject("fault=439")
        axes["akd-2"].run("600rpm", for_="1s")
    assert fault.value.drive == "akd-2"
    world.run(for_="10s")  # a fault leaves a motor to its friction
    assert_all_at_rest(world)


def test_an_axis_that_fails_ends_the_call_that_waits_for_another_one(world: World) -> None:
    plant = Plant.of("akd", "akd", "akd").start
    for action, error in (("fault=439", AxisFault), ("cable=pulled", ConnectionLost)):
        world = plant()
        with pytest.raises(error) as failed, world.network.select("akd-*").control(max_speed="1000rpm", lease=2) as axes:
            axes["akd-2"].run("600rpm")
            axes["akd-3"].run("600rpm")
            # the leases of the others go on while one is waited for
            assert axes["akd-1"].run("600rpm", for_="10s").reached
            assert world["akd-2"].speed == pytest.approx(600, abs=10)
            begin = world.now
            world["akd-2"].inject(action)
            axes["akd-1"].run("600rpm", for_="1000s")
        assert failed.value.drive == "akd-2"
        assert world.now - begin < 5
        world.run(for_="10s")
        for drive in DRIVES:
            assert abs(world[drive].speed) < 1, drive
            assert not world[drive].connected


def test_the_axes_of_a_group_are_moved_by_several_threads(world: World) -> None:
    with world.network.select("akd-*").control(max_speed="1000rpm") as axes:
        runs = [(axis.run, ("600rpm",), {"for_": "3s"}) for axis in axes.values()]
        threads = [threading.Thread(target=run, args=speed, kwargs=lasts, daemon=True) for run, speed, lasts in runs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(30)
            assert not thread.is_alive()
        assert {axis.state for axis in axes.values()} == {State.S4}
        assert all(axis.stats is not None and axis.stats.missed == 0 for axis in axes.values())
    assert_all_at_rest(world)


def test_where_one_axis_cannot_be_taken_none_is(world: World) -> None:
    drives = world.network.select("akd-*")
    with drives[1].control(max_speed=100), pytest.raises(DriveGroupError, match="akd-2") as taken, drives.control(max_speed=100):
        pytest.fail("the block begins")
    assert list(taken.value.errors) == ["akd-2"]
    assert isinstance(taken.value.errors["akd-2"], SafetyError)
    assert_all_at_rest(world)
    assert not [event for event in world.trace.only(StateChanged) if event.new == State.S4]
    with drives.control(max_speed=100):
        pass


def test_a_block_of_axes_is_used_once(world: World) -> None:
    control = world.network.select("akd-1").control(max_speed=100)
    with control as axes:
        assert isinstance(axes["akd-1"], Axis)
        with pytest.raises(TypeError):
            axes["akd-2"] = axes["akd-1"]  # type: ignore[index]
    with pytest.raises(MisuseError), control:
        pass


def test_ctrl_c_in_the_block_releases_all(world: World) -> None:
    with pytest.raises(KeyboardInterrupt), world.network.select("akd-*").control(max_speed="1000rpm") as axes:
        for axis in axes.values():
            axis.run("600rpm")
        raise KeyboardInterrupt
    assert_all_at_rest(world)


def test_a_machine_file_has_groups_and_limits(tmp_path: Path) -> None:
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE)
    network = Plant.of("akd", "akd", "akd").start(machine=path).network
    assert network.select("@line1").names == ("akd-1", "akd-3")
    assert network.select("@line2", "akd-2").names == ("akd-3", "akd-2")
    with pytest.raises(UsageError, match="line3"):
        network.select("@line3")
    with network["akd-1"].control(max_speed="1000rpm") as axis:
        with pytest.raises(SafetyError) as faster:
            axis.run("300rpm")
        assert faster.value.rule == "speed_limit"
        axis.run("200rpm")
    with network["akd-2"].control(max_speed="1000rpm") as axis:
        axis.run("300rpm")
    path.write_text("[[drive]]\nnome = 'akd-1'")
    with pytest.raises(UsageError, match="line 2"):
        Plant.of("akd").start(machine=path)
