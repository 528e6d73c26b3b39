"""Drives over a cable: a program of Python at one end, `profidrive simulate` at the other."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from profidrive.events import Event, FaultRaised, Released, StateChanged

from .wire import Wire


@pytest.fixture
def wire() -> Iterator[Wire]:
    # names of sockets are short
    with tempfile.TemporaryDirectory() as folder, Wire(Path(folder)) as wire:
        yield wire


def is_released(event: Event) -> bool:
    return isinstance(event, Released)


RUNS = """
with drive.control(max_speed="600rpm", cycle="128ms", lease=2) as axis:
    axis.run("600rpm")
    say("runs")
"""
SLOW = 'drive.write({"DRV.DEC": "100rpm/s"})\n'


def test_a_network_is_opened_read_and_moved_as_a_plant_is(wire: Wire) -> None:
    simulation = wire.simulate()
    program = wire.python(
        """
from profidrive.types import State
with network:
    assert drive.read("DRV.ACC").value == 3000
    assert drive.write({"DRV.DEC": "5000rpm/s"}).changes[0].written
    with drive.control(max_speed="600rpm", cycle="128ms") as axis:
        moved = axis.run("600rpm", for_="300ms")
        assert moved.reached and axis.stats.received > 3
        assert axis.state is State.S4
    try:
        drive.read("DRV.ACX")
    except UnknownParameter as error:
        say(error.nearest[0], threading.active_count())
try:
    drive.read("DRV.ACC")
except MisuseError as error:
    say(error)
"""
    )
    assert program.end() == (0, ["DRV.ACC 1", "the network is closed"])
    operation = simulation.wait_for_state(4)
    simulation.wait_for(is_released, after=operation.time)


@pytest.mark.parametrize("signals", [1, 2, 3])
def test_ctrl_c_ramps_down_then_stops_quickly_then_ends_the_wait(wire: Wire, signals: int) -> None:
    simulation = wire.simulate()
    program = wire.python(
        """
drive.write({"DRV.DEC": "100rpm/s"})

def watch():
    while (axis.speed or 0) < 590:
        time.sleep(0.01)
    say("runs")

try:
    with drive.control(max_speed="600rpm", cycle="128ms") as axis:
        # the program ends without it, where the axis does not get that far
        threading.Thread(target=watch, daemon=True).start()
        try:
            axis.run("600rpm", for_=60)
        finally:
            say(f"{abs(axis.speed):.0f} rpm")
except KeyboardInterrupt:
    say("interrupted")
"""
    )
    assert program.line() == "runs"
    for _ in range(signals):
        sent = simulation.now()
        program.interrupt()
        # requests within a second count as one
        time.sleep(1.2)
    assert program.end() == (0, ["0 rpm", "interrupted"])
    released = simulation.wait_for(is_released)
    # the ramp takes 6 s, the quick stop far less
    assert (released.time - sent > 5) == (signals == 1)
    assert not any(isinstance(event, FaultRaised) for event in simulation.events)


def test_a_hung_program_loses_its_axis(wire: Wire) -> None:
    simulation = wire.simulate()
    program = wire.python(RUNS + "    time.sleep(60)\n")
    assert program.line() == "runs"
    operation = simulation.wait_for_state(4)
    simulation.wait_for_state(2, after=operation.time)
    assert program.process.poll() is None
    # its next call says why
    program.interrupt()
    code, _ = program.end()
    assert code != 0
    simulation.wait_for(is_released)


def test_a_killed_program_leaves_the_stop_to_the_drive(wire: Wire) -> None:
    simulation = wire.simulate()
    program = wire.python(RUNS + "    time.sleep(60)\n")
    assert program.line() == "runs"
    operation = simulation.wait_for_state(4)
    program.process.kill()
    fault = simulation.wait_for(lambda event: isinstance(event, FaultRaised), after=operation.time)
    assert isinstance(fault, FaultRaised)
    assert fault.fault.number == 702
    simulation.wait_for_state(1, after=operation.time)


KILLED = """
def kill(frame, event, _):
    global lines
    if frame.f_code.co_filename != "script":
        return None
    if event == "line":
        lines -= 1
        if lines < 0:
            os.kill(os.getpid(), signal.SIGKILL)
    return kill

