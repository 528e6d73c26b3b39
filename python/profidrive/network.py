"""Drives as a client reaches them: on a network, or on that of a plant in virtual time."""

from __future__ import annotations

import atexit
import ipaddress
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Generic, Literal, NamedTuple, TypeVar, overload

from profidrive import _profidrive
from profidrive._values import optional_span, span, value_text
from profidrive.axis import Control
from profidrive.backup import Backup
from profidrive.errors import DriveGroupError, LocalError, ProfidriveError, UsageError
from profidrive.recording import Recording
from profidrive.reports import (
    BlinkReport,
    DescribeReport,
    DiffReport,
    FaultsReport,
    InfoReport,
    IpReport,
    ListReport,
    MotionReport,
    NameReport,
    Parameter,
    ParametersReport,
    RestoreReport,
    ScanReport,
    StatusReport,
    StopReport,
    WriteReport,
)
from profidrive.types import Duration, Path, Value

T = TypeVar("T")

_AT_EXIT = 10.0
"""Seconds that a program which ends waits for its axes."""


def open(interface: str | None = None, *, ip: bool = False, read_only: bool = False, timeout: Duration | None = None) -> Network:
    """Opens a network.

    Args:
        interface: a network interface such as `eth0`, or the serial line of a drive such as `fc:ttyUSB0/1`. When None it is that
            of the environment variable `PROFIDRIVE_INTERFACE`, else the only one that is up.
        ip: open UDP alone: drives are given by their IP addresses, can be read, written and stopped, and need no permission.
            Where no interface is named and raw sockets are not permitted, it is that anyway.
        read_only: refuse every call that changes something; a stop is always permitted.
        timeout: time for a drive to answer the first request of a call; when None the usual 10 s.

    Raises:
        PermissionMissing: when raw sockets are required and not permitted (CAP_NET_RAW).
        UnreachableError: when the interface is not there or is down.
    """
    named = interface or os.environ.get("PROFIDRIVE_INTERFACE") or None
    opened = Network(_profidrive.open(named, ip, read_only, optional_span(timeout)))
    atexit.unregister(_leave_all)
    atexit.register(_leave_all)
    return opened


def _leave_all() -> None:
    """No axis is left under control when the program ends, wherever that is."""
    _profidrive.leave_all(_AT_EXIT)


class Call(NamedTuple, Generic[T]):
    """A call for a drive, with what makes its result of the document."""

    verb: _profidrive.Verb
    made: Callable[[Any], T]


def read_all(names: Sequence[str]) -> Call[tuple[Parameter, ...]]:
    return Call(_profidrive.Verb.read(list(names)), lambda data: ParametersReport._of(data).parameters)


def read_one(name: str) -> Call[Parameter]:
    def one(data: Any) -> Parameter:
        report = ParametersReport._of(data)
        if len(report.parameters) != 1:
            message = f"{name} has {len(report.parameters)} values: name an element, such as p922[0], or give a list"
            raise UsageError(message, drive=report.drive)
        return report.parameters[0]

    return Call(_profidrive.Verb.read([name]), one)


def write(values: Mapping[str, Value], save: bool, dry_run: bool) -> Call[WriteReport]:
    pairs = [(name, value_text(value)) for name, value in values.items()]
    return Call(_profidrive.Verb.write(pairs, save, dry_run), WriteReport._of)


def status() -> Call[StatusReport]:
    return Call(_profidrive.Verb.status(), StatusReport._of)


def faults(history: bool) -> Call[FaultsReport]:
    return Call(_profidrive.Verb.faults(history), FaultsReport._of)


def acknowledge(by_parameter: bool) -> Call[MotionReport]:
    return Call(_profidrive.Verb.ack(by_parameter), MotionReport._of)


def stop(disable: bool) -> Call[StopReport]:
    return Call(_profidrive.Verb.stop(disable), StopReport._of)


def backup() -> Call[Backup]:
    return Call(_profidrive.Verb.backup(), lambda data: Backup(data["text"], missing=data["missing"]))


