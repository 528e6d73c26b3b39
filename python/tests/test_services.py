"""Searching, naming, describing, saving and restoring, one drive and many."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pint
import pytest

from profidrive import Backup, Plant, World
from profidrive.errors import (
    DriveGroupError,
    DriveTimeout,
    LocalError,
    ProfidriveError,
    RefusedError,
    SafetyError,
    UnknownParameter,
    UnreachableError,
    UnsupportedError,
    UsageError,
)
from profidrive.events import ParameterWritten
from profidrive.units import to_pint

PRESS = Path(__file__).parents[2] / "examples" / "plants" / "press.toml"


@pytest.fixture
def world() -> World:
    return Plant.of("akd", "akd", "vlt").start()


def test_a_scan_names_every_station(world: World) -> None:
    found = world.network.scan(wait="1s")
    names = [one.name for one in found.stations]
    assert sorted(name or "" for name in names) == ["akd-1", "akd-2", "vlt-1"]
    assert {one.vendor for one in found.stations} == {"Kollmorgen", "Danfoss"}
    assert world.trace.only(ParameterWritten) == ()


def test_a_selection_works_on_all_its_drives_at_once(world: World) -> None:
    drives = world.network.select("akd-*")
    assert drives.names == ("akd-1", "akd-2")
    assert (len(drives), drives[1].name, drives[:1].names) == (2, "akd-2", ("akd-1",))
    readings = drives.read("DRV.ACC")
    assert {name: reading.value for name, reading in readings.items()} == {"akd-1": 3000, "akd-2": 3000}
    assert all(report.changes[0].written for report in drives.write({"DRV.ACC": 5000}).values())
    assert drives.read(["DRV.ACC", "p922"])["akd-2"][0].value == pytest.approx(5000, abs=2)
    assert set(world.network.select("akd-1", "vlt-1").status()) == {"akd-1", "vlt-1"}
    with pytest.raises(DriveGroupError) as failed:
        world.network.select("all").read("DRV.ACC")
    assert list(failed.value.errors) == ["vlt-1"]
    assert isinstance(failed.value.errors["vlt-1"], UnknownParameter)
    assert set(failed.value.results) == {"akd-1", "akd-2"}
    assert "vlt-1: " in str(failed.value)
    with pytest.raises(DriveGroupError) as missing:
        world.network.select("akd-1,akd-9")
    assert isinstance(missing.value.errors["akd-9"], UnreachableError)
    with pytest.raises(UsageError) as alone:
        world.network.select("@line1")
    assert alone.value.hint == 'open(.., machine="machine.toml")'


def test_what_cannot_be_read_of_a_list_is_collected(world: World) -> None:
    drive = world.network["akd-1"]
    names = ["DRV.ACC", "DRV.ACX", "p922"]
    with pytest.raises(UnknownParameter):
        drive.read(names)
    found = drive.read(names, errors="collect")
    assert [one.number for one in found] == ["p2108", "p0922"]
    [unknown] = found.errors
    assert isinstance(unknown, UnknownParameter)
    assert (unknown.drive, "DRV.ACC" in unknown.nearest) == ("akd-1", True)
    assert drive.read(names[::2]).errors == ()
    copy = pickle.loads(pickle.dumps(found))
    assert (copy, str(copy.errors[0])) == (found, str(unknown))
    refused = drive.read(["p922", "p60000"], errors="collect")
    assert [type(error) for error in refused.errors] in ([RefusedError], [UnknownParameter])
    by_drive = world.network.select("all").read(["DRV.ACC"], errors="collect")
    assert [len(readings.errors) for readings in by_drive.values()] == [0, 0, 1]
    with pytest.raises(UsageError, match="collect"):
        drive.read(names, errors="ignore")  # type: ignore[call-overload]


def test_a_read_has_its_own_timeout(world: World) -> None:
    drive = world.network["akd-1"]
    drive.read("DRV.ACC")
    world["akd-1"].inject("cable=pulled")
    for timeout, most in (("300ms", 1.0), (2, 4.0)):
        begin = world.now
        with pytest.raises(DriveTimeout) as late:
            drive.read("DRV.ACC", timeout=timeout)
        assert isinstance(late.value, TimeoutError)
        assert (late.value.drive, world.now - begin < most) == ("akd-1", True)
    with pytest.raises(DriveGroupError) as some:
        world.network.select("akd-2", "vlt-1")[:].read("p922", timeout="1us")
    assert {type(error) for error in some.value.errors.values()} == {DriveTimeout}
    with pytest.raises(UsageError):
        drive.read("DRV.ACC", timeout="soon")


def test_reports_are_what_they_are_named_for(world: World) -> None:
    network = world.network
    found = network.scan(wait="1s")
    assert len(found) == 3
    assert found[0] in list(found)
    status = network["akd-1"].status()
    assert not status
    assert not status.runs
    with network["akd-1"].control(max_speed="300rpm") as axis:
        axis.run("300rpm")
        assert network["akd-1"].status()


def test_quantities_of_pint(world: World) -> None:
    units: pint.UnitRegistry[Any] = pint.UnitRegistry()
    reading = world.network["akd-1"].read("DRV.ACC")
    assert reading.to_pint(units).to("rad/s**2").magnitude == pytest.approx(314.159, abs=0.01)
    assert world["akd-1"].read("DRV.ACC").to_pint(units).magnitude == 3000
    assert to_pint(2, "Nm/A", units).to("N*m/A").magnitude == 2
    assert to_pint(0.5, "rev", units).to("degree").magnitude == pytest.approx(180)
    assert to_pint(50, "%", units).to("dimensionless").magnitude == pytest.approx(0.5)
    assert to_pint(7, "", units).dimensionless
    written = world.network["akd-1"].write({"DRV.ACC": reading.to_pint(units)}, dry_run=True)
    assert not written.changes[0].written
    for value, unit in (("text", "rpm"), (1.0, "electrical deg"), (None, "A")):
        with pytest.raises(UsageError):
            to_pint(value, unit, units)


def test_a_drive_that_is_lost_does_not_fail_the_others(world: World) -> None:
    drives = world.network.select("akd-*")
    world["akd-2"].inject("cable=pulled")
    begin = world.now
    with pytest.raises(DriveGroupError) as failed:
        drives.read("DRV.ACC")
    assert isinstance(failed.value.errors["akd-2"], UnreachableError)
    assert list(failed.value.results) == ["akd-1"]
    assert world.now - begin < 60
    world["akd-2"].inject("cable=plugged")
    assert set(drives.stop()) == {"akd-1", "akd-2"}


def test_a_station_gets_a_name_and_an_address(world: World) -> None:
    network = world.network
    assert network.set_name("akd-1", "press-1", dry_run=True).old == "akd-1"
    assert network["akd-1"].read("p922").value == 1
    assert network.set_name("akd-1", "press-1").name == "press-1"
    assert network["press-1"].read("p922").value == 1
    with pytest.raises(UnreachableError):
        network["akd-1"].read("p922")
    with pytest.raises(UsageError) as bad:
        network.set_name("press-1", "Press_1")
    assert bad.value.hint == "perhaps press-1"
    with pytest.raises(ProfidriveError, match="taken"):
        network.set_name("press-1", "akd-2")
    address = network["press-1"].identity().station.ip
    assert address is not None
    prefix = address.rpartition(".")[0]
    assert network.set_ip("press-1", f"{prefix}.99/16").ip == f"{prefix}.99"
    assert network["press-1"].read("p922").value == 1
    for wrong in (f"{prefix}.99", f"{prefix}.999/16", "x"):
        with pytest.raises(UsageError):
            network.set_ip("press-1", wrong)
    begin = world.now
    network.blink("press-1", for_="2s")
    assert world.now - begin == pytest.approx(2, abs=0.5)


def test_parameters_are_described_and_listed(world: World) -> None:
    drive = world.network["akd-1"]
    described = drive.describe("DRV.ACC")
    assert described.parameter is not None
    assert (described.parameter.name, described.parameter.unit) == ("DRV.ACC", "rpm/s")
    assert described.values[0].value == 3000
    assert "DRV.ACC" in {one.name for one in drive.parameters("drv.acc").parameters}
    listed = drive.parameters("p2108", values=True)
    assert [(one.name, one.value) for one in listed.values] == [("DRV.ACC", 3000)]
    with pytest.raises(UnsupportedError):
        drive.parameters("nothing like it")
    assert drive.identity().model == "AKD"


def test_settings_are_saved_compared_and_restored(world: World, tmp_path: Path) -> None:
    drive = world.network["akd-1"]
    saved = drive.backup()
    assert saved.missing is None
    file = tmp_path / "akd-1.backup"
    saved.save(file)
    assert Backup.load(file) == saved
    with pytest.raises(LocalError):
        saved.save(file)
    assert drive.diff(saved).differences == ()
    drive.write({"DRV.ACC": "5000rpm/s", "DRV.DEC": "4000rpm/s"})
    differences = drive.diff(file).differences
    assert [one.name for one in differences] == ["DRV.ACC", "DRV.DEC"]
    assert [one.name for one in drive.diff(world.network["akd-2"]).differences] == ["DRV.ACC", "DRV.DEC"]
    assert [one.name for one in drive.diff(file, only="DRV.A*").differences] == ["DRV.ACC"]
    assert [one.name for one in drive.diff(file, only=["p922", "DRV.DEC"]).differences] == ["DRV.DEC"]
    compared = world.network.select("akd-*").diff(saved, only="DRV.DEC")
    assert {name: len(report.differences) for name, report in compared.items()} == {"akd-1": 1, "akd-2": 0}
    with pytest.raises(UsageError, match=r"DVR\.ACC matches no setting"):
        drive.diff(file, only="DVR.ACC")
    planned = drive.plan_restore(file, only=["DRV.ACC"])
    assert planned.dry_run
    assert [change.name for change in planned.changes] == ["DRV.ACC"]
    assert drive.read("DRV.ACC").value == pytest.approx(5000, abs=2)
    restored = drive.restore(file, only="DRV.ACC")
    assert restored.complete
    assert restored.way_back == f"{file}.before-1"
    assert drive.read("DRV.ACC").value == 3000
    assert [one.name for one in drive.diff(saved).differences] == ["DRV.DEC"]
    # the way back is a backup too
    drive.restore(restored.way_back, way_back=tmp_path / "again")
    assert drive.read("DRV.ACC").value == pytest.approx(5000, abs=2)
    with pytest.raises(SafetyError):
        world.network["vlt-1"].restore(saved, way_back=tmp_path / "never")
    assert not (tmp_path / "never").exists()
    with pytest.raises(UsageError):
        drive.diff(Backup("nothing of the kind"))
    assert set(world.network.select("akd-*").backup()) == {"akd-1", "akd-2"}


def test_a_drive_with_a_controller_is_not_restored_and_faults_are_acknowledged(world: World, tmp_path: Path) -> None:
    drive = world.network["akd-1"]
    saved = drive.backup()
    drive.write({"DRV.ACC": 5000})
    with drive.control(max_speed=100), pytest.raises((SafetyError, RefusedError)):
        drive.restore(saved, way_back=tmp_path / "never")
    world["akd-1"].inject("fault=439")
    world.run(for_="100ms")
    acknowledged = drive.ack()
    assert acknowledged.acknowledged
    assert drive.faults().faults == ()
    assert drive.ack().acknowledged is False


def test_a_drive_of_a_controller_is_written_by_consent_only() -> None:
    world = Plant.from_file(PRESS).start()
    world.run(until="3s")
    drive = world.network["press-1"]
    with pytest.raises(SafetyError, match="is not written") as refused:
        drive.write({"DRV.ACC": "4000rpm/s"})
    assert (refused.value.rule, refused.value.owner) == ("control", "plc-1")
    assert "beside_controller=True" in str(refused.value.hint)
    planned = drive.write({"DRV.ACC": "4000rpm/s"}, dry_run=True).controller
    assert planned is not None
    assert planned.name == "plc-1"
    assert world.trace.only(ParameterWritten) == ()
    drive.write({"DRV.ACC": "4000rpm/s"}, beside_controller=True)
    assert drive.read("DRV.ACC").value == pytest.approx(4000, abs=2)
    with pytest.raises(DriveGroupError) as failed:
        world.network.select("all").write({"DRV.ACC": "3000rpm/s"})
    assert "press-1" in failed.value.errors


def test_the_own_axis_is_no_other_controller(world: World) -> None:
    drive = world.network["akd-1"]
    with drive.control(max_speed="600rpm") as axis:
        axis.run("100rpm")
        drive.write({"DRV.ACC": "4000rpm/s"})
    assert drive.read("DRV.ACC").value == pytest.approx(4000, abs=2)


def test_signals_are_recorded_as_a_table(world: World, tmp_path: Path) -> None:
    drives = world.network.select("akd-*")
    recording = drives.record(["DRV.ACC", "p922"], for_="1s", every="100ms")
    assert recording.columns[:4] == ("t", "wall", "drive", "gap")
    assert recording.units["DRV.ACC"] == "rpm/s"
    assert [one.drive for one in recording.drives] == ["akd-1", "akd-2"]
    assert all(9 <= one.rows <= 11 and one.missed == 0 for one in recording.drives)
    assert set(recording["DRV.ACC"]) == {3000.0}
    recording.write(str(tmp_path / "run.csv"))
    recording.draw(tmp_path / "run.svg", "two drives")
    assert (tmp_path / "run.csv").read_text().count("\n") > 18
    cyclic = world.network["akd-1"].record("all", for_="1s", every="cycle")
    assert len(cyclic) > 50
    assert "ZSW1" in cyclic.columns
    assert len(world.network["akd-1"].record("ZSW1", for_="1s", every="cycle", max_rows=7)) == 7
    with pytest.raises(UsageError):
        drives.record([], for_=1)
    with pytest.raises(ProfidriveError, match="NOTHING"):
        drives.record("NOTHING", for_=1)
    pulled = {"drive.akd-2.event": [{"at": "5s", "do": "cable=pulled"}]}
    network = Plant.of("akd", "akd").with_changes(pulled).start().network
    lost = network.select("akd-*").record("DRV.ACC", for_="60s", every="100ms").drives
    assert (lost[0].missed, lost[0].outages) == (0, 0)
    assert lost[1].missed > 100


def test_a_recording_without_a_time_grows_beside_other_calls(world: World, tmp_path: Path) -> None:
    drives = world.network.select("akd-*")
    with drives.record(["p922", "DRV.ACC"], every="100ms") as recording:
        assert recording.grows
        world.run(for_="1s")
        first = len(recording)
        assert first >= 18
        drives.write({"DRV.ACC": 5000})
        with drives[0].control(max_speed="100rpm") as axis:
            axis.run("60rpm", for_="1s")
        assert len(recording) > first
        assert len(recording["DRV.ACC"]) == len(recording)
    assert not recording.grows
    rows = len(recording)
    world.run(for_="1s")
    assert len(recording) == rows
    assert {3000.0, 5000.0} <= set(recording["DRV.ACC"])
    recording.stop()
    recording.write(str(tmp_path / "run.parquet"))
    again = drives.record("p922", every="100ms")
    world["akd-2"].inject("cable=pulled")
    world.run(for_="20s")
    gaps = again.gaps()
    assert gaps
    assert {gap.drive for gap in gaps} == {"akd-2"}
    assert gaps[0].time < 20
    world.network.close()
    again.stop()


def test_a_recording_in_a_plant_is_the_same_each_time() -> None:
    def recorded() -> list[tuple[object, ...]]:
        world = Plant.of("akd").start()
        with world.network["akd-1"].record("all", every="cycle") as recording:
            world.run(for_="1s")
        columns = [name for name in recording.columns if name != "wall"]
        return list(zip(*(recording[name].tolist() for name in columns), strict=True))

    first = recorded()
    assert len(first) > 50
    assert first == recorded()