script = '''
drive.write({"DRV.ACC": "5000rpm/s"}, beside_controller=True)
with drive.control(max_speed="600rpm", cycle="128ms") as axis:
    axis.ack()
    axis.run("300rpm")
    axis.run("-300rpm", for_="200ms")
    axis.run("300rpm")
drive.status()
'''
sys.settrace(kill)
exec(compile(script, "script", "exec"))
"""


def test_a_script_that_is_killed_at_any_line_leaves_its_axis_to_the_drive_which_stops(wire: Wire) -> None:
    simulation = wire.simulate()
    codes = []
    for lines in range(10):
        program = wire.python(f"lines = {lines}\n{KILLED}")
        codes.append(program.end()[0])
        states = [event for event in simulation.events if isinstance(event, StateChanged)]
        if states and states[-1].new == 4:
            simulation.wait_for_state(1, after=states[-1].time)
        if codes[-1] == 0:
            break
    assert codes == [-9] * (len(codes) - 1) + [0]
    assert len(codes) > 6
    raised = [event.fault.number for event in simulation.events if isinstance(event, FaultRaised)]
    assert set(raised) == {702}, "of those that were killed while it turned"


FORGOTTEN = """
axis = drive.control(max_speed="600rpm", cycle="128ms").__enter__()
axis.run("600rpm")
"""
CRASH = """
def work():
    with drive.control(max_speed="600rpm", cycle="128ms") as axis:
        axis.run("600rpm")
        raise RuntimeError("in another thread")

threading.excepthook = lambda failed: say(failed.exc_value)
worker = threading.Thread(target=work)
worker.start()
worker.join(15)
"""


@pytest.mark.parametrize(
    ("ending", "expected"),
    [
        pytest.param(FORGOTTEN, (0, []), id="end"),
        pytest.param(FORGOTTEN + "sys.exit(3)", (3, []), id="exit"),
        pytest.param(FORGOTTEN + "raise RuntimeError", (1, []), id="exception"),
        pytest.param(FORGOTTEN + "network.close()", (0, []), id="close"),
        pytest.param(CRASH, (0, ["in another thread"]), id="thread"),
    ],
)
def test_however_a_program_ends_the_axis_is_stopped_and_released(wire: Wire, ending: str, expected: tuple[int, list[str]]) -> None:
    simulation = wire.simulate()
    program = wire.python(ending)
    assert program.end() == expected
    operation = simulation.wait_for_state(4)
    simulation.wait_for_state(2, after=operation.time)
    simulation.wait_for(is_released, after=operation.time)
    assert not any(isinstance(event, FaultRaised) for event in simulation.events)


def test_a_stop_comes_from_any_thread_while_another_one_waits(wire: Wire) -> None:
    wire.simulate()
    program = wire.python(
        """
for stop in (network.stop_all, drive.stop):
    with drive.control(max_speed="600rpm", cycle="128ms") as axis:
        other = threading.Timer(2, stop)
        other.start()
        try:
            axis.run("600rpm", for_=60)
        except InterruptedCall as error:
            say(abs(axis.speed) < 1, error.motion.reached)
        other.join(15)
"""
    )
    assert program.end() == (0, ["True True"] * 2)


def test_a_lost_connection_says_what_the_drive_does_and_the_drive_is_usable_again(wire: Wire) -> None:
    wire.simulate()
    program = wire.python(
        """
try:
    with drive.control(max_speed="600rpm", cycle="128ms") as axis:
        axis.run("600rpm")
        say("runs")
        axis.run("300rpm", for_=60)
except ConnectionLost as error:
    say(error.drive, error.drive_continues)
sys.stdin.readline()
deadline = time.monotonic() + 10
while True:
    try:
        say(drive.read("DRV.ACC").value)
        break
    except UnreachableError:
        assert time.monotonic() < deadline
