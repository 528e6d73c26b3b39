"""The face for asyncio: the same results, and what is its own, which is cancelling."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import Coroutine
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import profidrive
from profidrive import Plant, State, World, _waiting, aio
from profidrive.errors import InterruptedCall, NotReached, ProfidriveError, UnknownParameter

T = TypeVar("T")


def run(work: Coroutine[Any, Any, T]) -> T:
    async def limited() -> T:
        return await asyncio.wait_for(work, 60)

    return asyncio.run(limited(), debug=True)


@pytest.fixture
def world() -> World:
    return Plant.of("akd", "vlt").start()


CALLS = st.lists(
    st.sampled_from(
        [
            ("read", ("DRV.ACC",), {}),
            ("read", (["p922", "DRV.DEC"],), {}),
            ("read", ("DRV.NONE",), {}),
            ("write", ({"DRV.ACC": "5000rpm/s"},), {}),
            ("write", ({"DRV.ACC": "much"},), {}),
            ("write", ({"DRV.DEC": 100},), {"dry_run": True}),
            ("status", (), {}),
            ("faults", (), {"history": True}),
            ("ack", (), {}),
            ("describe", ("DRV.ACC",), {}),
            ("stop", (), {}),
        ]
    ),
    min_size=1,
    max_size=4,
)


@given(CALLS)
@settings(max_examples=25, deadline=None, derandomize=True)
def test_both_faces_give_equal_results(calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]]) -> None:
    def waited() -> list[object]:
        world = Plant.of("akd").start()
        drive, results = world.network["akd-1"], list[object]()
        for name, arguments, named in calls:
            try:
                results.append(getattr(drive, name)(*arguments, **named))
            except ProfidriveError as error:
                results.append((type(error), str(error)))
        return [*results, world.now, world.trace.digest]

    async def awaited() -> list[object]:
        world = Plant.of("akd").start()
        drive, results = aio.network_of(world)["akd-1"], list[object]()
        for name, arguments, named in calls:
            try:
                results.append(await getattr(drive, name)(*arguments, **named))
            except ProfidriveError as error:
                results.append((type(error), str(error)))
        return [*results, world.now, world.trace.digest]

    assert waited() == run(awaited())


def test_both_faces_have_the_same_names() -> None:
    for name in aio.__all__:
        if name == "network_of":
            continue
        ours, other = getattr(aio, name), getattr(profidrive, name)
        if not isinstance(ours, type):
            continue
        same = {"__aenter__": "__enter__", "__aexit__": "__exit__"}
        assert {same.get(one, one) for one in vars(ours)} == set(vars(other)), name


def test_an_axis_moves_and_the_loop_goes_on(world: World) -> None:
    async def work() -> int:
        turns = 0

        async def count() -> None:
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0)

        counting = asyncio.create_task(count())
        network = aio.network_of(world)
        async with network["akd-1"].control(max_speed="600rpm") as axis:
            assert (await axis.run("300rpm", for_="500ms")).reached
            assert axis.state is State.S4
        both = await network.select("all")
        assert set(await both.status()) == {"akd-1", "vlt-1"}
        async with await both[:1].record("p922", every="100ms") as recording:
            await network.scan(wait="1s")
        assert len(recording) > 5
        await network.close()
        counting.cancel()
        return turns

    assert run(work()) > 3
    assert abs(world["akd-1"].speed) < 1


def test_a_cancelled_motion_is_stopped_and_its_block_is_left(world: World) -> None:
    async def work() -> None:
        async with aio.network_of(world)["akd-1"].control(max_speed="600rpm") as axis:
            moving = asyncio.create_task(axis.run("300rpm", for_="100000s"))
            while abs(axis.speed or 0) < 250:
                await asyncio.sleep(0)
            moving.cancel()
            with pytest.raises(asyncio.CancelledError):
                await moving

    run(work())
    assert abs(world["akd-1"].speed) < 1
    assert world["akd-1"].state in (State.S1, State.S2)


def test_a_cancelled_task_leaves_the_block_first(world: World) -> None:
    async def work() -> None:
        begun = asyncio.Event()

        async def moves() -> None:
            async with aio.network_of(world)["akd-1"].control(max_speed="600rpm") as axis:
                await axis.run("300rpm")
                begun.set()
                await asyncio.sleep(3600)

        task = asyncio.create_task(moves())
        await begun.wait()
        task.cancel()
        await asyncio.sleep(0)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert abs(world["akd-1"].speed) < 1, "a second one does not leave the stop"

    run(work())


def test_a_cancelled_write_says_what_became_of_it(world: World) -> None:
    async def work() -> list[str]:
        drive = aio.network_of(world)["akd-1"]
        await drive.read("DRV.ACC")
        notes = []
        for values, dry_run in (({"DRV.ACC": 5000.0, "DRV.DEC": 4000.0}, False), ({"DRV.ACC": 1000.0}, True)):
            inbox: SimpleQueue[_waiting._Begun[Any]] = SimpleQueue()
            _waiting._IDLE.append(inbox)
            writing = asyncio.create_task(drive.write(values, dry_run=dry_run))
            await asyncio.sleep(0)
            begun = inbox.get(timeout=1)
            thread = Thread(target=begun.carry_out)
            thread.start()
            # one that its thread has not begun is dropped
            while not begun._claim.locked():
                await asyncio.sleep(0)
            writing.cancel()
            with pytest.raises(asyncio.CancelledError) as cancelled:
                await writing
            notes.append(getattr(cancelled.value, "__notes__", []))
            thread.join(30)
        assert notes[1] == []
        assert (await drive.read("DRV.DEC")).value == 4000, "what was begun goes on"
        return notes[0]

    notes = run(work())
    if sys.version_info >= (3, 11):
        [note] = notes
        assert note.startswith("akd-1: DRV.ACC, DRV.DEC: ")
        assert note.split(": ")[2] in ("in doubt", "written")


def test_a_cancelled_write_that_was_refused_is_not_written(world: World) -> None:
    """The thread has the refusal before the event loop sees it."""

    async def work() -> list[list[str]]:
        network = aio.network_of(world)
        drives = await network.select("akd-1")
        notes = []
        for target in (network["akd-1"], drives):
            inbox: SimpleQueue[_waiting._Begun[Any]] = SimpleQueue()
            _waiting._IDLE.append(inbox)
            writing = asyncio.create_task(target.write({"DRV.ACC": "4000 furlongs"}))
            await asyncio.sleep(0)
            inbox.get(timeout=1).carry_out()
            writing.cancel()
            with pytest.raises(asyncio.CancelledError) as cancelled:
                await writing
            notes.append(getattr(cancelled.value, "__notes__", []))
        return notes

    for notes in run(work()):
        if sys.version_info >= (3, 11):
            [note] = notes
            assert note.startswith("akd-1: DRV.ACC: not written: ")


def test_a_change_that_was_not_begun_is_dropped() -> None:
    """Its thread has other work until after it was cancelled."""
    inbox: SimpleQueue[_waiting._Begun[Any]] = SimpleQueue()

    async def work() -> tuple[list[str], list[int]]:
        written: list[int] = []
        _waiting._IDLE.append(inbox)
        writing = asyncio.create_task(_waiting.asynchronous.change("akd-1", ["DRV.ACC"], lambda _: [], written.append, 1))
        await asyncio.sleep(0)
        writing.cancel()
        with pytest.raises(asyncio.CancelledError) as cancelled:
            await writing
        inbox.get(timeout=1).carry_out()
        return getattr(cancelled.value, "__notes__", []), written

    notes, written = run(work())
    assert written == []
    if sys.version_info >= (3, 11):
        assert notes == ["akd-1: DRV.ACC: not written: nothing was sent"]


def test_a_cancelled_motion_says_that_its_axis_is_stopped(world: World) -> None:
    async def work() -> list[str]:
        async with aio.network_of(world)["akd-1"].control(max_speed="600rpm") as axis:
            moving = asyncio.create_task(axis.run("300rpm", for_="100000s"))
            while abs(axis.speed or 0) < 250:
                await asyncio.sleep(0)
            moving.cancel()
            with pytest.raises(asyncio.CancelledError) as cancelled:
                await moving
            return getattr(cancelled.value, "__notes__", [])

    notes = run(work())
    if sys.version_info >= (3, 11):
        assert notes == ["akd-1: the axis is stopped along its ramp"]


def test_a_stop_is_not_cancelled(world: World) -> None:
    async def work() -> None:
        network = aio.network_of(world)
        with pytest.raises(InterruptedCall):
            async with network["akd-1"].control(max_speed="600rpm") as axis:
                await axis.run("300rpm")
                stopping = asyncio.create_task(network["akd-1"].stop())
                await asyncio.sleep(0)
                stopping.cancel()
                with pytest.raises(asyncio.CancelledError):
                    await stopping
                assert abs(axis.speed or 0) < 1

    run(work())


def test_errors_are_those_of_the_other_face(world: World) -> None:
    async def work() -> None:
        drive = aio.network_of(world)["akd-1"]
        with pytest.raises(UnknownParameter) as unknown:
            await drive.read("DRV.ACX")
        assert "DRV.ACC" in unknown.value.nearest
        await drive.write({"DRV.DEC": "100rpm/s"})
        async with drive.control(max_speed="600rpm") as axis:
            await axis.run("600rpm")
            with pytest.raises(NotReached):
                await axis.stop(timeout="100ms")

    run(work())


def test_ctrl_c_ends_a_program_and_stops_its_axis() -> None:
    program = """
import asyncio
from profidrive import Plant, aio
world = Plant.of("akd").start()
async def main():
    async with aio.network_of(world)["akd-1"].control(max_speed="600rpm") as axis:
        await axis.run("300rpm")
        print("runs", flush=True)
        await axis.run("300rpm", for_="10000000s")
try:
    asyncio.run(main())
except KeyboardInterrupt:
    print(abs(world["akd-1"].speed) < 1)
"""
    from .conftest import output_when_interrupted

    assert output_when_interrupted(program) == "True\n"


def test_the_generated_face_is_up_to_date() -> None:
    script = Path(__file__).parents[2] / "tools" / "py-sync"
    subprocess.run([sys.executable, script, "--check"], check=True, timeout=30)
