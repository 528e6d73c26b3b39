"""Several threads, or tasks of asyncio, that use a plant in virtual time at once."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence

import pytest

from profidrive import Plant, World, aio
from profidrive.errors import ExpectationFailed, InterruptedCall, ProfidriveError, SafetyError
from profidrive.events import ConnectionLost

from .conftest import output_when_interrupted

ROUNDS = 20


def start() -> World:
    """A plant whose drives are known to the client already."""
    world = Plant.of("akd", "akd").start()
    for drive in world.network.select("all"):
        drive.read("DRV.ACC")
    return world


def together(*works: Callable[[], object]) -> None:
    """Carries out each in a thread of its own, begun at the same time. One that waits for ever holds up nothing but its test."""
    begin = threading.Barrier(len(works))
    failed: list[BaseException] = []

    def carry_out(work: Callable[[], object]) -> None:
        begin.wait(30)
        try:
            work()
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=carry_out, args=(work,), daemon=True) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive(), "it waits for ever"
    assert failed == []


def reads(world: World, drive: str) -> Callable[[], None]:
    def work() -> None:
        for _ in range(ROUNDS):
            assert world.network[drive].read("DRV.ACC").value == 3000

    return work


def turning(world: World, drive: str) -> Sequence[float]:
    """How long the drive kept a speed above 290 rpm, each time: that is inside of one call."""
    samples = world.trace.of(drive).samples
    times, fast = samples["t"].astype("int64") / 1e9, abs(samples["speed"]) > 290
    changes = times[1:][fast[1:] != fast[:-1]]
    return [float(time) for time in changes[1::2] - changes[::2]]


def alone(work: Callable[[World], Callable[[], None]]) -> float:
    world = start()
    before = world.now
    work(world)()
    return world.now - before


def test_two_threads_that_wait_for_conditions_do_not_end_the_wait_of_each_other() -> None:
    world = Plant.of("akd", "akd").start()
    world["akd-1"].inject("fault=439")
    ends: list[float] = []

    def never() -> None:
        with pytest.raises(ExpectationFailed):
            world.run_until("akd-2", fault="any", timeout="50s")
        ends.append(world.now)

    def soon() -> None:
        for _ in range(ROUNDS):
            world.run_until("akd-1", fault=439, for_="1s", timeout="1s")

    together(never, soon)
    assert ends[0] >= 50


def test_two_threads_that_read_pass_the_time_of_their_reads() -> None:
    world = start()
    before = world.now
    together(reads(world, "akd-1"), reads(world, "akd-2"))
    assert world.now - before <= 2 * alone(lambda world: reads(world, "akd-1")) + 1e-9


def test_threads_that_move_and_read_take_the_time_that_they_take_alone() -> None:
    def moves(world: World, drive: str) -> Callable[[], None]:
        def work() -> None:
            for speed in (300, -600):
                with world.network[drive].control(max_speed="1000rpm") as axis:
                    assert axis.run(speed, for_="2s").reached

        return work

    one = start()
    moves(one, "akd-1")()
    expected = turning(one, "akd-1")
    world = start()
    together(moves(world, "akd-1"), moves(world, "akd-2"), reads(world, "akd-1"), lambda: world.run(for_="30s"))
    for drive in ("akd-1", "akd-2"):
        assert turning(world, drive) == pytest.approx(expected, abs=0.02), drive
        assert abs(world[drive].speed) < 1


def test_an_axis_keeps_its_connection_while_other_threads_wait_for_hours() -> None:
    world = start()
    stats = []

    def moves() -> None:
        with world.network["akd-1"].control(max_speed="1000rpm") as axis:
            axis.run("300rpm", for_="20s")
            stats.append(axis.stats)

    together(moves, lambda: world.run(for_=600), lambda: world.run(for_=600))
    [counted] = stats
    assert counted is not None
    assert counted.missed == 0
    assert world.now < 700


def test_a_thread_that_computes_holds_up_no_other() -> None:
    world = start()
    computed = threading.Event()

    def computes() -> None:
        world.network["akd-1"].read("DRV.ACC")
        # it is between two calls, as long as the other one likes
        assert computed.wait(30)
        world.network["akd-1"].read("DRV.ACC")

    def waits() -> None:
        world.run(for_="60s")
        computed.set()

    together(computes, waits)
    assert 60 < world.now < 62


def test_a_world_without_a_client_is_run_by_several_threads() -> None:
    world = Plant.of("akd").start()
    together(*[lambda: world.run(for_="10s")] * 3, lambda: world.network["akd-1"].read("DRV.ACC"))
    assert 10 <= world.now < 41


def test_tasks_that_read_at_once_pass_the_time_of_their_reads() -> None:
    world = start()

    async def work() -> list[object]:
        network = aio.network_of(world)
        calls = [network[drive].read("DRV.ACC") for drive in ("akd-1", "akd-2") for _ in range(ROUNDS)]
        return [reading.value for reading in await asyncio.gather(*calls)]

    for _ in range(10):
        before = world.now
        assert asyncio.run(work()) == [3000] * 2 * ROUNDS
        assert world.now - before <= 2 * alone(lambda world: reads(world, "akd-1")) + 1e-9


def test_a_stop_by_another_thread_ends_what_waits() -> None:
    world = start()
    outcomes: list[object] = []
    moving = threading.Event()

    def moves() -> None:
        try:
            with world.network["akd-1"].control(max_speed="1000rpm") as axis:
                axis.run("300rpm")
                moving.set()
                axis.run("300rpm", for_=10_000_000)
        except ProfidriveError as error:
            outcomes.append(type(error))

    def stops() -> None:
        assert moving.wait(30)
        reads(world, "akd-2")()
        world.network.stop_all()
        reads(world, "akd-2")()

    together(moves, stops)
    assert outcomes == [InterruptedCall]
    assert abs(world["akd-1"].speed) < 1


def test_threads_that_take_the_same_axis_do_not_end_each_others_connection() -> None:
    for _ in range(10):
        world = start()
        taken: list[str] = []

        def takes(world: World = world, taken: list[str] = taken) -> None:
            try:
                with world.network["akd-1"].control(max_speed="1000rpm") as axis:
                    taken.append("begins")
                    axis.run("300rpm", for_="500ms")
                    taken.append("ends")
            except SafetyError as error:
                assert error.rule == "control"

        together(takes, takes, takes)
        assert taken[:2] == ["begins", "ends"]
        assert taken in (["begins", "ends"], ["begins", "ends"] * 2, ["begins", "ends"] * 3)
        assert world.trace.only(ConnectionLost) == ()


def test_ctrl_c_while_a_program_ends_leaves_no_axis_of_several_networks_turning() -> None:
    program = """