def diff(other: Backup, name: str) -> Call[DiffReport]:
    return Call(_profidrive.Verb.diff(other.text, name), DiffReport._of)


def restore(
    settings: Backup, name: str, only: Sequence[str], save: bool, dry_run: bool, way_back: Path | None
) -> Call[RestoreReport]:
    kept = None if way_back is None else os.fspath(way_back)
    chosen = [only] if isinstance(only, str) else list(only)
    return Call(_profidrive.Verb.restore(settings.text, name, chosen, save, dry_run, kept), RestoreReport._of)


def _recorded(
    network: _profidrive.Network,
    names: list[str],
    signals: str | Sequence[str],
    time: Duration | None,
    every: Duration | Literal["cycle"],
    most: int,
) -> Recording:
    wanted = [signals] if isinstance(signals, str) else list(signals)
    interval = None if every == "cycle" else span(every)
    return Recording(network.record(names, wanted, interval, optional_span(time), most))


def _backup_of(source: Backup | Path) -> tuple[Backup, str]:
    if isinstance(source, Backup):
        return source, "the backup"
    return Backup.load(source), os.fspath(source)


def _free(path: str) -> str:
    """A name beside a file that is free, for the values before."""
    for number in range(1, 10_000):
        if not os.path.lexists(beside := f"{path}.before-{number}"):
            return beside
    raise LocalError(f"no free name for the values before: {path}.before-1 to -9999 exist")


def grouped(what: str, errors: Mapping[str, ProfidriveError], results: Mapping[str, object]) -> DriveGroupError:
    """The error of some drives of many."""
    lines = "".join(f"\n  {name}: {error}" for name, error in errors.items())
    message = f"{what}: {len(errors)} of {len(errors) + len(results)} drives failed{lines}"
    return DriveGroupError(message, errors=dict(errors), results=dict(results))


class Network:
    """A network: that of a computer, or of a world. Calls for a world take virtual time, as they take time on a wire; none sleeps.

    Leaving a `with` block closes it. Every axis under control is then brought to rest and released, as at the end of the program.
    """

    __slots__ = ("_network",)

    def __init__(self, network: _profidrive.Network) -> None:
        self._network = network

    def __getitem__(self, drive: str) -> Drive:
        """Returns a drive by its station name or IP address. It is searched at its first use."""
        return Drive(self._network, drive)

    def select(self, *selectors: str) -> Drives:
        """Finds the drives that are meant: `"akd-1"`, `"akd-*"`, `"model=akd"`, `"vendor=danfoss"`, `"all"`, or a list of them.

        Raises:
            DriveGroupError: when one of them cannot be worked with; `results` has the others.
        """
        found = self._network.select(",".join(selectors))
        errors = {name: error for name, error in found if isinstance(error, ProfidriveError)}
        drives = {name: self[name] for name, error in found if error is None}
        if errors:
            raise grouped("select", errors, drives)
        return Drives(self._network, tuple(drives))

    def scan(self, *, wait: Duration = 2.0) -> ScanReport:
        """Finds all stations that answer in this time and reads who they are. Nothing is changed."""
        return ScanReport._of(json.loads(self._network.scan(span(wait))))

    def set_name(self, station: str, name: str, *, permanent: bool = True, dry_run: bool = False) -> NameReport:
        """Names a station, which is given by its MAC address, its present name or its IP address; an empty name takes it away.

        Raises:
            UsageError, UnsupportedError: for a name that is not valid, and one that another station has.
            SafetyError: while a controller is connected.
        """
        return NameReport._of(json.loads(self._network.set_name(station, name, permanent, dry_run)))

    def set_ip(
        self, station: str, ip: str, *, gateway: str | None = None, permanent: bool = True, dry_run: bool = False
    ) -> IpReport:
        """Gives a station an IP address with the length of its mask: `"192.168.0.11/24"`.

        Raises:
            UsageError, UnsupportedError: for an address that is not valid, and one that another station has.
            SafetyError: while a controller is connected.
        """
        try:
            address = ipaddress.IPv4Interface(ip)
            way = ipaddress.IPv4Address(gateway or 0)
        except ValueError as error:
            raise UsageError(f"{ip}: {error}", drive=station) from error
        if "/" not in ip:
            raise UsageError(f"{ip}: the length of the mask is missing, such as {ip}/24", drive=station)
        numbers = int(address.ip), int(address.netmask), int(way)
        return IpReport._of(json.loads(self._network.set_ip(station, *numbers, permanent, dry_run)))

    def blink(self, station: str, *, for_: Duration = 3.0) -> BlinkReport:
        """Lets a station show itself by its lamp."""
        return BlinkReport._of(json.loads(self._network.blink(station, span(for_))))

    def stop_all(self, *, quick: bool = False) -> None:
        """Stops all axes that this program has under control, along their ramps or by quick stop (OFF3), and does not wait.

        Any thread may call it. The calls that move the axes raise `InterruptedCall`.
        """
        self._network.stop_all(quick)

    def close(self) -> None:
        """Brings every axis under control to rest, releases it, and closes the network."""
        self._network.close()

    def __enter__(self) -> Network:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