with drive.control(max_speed="600rpm", cycle="128ms") as axis:
    axis.ack()
    say(axis.run("600rpm", for_="100ms").reached)
"""
    )
    assert program.line() == "runs"
    wire.run("ip", "link", "set", "dev0", "down")
    assert program.line() == "akd-1 False"
    wire.run("ip", "link", "set", "dev0", "up")
    assert program.process.stdin is not None
    program.process.stdin.write("\n")
    program.process.stdin.flush()
    assert program.end() == (0, ["3000.0", "True"])


def test_a_copy_of_a_process_has_no_network(wire: Wire) -> None:
    wire.simulate()
    program = wire.python(
        """
recording = drive.record("DRV.ACC", every="1s")
with recording, drive.control(max_speed="600rpm", cycle="128ms") as axis:
    axis.run("600rpm")
    child = os.fork()
    if child == 0:
        calls = drive.stop, axis.stop, network.close, recording.stop, lambda: axis.run(1), lambda: axis.speed, lambda: axis.stats
        for call in calls:
            try:
                call()
            except MisuseError:
                pass
            else:
                os._exit(1)
        os._exit(7)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    say(axis.run("300rpm", for_="100ms").reached)
"""
    )
    assert program.end() == (0, ["True"])


def test_raw_sockets_need_a_permission_and_udp_alone_does_not(wire: Wire) -> None:
    wire.simulate()
    program = """
import profidrive
from profidrive.errors import PermissionMissing, UnsupportedError, UnreachableError
try:
    profidrive.open("ctl0")
except PermissionMissing as error:
    print(isinstance(error, PermissionError), "CAP_NET_RAW" in str(error.hint) or "cap_net_raw" in str(error.hint))
with profidrive.open(ip=True) as network:
    drive = network["192.168.77.50"]
    print(drive.read("DRV.ACC").value)
    try:
        with drive.control(max_speed=100):
            pass
    except UnreachableError as error:
        print("raw Ethernet" in str(error))
"""
    output, _ = wire.start(["unshare", "--user", "python", "-c", program]).communicate(timeout=30)
    assert output.splitlines() == ["True True", "3000.0", "True"]


def test_a_test_of_real_drives_reads_unless_motion_is_allowed(wire: Wire, tmp_path: Path) -> None:
    wire.simulate()
    tests = tmp_path / "test_drives.py"
    tests.write_text(
        """
import pytest
from profidrive.errors import SafetyError

def test_reads(profidrive_network, request):
    drive = profidrive_network["akd-1"]
    assert drive.read("DRV.ACC").value == 3000
    assert drive.write({"DRV.ACC": 4000}, dry_run=True).dry_run
    drive.stop()
    if request.config.getoption("--profidrive-allow-motion"):
        return
    for change in (lambda: drive.write({"DRV.ACC": 4000}), drive.ack, drive.control(max_speed=10).__enter__,
                   lambda: profidrive_network.set_name("akd-1", "other")):
        with pytest.raises(SafetyError) as refused:
            change()
        assert refused.value.rule == "read_only"

@pytest.mark.moves_axis
def test_moves(profidrive_network):
    with profidrive_network["akd-1"].control(max_speed=100, cycle="128ms") as axis:
        assert axis.run(60, for_="100ms").reached
"""
    )

    def outcome(*options: str) -> str:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tests), *options]
        output, _ = wire.start(command).communicate(timeout=60)
        return output.splitlines()[-1]

    assert outcome().startswith("2 skipped")
    assert outcome("--profidrive-interface", "ctl0").startswith("1 passed, 1 skipped")
    assert outcome("--profidrive-interface", "ctl0", "--profidrive-allow-motion").startswith("2 passed")


def test_a_plant_is_served_in_a_block_for_a_controller(wire: Wire, tmp_path: Path) -> None:
    program = wire.start(
        [
            sys.executable,
            "-W",
            "error",
            "-c",
            """
from datetime import datetime, timezone
import numpy
import profidrive
from profidrive.errors import *
from profidrive.events import FaultRaised, Injected, Sample
from profidrive.types import State

