"""Drives as a client reaches them, over the network of a plant."""

from __future__ import annotations

import pickle

import pytest

from profidrive import Network, Plant
from profidrive.errors import PartialWrite, RefusedError, UnknownParameter, UnreachableError, UsageError
from profidrive.events import ParameterWritten, WrittenBy

from .conftest import output_when_interrupted


@pytest.fixture
def two() -> Plant:
    return Plant.of("akd", "vlt")


def test_reads_take_virtual_time_and_change_nothing(two: Plant) -> None:
    world = two.start()
    network = world.network
    assert world.now == 0
    drive = network["akd-1"]
    assert world.now == 0
    reading = drive.read("DRV.ACC")
    assert (reading.number, reading.value, reading.unit) == ("p2108", 3000, "rpm/s")
    assert 0 < world.now < 5
    several = drive.read(["p930", "DRV.DEC"])
    assert [reading.pnu for reading in several] == [930, 2115]
    assert network["vlt-1"].read("3-41").unit == "s"
    assert drive.status().state is not None
    assert world.trace.only(ParameterWritten) == ()


def test_code_under_test_runs_unchanged(two: Plant) -> None:
    def set_up_line(network: Network) -> None:
        network["akd-1"].write({"DRV.ACC": "5000rpm/s", "DRV.DEC": 4000})
        network["vlt-1"].write({"3-41": "4s"})

    world = two.start()
    set_up_line(world.network)
    assert world.network["akd-1"].read("DRV.ACC").value == pytest.approx(5000, abs=2)
    # the truth of the simulation agrees
    assert world["vlt-1"].read("3-41").value == 4
    written = world.trace.of("akd-1").only(ParameterWritten)
    assert [event.by for event in written] == [WrittenBy.RECORD] * 2


def test_a_hint_is_a_call(two: Plant) -> None:
    network = two.start().network
    with pytest.raises(UnreachableError) as absent:
        network["akd-9"].read("DRV.ACC")
    assert absent.value.hint == "network.scan() lists the devices that respond"
    with pytest.raises(UsageError) as wrong:
        network["akd-1"].write({"DRV.ACC": "5A"})
    assert wrong.value.hint == 'drive.describe("DRV.ACC") shows unit and limits'


def test_a_dry_run_writes_nothing(two: Plant) -> None:
    drive = two.start().network["akd-1"]
    report = drive.write({"DRV.ACC": 5000}, dry_run=True)
    assert (report.dry_run, report.changes[0].written) == (True, False)
    assert drive.read("DRV.ACC").value == 3000
    again = drive.write({"DRV.ACC": 5000})
    assert again.changes[0].written
    assert drive.write({"DRV.ACC": 5000}).changes[0].same


def test_refusals_and_mistakes_are_errors_with_their_numbers(two: Plant) -> None:
    drive = two.start().network["akd-1"]
    with pytest.raises(UnknownParameter) as unknown:
        drive.read("DRV.ACX")
    assert "DRV.ACC" in unknown.value.nearest
    with pytest.raises(UsageError, match="name an element"):
        drive.read("p947")
    assert len(drive.read(["p947"])) > 1
    with pytest.raises(UsageError):
        drive.write({"DRV.ACC": "5A"})
    with pytest.raises(RefusedError) as refused:
        drive.read("p4321")
    assert (refused.value.number, refused.value.pnu, refused.value.drive) == (0, 4321, "akd-1")
    assert pickle.loads(pickle.dumps(refused.value)).pnu == 4321
    with pytest.raises((RefusedError, PartialWrite, UsageError)):
        drive.write({"p930": 77})


def test_a_drive_that_is_not_there_or_not_connected_is_unreachable(two: Plant) -> None:
    world = two.start()
    with pytest.raises(UnreachableError, match="akd-9"):
        world.network["akd-9"].read("DRV.ACC")
    assert world.network["akd-1"].read("DRV.ACC").value == 3000
    world["akd-1"].inject("cable=pulled")
    begin = world.now
    with pytest.raises(UnreachableError, match="akd-1"):
        world.network["akd-1"].read("DRV.ACC")
    assert 1 < world.now - begin < 120
    world["akd-1"].inject("cable=plugged")
    assert world.network["akd-1"].read("DRV.ACC").value == 3000
    with pytest.raises(UsageError):
        world.network["Bad Name"].read("DRV.ACC")


def test_why_a_drive_does_not_run_is_one_sentence(two: Plant) -> None:
    world = two.start()
    world["akd-1"].inject("fault=439")
    world.run(for_="100ms")
    status = world.network["akd-1"].status()
    assert status.cause == "fault"
    assert "439" in status.sentence
    [fault] = world.network["akd-1"].faults().faults
    assert fault.number == 439


def test_a_world_runs_on_beside_its_network(two: Plant) -> None:
    def run() -> str:
        world = two.start(seed=5)
        early = world.run("1s")
        world.network["akd-1"].write({"DRV.ACC": 5000})
        assert early.end == 1.0
        assert early.only(ParameterWritten) == ()
        world.run(for_="3s")
        world["vlt-1"].inject("fault=14")
        world.run_until("vlt-1", fault=14, timeout="1s")
        assert world.network["vlt-1"].faults().faults[0].number == 14
        return world.trace.digest

    assert run() == run()


def test_ctrl_c_ends_a_call(two: Plant) -> None:
    program = (
        "import profidrive\n"
        "world = profidrive.Plant.of('akd').start()\n"
        "drive = world.network['akd-1']\n"
        "drive.read('DRV.ACC')\n"
        "try:\n"
        "    print('runs', flush=True)\n"
        "    world.run(for_=20_000_000)\n"
        "except KeyboardInterrupt:\n"
        "    print('ended', flush=True)\n"
        "print(drive.read('DRV.ACC').value)\n"
    )
    assert output_when_interrupted(program) == "ended\n3000.0\n"


@pytest.mark.seeds([7, 8])
def test_the_fixture_is_the_network_of_the_world(virtual_network: Network, request: pytest.FixtureRequest) -> None:
    assert virtual_network["akd-1"].read("DRV.ACC").value == 3000
    assert request.getfixturevalue("world").now > 0