class Drive:
    """A drive on a network. Making one sends nothing, and reading changes nothing."""

    __slots__ = ("_network", "name")

    def __init__(self, network: _profidrive.Network, name: str) -> None:
        self._network = network
        self.name = name

    def _do(self, call: Call[T]) -> T:
        return call.made(json.loads(self._network.one(self.name, call.verb)))

    @overload
    def read(self, parameter: str, /) -> Parameter: ...
    @overload
    def read(self, parameter: list[str] | tuple[str, ...], /) -> tuple[Parameter, ...]: ...
    def read(self, parameter: str | list[str] | tuple[str, ...], /) -> Parameter | tuple[Parameter, ...]:
        """Reads a parameter, or several in few requests: `"DRV.ACC"`, `"p922"`, `"3-41"`.

        In a list an array has a value for each element.

        Raises:
            UnknownParameter: for a name that the drive does not have.
            RefusedError: when the drive refuses one.
        """
        if not isinstance(parameter, str):
            return self._do(read_all(parameter))
        return self._do(read_one(parameter))

    def write(self, values: Mapping[str, Value], /, *, save: bool = False, dry_run: bool = False) -> WriteReport:
        """Checks values, writes them in this order, and reads them back. With `dry_run` nothing is written.

        Not saved values are lost at the next power cycle.

        Raises:
            UsageError: for a value that does not fit; nothing is written then.
            RefusedError: when the drive refuses the only value.
            PartialWrite: when it refuses one of several; `report` has what was written.
        """
        return self._do(write(values, save, dry_run))

    def describe(self, parameter: str) -> DescribeReport:
        """Returns unit, limits, choices and present values of a parameter, as the tables and the drive itself describe it."""
        return self._do(Call(_profidrive.Verb.describe(parameter), DescribeReport._of))

    def parameters(self, text: str | None = None, *, values: bool = False) -> ListReport:
        """Lists the parameters with a text in name, description or number; all where there is none."""
        return self._do(Call(_profidrive.Verb.list(text, values), ListReport._of))

    def identity(self) -> InfoReport:
        """Reads who the drive is: model, serial number, firmware, modules, controller."""
        return self._do(Call(_profidrive.Verb.identity(), InfoReport._of))

    def status(self) -> StatusReport:
        """Reads how the drive is, and in one sentence why it does not run."""
        return self._do(status())

    def faults(self, *, history: bool = False) -> FaultsReport:
        """Reads faults and warnings; acknowledged faults and the log with `history`."""
        return self._do(faults(history))

    def ack(self, *, by_parameter: bool = False) -> MotionReport:
        """Acknowledges faults: by the control word, or by a parameter beside the controller of the drive. Nothing moves."""
        return self._do(acknowledge(by_parameter))

    def backup(self) -> Backup:
        """Reads all settings. `Backup.missing` says what could not be read."""
        return self._do(backup())

    def diff(self, other: Backup | Drive | Path) -> DiffReport:
        """Compares the settings of the drive with a backup, its file or another drive; reads what the other side has."""
        if isinstance(other, Drive):
            return self._do(diff(other.backup(), other.name))
        return self._do(diff(*_backup_of(other)))

    def plan_restore(self, backup: Backup | Path, *, only: Sequence[str] = ()) -> RestoreReport:
        """Returns what restoring a backup would write and leave out. Reads only."""
        return self._do(restore(*_backup_of(backup), only, False, True, None))

    def restore(
        self, backup: Backup | Path, *, only: Sequence[str] = (), save: bool = False, way_back: Path | None = None
    ) -> RestoreReport:
        """Writes the settings of a backup that differ and reads them back.

        The values before are kept in the new file `way_back`, another backup; beside the file of the backup, or in the present
        folder, where no name is given.

        Args:
            only: names, numbers and groups of the settings that are restored; all where there is none.
            save: the drive saves them over power-off, where all are as they are to be.

        Raises:
            SafetyError: for a backup of another kind of drive, and while a controller is connected.
            RefusedError, DifferenceError: when the drive is not as the backup says; `restore` has what was written.
        """
        settings, name = _backup_of(backup)
        if way_back is None and not isinstance(backup, Backup):
            way_back = _free(os.fspath(backup))
        return self._do(restore(settings, name, only, save, False, way_back))

    def record(
        self,
        signals: str | Sequence[str],
        *,
        every: Duration | Literal["cycle"] = 0.1,
        for_: Duration | None = None,
        max_rows: int = 10_000_000,
    ) -> Recording:
        """Records signals for a time, and returns them as a table; without a time beside other calls, in a `with` block.

        Args:
            signals: parameters that are read at an interval; with every cycle signals of the telegram, such as `ZSW1`, or `all`.
            for_: how long. Where it is None the recording is returned at once and grows until `stop`.
            every: the interval, or `"cycle"`: each cycle of a connection that commands nothing. The drive must have no controller,
                and its power stage must be off.
            max_rows: the recording ends where it has so many.
        """
        return _recorded(self._network, [self.name], signals, for_, every, max_rows)

    def stop(self, *, disable: bool = False) -> StopReport:
        """Brings the drive to rest by the means that it has, whoever commands it, and waits for that. Any thread may call it.

        With `disable` the power stage is switched off too. This is not an emergency stop.

        Raises:
            SafetyError, NotReached: when the axis is not at rest.
            UnsupportedError: when another controller commands it and it has no parameter that stops it.
        """
        return self._do(stop(disable))

    def control(
        self,
        *,
        max_speed: Value,
        mode: Literal["velocity", "position"] | None = None,
        telegram: int | None = None,
        cycle: Duration | None = None,
        lease: Duration = 5.0,
        set_mode: bool = False,
        accept_no_timeout: bool = False,
    ) -> Control:
        """Returns what takes control of the axis in a `with` block. Only the axis in there has motions.

        Nothing moves before the first of its motions, which enables it. However the block ends, the axis is ramped down and
        released.

        Args:
            max_speed: any motion that is faster is refused; rpm where it has no unit.
            mode: what the drive has to be in; when None the present mode.
            telegram: the telegram to use; when None what the drive reports and the mode needs.
            cycle: update time of the connection; when None a calm one that the drive allows.
            lease: time without a call for the axis after which it is brought to rest, whatever the program does.
            set_mode: put the drive into the mode, and mode and telegram back afterwards. Without it another mode is refused.
            accept_no_timeout: consent to move a drive that keeps turning when its connection is lost.

        Raises:
            SafetyError: in the `with` statement, when a rule speaks against it: `controller_loss`, `mode`, `control`.
        """
        if set_mode and mode is None:
            raise UsageError("set_mode needs a mode: velocity or position", drive=self.name)
        limit, times = value_text(max_speed), (optional_span(cycle), span(lease))
        return Control(self._network, self.name, limit, mode, telegram, *times, set_mode, accept_no_timeout)

    def __repr__(self) -> str:
        return f"<Drive {self.name}>"