plant = profidrive.Plant.from_toml('[[drive]]\\nname = "akd-1"\\nip = "192.168.77.50/24"')
plant["akd-1"].inject("warning=107")
with plant.serve("dev0") as served, profidrive.open("ctl0", timeout="5s") as network:
    drive = network["akd-1"]
    with drive.record("DRV.ACC", every="50ms") as recording:
        with drive.control(max_speed="600rpm", cycle="128ms") as axis:
            assert axis.run("300rpm", for_="500ms").reached
            axis.run("300rpm")
            reached = served.wait_until("akd-1", speed="290rpm..310rpm", for_="50ms", timeout="5s")
            assert isinstance(reached, Sample)
            turning = served["akd-1"]
            assert (turning.state, turning.connected, turning.moving) == (State.S4, True, True)
            assert abs(turning.speed - 300) < 20 and turning.faults == ()
    assert len(recording) > 5 and not recording.grows
    now, wall = numpy.datetime64(datetime.now(timezone.utc).replace(tzinfo=None), "ns"), recording["wall"]
    assert abs(now - wall[-1]) < numpy.timedelta64(60, "s") and (numpy.diff(wall) >= numpy.timedelta64(0)).all()
    rest = served.wait_until("akd-1", connected=False, moving=False, timeout="5s")
    try:
        served.wait_until("akd-1", state="S4", timeout="50ms")
    except ExpectationFailed as error:
        assert error.results[0].drive == "akd-1"
    try:
        served.wait_until("akd-1", parameter={"DRV.ACC": ">3rpm/s"}, timeout="50ms")
    except UsageError as error:
        assert "parameter" in str(error)
    served["akd-1"].inject("fault=439", for_=None)
    raised = served.wait_until("akd-1", fault=439, timeout="5s")
    assert isinstance(raised, FaultRaised) and raised.time > rest.time
    assert [fault.number for fault in served["akd-1"].faults] == [439]
    assert drive.status().faults != ()
    assert [event.fault.number for event in served["akd-1"].events if isinstance(event, FaultRaised)] == [439]
    assert len([event for event in served.events if isinstance(event, Injected)]) == 2
    first, trace = served.trace, served.trace
    assert [event.fault.number for event in trace.only(FaultRaised)] == [439]
    # the axis has turned, and stands since
    speeds = trace.of("akd-1").samples["speed"]
    assert speeds.max() > 290 and abs(trace.at(trace.end)["akd-1"].speed) < 1
    trace.expect({"always": True, "drive": "akd-1", "speed": "-20rpm..330rpm"}, {"within": "60s", "drive": "akd-1", "fault": 439})
    assert trace.digest == first.digest and trace.cut is None and trace.end > first.end > 0.5
    try:
        served["akd-1"].inject("load=x")
    except UsageError as error:
        print(error)
try:
    plant.serve("none0").__enter__()
except UnreachableError as error:
    print("none0" in str(error))
""",
        ]
    )
    output, _ = program.communicate(timeout=30)
    assert program.returncode == 0, output
    assert output.splitlines()[-1] == "True"


def test_the_fixture_serves_the_plant_of_a_test(wire: Wire, tmp_path: Path) -> None:
    tests = tmp_path / "test_served.py"
    (tmp_path / "line.toml").write_text('[[drive]]\nname = "akd-1"\nip = "192.168.77.50/24"')
    tests.write_text(
        """
import profidrive
import pytest

@pytest.mark.plant("line.toml")
def test_a_controller(served_plant):
    with profidrive.open("ctl0") as network:
        assert network["akd-1"].read("DRV.ACC").value == 3000
    assert served_plant.drives == ("akd-1",)
"""
    )

    def outcome(*options: str) -> str:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tests), *options]
        output, _ = wire.start(command).communicate(timeout=60)
        return output.splitlines()[-1]

    assert outcome().startswith("1 skipped")
    assert outcome("--profidrive-interface", "dev0").startswith("1 passed")