import atexit, signal
from profidrive import Plant, _calls
worlds = [Plant.of("akd").start() for _ in range(2)]
atexit.register(lambda: print([abs(world["akd-1"].speed) < 1 for world in worlds]))
for world in worlds:
    drive = world.network["akd-1"]
    drive.write({"DRV.DEC": "2rpm/s"})
    drive.control(max_speed="600rpm", lease="100000s").__enter__().run("500rpm")
# as a network interface does that is opened
_calls.leave_at_exit()
signal.signal(signal.SIGALRM, signal.default_int_handler)
atexit.register(signal.setitimer, signal.ITIMER_REAL, 0.005)
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert ended.stdout == "[True, True]\n", ended.stderr


PLANT = """
import os, signal, threading
from profidrive import Plant
from profidrive.errors import MisuseError
world = Plant.of("akd").start()
network = world.network
drive = network["akd-1"]

def runs():
    while abs(axis.speed or 0) < 290:
        pass
    print("runs", flush=True)
"""


@pytest.mark.parametrize("call", ["axis.stop()", "axis.run(100)", "axis._axis.release(False)", "network.close()", "drive.stop()"])
def test_a_handler_of_a_signal_that_calls_its_axis_does_not_wait_for_itself(call: str) -> None:
    program = f"""{PLANT}
signal.signal(signal.SIGINT, lambda *_: {call})
try:
    with drive.control(max_speed="1000rpm") as axis:
        threading.Thread(target=runs, daemon=True).start()
        axis.run("300rpm", for_=30_000_000)
except Exception as error:
    print(type(error).__name__, abs(world["akd-1"].speed) < 1, flush=True)
"""
    assert output_when_interrupted(program) == "MisuseError True\n"


def test_a_copy_of_a_process_waits_for_no_thread_that_it_does_not_have() -> None:
    program = f"""{PLANT}
with drive.record("p922", every="1s") as recording, drive.control(max_speed="1000rpm") as axis:
    moving = threading.Thread(target=lambda: axis.run("300rpm", for_=30_000_000), daemon=True)
    moving.start()
    runs()
    child = os.fork()
    if child == 0:
        for call in (axis.stop, recording.stop, network.close, lambda: axis.speed, lambda: axis.stats):
            try:
                call()
            except MisuseError:
                continue
            os._exit(1)
        # as at the end of a copy that does not go on to the end of the block
        del axis, recording
        os._exit(7)
    _, status = os.waitpid(child, 0)
    print(os.waitstatus_to_exitcode(status), flush=True)
    network.stop_all()
    moving.join(20)
"""
    ended = subprocess.run([sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True, timeout=60)
    assert ended.stdout.splitlines() == ["runs", "7"], ended.stderr