class Drives(Sequence[Drive]):
    """Drives of a network. A call is carried out on all of them at the same time and returns a mapping by name.

    Raises:
        DriveGroupError: when some of them fail; it has the errors, and the results of the others.
    """

    __slots__ = ("_names", "_network")

    def __init__(self, network: _profidrive.Network, names: tuple[str, ...]) -> None:
        self._network = network
        self._names = names

    @overload
    def __getitem__(self, place: int) -> Drive: ...
    @overload
    def __getitem__(self, place: slice) -> Drives: ...
    def __getitem__(self, place: int | slice) -> Drive | Drives:
        if isinstance(place, slice):
            return Drives(self._network, self._names[place])
        return Drive(self._network, self._names[place])

    def __len__(self) -> int:
        return len(self._names)

    def __iter__(self) -> Iterator[Drive]:
        return (Drive(self._network, name) for name in self._names)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the drives."""
        return self._names

    def _do(self, what: str, call: Call[T]) -> dict[str, T]:
        errors: dict[str, ProfidriveError] = {}
        results: dict[str, T] = {}
        for name, document, error in self._network.each(list(self._names), call.verb):
            try:
                if document is None:
                    assert isinstance(error, ProfidriveError)
                    raise error
                results[name] = call.made(json.loads(document))
            except ProfidriveError as failed:
                errors[name] = failed
        if errors:
            raise grouped(what, errors, results)
        return results

    @overload
    def read(self, parameter: str, /) -> dict[str, Parameter]: ...
    @overload
    def read(self, parameter: list[str] | tuple[str, ...], /) -> dict[str, tuple[Parameter, ...]]: ...
    def read(self, parameter: str | list[str] | tuple[str, ...], /) -> dict[str, Parameter] | dict[str, tuple[Parameter, ...]]:
        """Reads a parameter, or several, of each drive."""
        if not isinstance(parameter, str):
            return self._do("read", read_all(parameter))
        return self._do("read", read_one(parameter))

    def write(self, values: Mapping[str, Value], /, *, save: bool = False, dry_run: bool = False) -> dict[str, WriteReport]:
        """Writes the same values to each drive."""
        return self._do("write", write(values, save, dry_run))

    def status(self) -> dict[str, StatusReport]:
        """Reads how each drive is."""
        return self._do("status", status())

    def faults(self, *, history: bool = False) -> dict[str, FaultsReport]:
        """Reads faults and warnings of each drive."""
        return self._do("faults", faults(history))

    def ack(self, *, by_parameter: bool = False) -> dict[str, MotionReport]:
        """Acknowledges the faults of each drive."""
        return self._do("ack", acknowledge(by_parameter))

    def backup(self) -> dict[str, Backup]:
        """Reads all settings of each drive."""
        return self._do("backup", backup())

    def diff(self, other: Backup | Drive | Path) -> dict[str, DiffReport]:
        """Compares the settings of each drive with a backup, its file or another drive."""
        settings, name = (other.backup(), other.name) if isinstance(other, Drive) else _backup_of(other)
        return self._do("diff", diff(settings, name))

    def record(
        self,
        signals: str | Sequence[str],
        *,
        every: Duration | Literal["cycle"] = 0.1,
        for_: Duration | None = None,
        max_rows: int = 10_000_000,
    ) -> Recording:
        """Records signals of all drives for a time, and returns them as one table; without a time beside other calls, in a `with`
        block.

        Args:
            signals: parameters that are read at an interval; with every cycle signals of the telegram, such as `ZSW1`, or `all`.
            for_: how long. Where it is None the recording is returned at once and grows until `stop`.
            every: the interval, or `"cycle"`: each cycle of a connection that commands nothing. The drives must have no controller,
                and their power stages must be off.
            max_rows: the recording ends where it has so many.
        """
        return _recorded(self._network, list(self._names), signals, for_, every, max_rows)

    def stop(self, *, disable: bool = False) -> dict[str, StopReport]:
        """Brings each drive to rest."""
        return self._do("stop", stop(disable))

    def __repr__(self) -> str:
        return f"<Drives {', '.join(self._names)}>"


__all__ = ["Drive", "Drives", "Network", "open"]
