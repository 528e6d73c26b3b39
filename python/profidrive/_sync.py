# Generated from aio.py by tools/py-sync. Do not edit.
"""Drives, with calls that wait."""

from __future__ import annotations

import ipaddress
import json
import os
import pathlib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Literal, ParamSpec, TypeVar, overload

from profidrive import _calls, _profidrive
from profidrive._calls import Call, backup_of, free_beside, grouped, read_all, read_one
from profidrive._render import page
from profidrive._values import optional_span, span, value_text
from profidrive._waiting import synchronous as waiting
from profidrive.backup import Backup
from profidrive.errors import MisuseError, ProfidriveError, UsageError
from profidrive.readings import Readings
from profidrive.recording import Gap, Recorded
from profidrive.reports import (
    AxisState,
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
    RestoreReport,
    ScanReport,
    StatusReport,
    StopReport,
    WriteReport,
)
from profidrive.table import OF_ALL, Table
from profidrive.types import CycleStats, Duration, Path, State, Value
from profidrive.words import Zsw1

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from profidrive.plant import World

T = TypeVar("T")
P = ParamSpec("P")


def open(
    interface: str | None = None,
    *,
    ip: bool = False,
    read_only: bool = False,
    timeout: Duration | None = None,
    machine: Path | None = None,
) -> Network:
    """Opens a network.

    Args:
        interface: a network interface such as `eth0`, or the serial line of a drive such as `fc:ttyUSB0/1`. When None it is that
            of the environment variable `PROFIDRIVE_INTERFACE`, else the only one that is up.
        ip: open UDP alone: drives are given by their IP addresses, can be read, written and stopped, and need no permission.
            Where no interface is named and raw sockets are not permitted, it is that anyway.
        read_only: refuse every call that changes something; a stop is always permitted.
        timeout: time for a drive to answer the first request of a call; when None the usual 10 s.
        machine: a machine file. Its groups can be selected (`"@line1"`), `"all"` means its drives too, and no motion is faster than
            it permits.

    Raises:
        PermissionMissing: when raw sockets are required and not permitted (CAP_NET_RAW).
        UnreachableError: when the interface is not there or is down.
    """
    named = interface or os.environ.get("PROFIDRIVE_INTERFACE") or None
    file = None if machine is None else os.fspath(machine)
    opened = waiting.call(_profidrive.open, named, ip, read_only, optional_span(timeout), file)
    _calls.leave_at_exit()
    return Network(opened)


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
    return Recording(waiting.call(network.record, names, wanted, interval, optional_span(time), most))


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
        """Finds the drives that are meant: `"akd-1"`, `"akd-*"`, `"model=akd"`, `"vendor=danfoss"`, `"all"`, a group of the machine
        file (`"@line1"`), or several of them.

        Raises:
            DriveGroupError: when one of them cannot be worked with; `results` has the others.
        """
        found = waiting.call(self._network.select, ",".join(selectors))
        errors = {name: error for name, error in found if isinstance(error, ProfidriveError)}
        drives = {name: self[name] for name, error in found if error is None}
        if errors:
            raise grouped("select", errors, drives)
        return Drives(self._network, tuple(drives))

    def scan(self, *, wait: Duration = 2.0) -> ScanReport:
        """Finds all stations that answer in this time and reads their identity. Nothing is changed."""
        return ScanReport._of(json.loads(waiting.call(self._network.scan, span(wait))))

    def set_name(self, station: str, name: str, *, permanent: bool = True, dry_run: bool = False) -> NameReport:
        """Names a station, which is given by its MAC address, its present name or its IP address; an empty name takes it away.

        Raises:
            UsageError, UnsupportedError: for a name that is not valid, and one that another station has.
            SafetyError: while a controller is connected.
        """
        return NameReport._of(json.loads(waiting.call(self._network.set_name, station, name, permanent, dry_run)))

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
        return IpReport._of(json.loads(waiting.call(self._network.set_ip, station, *numbers, permanent, dry_run)))

    def blink(self, station: str, *, for_: Duration = 3.0) -> BlinkReport:
        """Lets a station show itself by its lamp."""
        return BlinkReport._of(json.loads(waiting.call(self._network.blink, station, span(for_))))

    def stop_all(self, *, quick: bool = False) -> None:
        """Stops all axes that this program has under control, along their ramps or by quick stop (OFF3), and does not wait.

        Any thread may call it. The calls that move the axes raise `InterruptedCall`.
        """
        self._network.stop_all(quick)

    def close(self, *, timeout: Duration = 660.0) -> None:
        """Brings every axis under control to rest, releases it, and closes the network.

        Args:
            timeout: how long that is waited for. A ramp of 600 s is the longest one that an axis is given.

        Raises:
            NotReached: when an axis is not at rest by then; it goes on stopping.
        """
        waiting.lasting(self._network.close, span(timeout))

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

    def _do(self, call: Call[T], timeout: Duration | None = None) -> T:
        what, limit = (self.name, call.verb), optional_span(timeout)
        if call.is_stop:
            document = waiting.lasting(self._network.one, *what, limit)
        else:
            document = waiting.change(self.name, call.changes, lambda _: [(self.name, None)], self._network.one, *what, limit)
        return call.made(json.loads(document))

    @overload
    def read(self, parameter: str, /, *, timeout: Duration | None = None) -> Parameter: ...
    @overload
    def read(
        self,
        parameter: list[str] | tuple[str, ...],
        /,
        *,
        timeout: Duration | None = None,
        errors: Literal["raise", "collect"] = "raise",
    ) -> Readings: ...
    def read(
        self,
        parameter: str | list[str] | tuple[str, ...],
        /,
        *,
        timeout: Duration | None = None,
        errors: Literal["raise", "collect"] = "raise",
    ) -> Parameter | Readings:
        """Reads a parameter, or several in few requests: `"DRV.ACC"`, `"p922"`, `"3-41"`.

        In a list an array has a value for each element.

        Args:
            timeout: time for the whole call.
            errors: with `"collect"` what cannot be read of a list is in `errors` of the result, and nothing is raised for it.

        Raises:
            UnknownParameter: for a name that the drive does not have.
            RefusedError: when the drive refuses one.
            DriveTimeout: when it does not answer in time.
        """
        if not isinstance(parameter, str):
            return self._do(read_all(parameter, errors), timeout)
        return self._do(read_one(parameter), timeout)

    def write(
        self, values: Mapping[str, Value], /, *, save: bool = False, dry_run: bool = False, beside_controller: bool = False
    ) -> WriteReport:
        """Checks values, writes them in this order, and reads them back. With `dry_run` nothing is written.

        Not saved values are lost at the next power cycle.

        Args:
            save: the drive saves them over power-off.
            beside_controller: write also where a controller has the drive. The new values count for its motion at once.

        Raises:
            UsageError: for a value that does not fit; nothing is written then.
            SafetyError: when a controller has the drive; nothing is written then.
            RefusedError: when the drive refuses the only value.
            PartialWrite: when it refuses one of several; `report` has what was written.
        """
        return self._do(_calls.write(values, save, dry_run, beside_controller))

    def describe(self, parameter: str) -> DescribeReport:
        """Returns unit, limits, choices and present values of a parameter, as the tables and the drive itself describe it."""
        return self._do(_calls.describe(parameter))

    def parameters(self, text: str | None = None, *, values: bool = False) -> ListReport:
        """Lists the parameters with a text in name, description or number; all where there is none."""
        return self._do(_calls.parameters(text, values))

    def identity(self) -> InfoReport:
        """Reads the identity of the drive: model, serial number, firmware, modules, controller."""
        return self._do(_calls.identity())

    def status(self) -> StatusReport:
        """Reads how the drive is, and in one sentence why it does not run."""
        return self._do(_calls.status())

    def faults(self, *, history: bool = False) -> FaultsReport:
        """Reads faults and warnings; acknowledged faults and the log with `history`."""
        return self._do(_calls.faults(history))

    def ack(self, *, by_parameter: bool = False) -> MotionReport:
        """Acknowledges faults: by the control word, or by a parameter beside the controller of the drive. Nothing moves."""
        return self._do(_calls.acknowledge(by_parameter))

    def backup(self) -> Backup:
        """Reads all settings. `Backup.missing` says what could not be read."""
        return self._do(_calls.backup())

    def diff(self, other: Backup | Drive | Path, *, only: str | Sequence[str] = ()) -> DiffReport:
        """Compares the settings of the drive with a backup, its file or another drive; reads what the other side has.

        Args:
            only: names, with `*` for any part, and numbers of the settings that are compared; all where there is none.

        Raises:
            UsageError: for a backup of another kind of drive, and where `only` matches no setting of either side.
        """
        if isinstance(other, Drive):
            return self._do(_calls.diff(other.backup(), other.name, only))
        return self._do(_calls.diff(*backup_of(other), only))

    def plan_restore(self, backup: Backup | Path, *, only: str | Sequence[str] = ()) -> RestoreReport:
        """Returns what restoring a backup would write and leave out. Reads only."""
        return self._do(_calls.restore(*backup_of(backup), only, False, True, None))

    def restore(
        self, backup: Backup | Path, *, only: str | Sequence[str] = (), save: bool = False, way_back: Path | None = None
    ) -> RestoreReport:
        """Writes the settings of a backup that differ and reads them back.

        The values before are kept in the new file `way_back`, another backup; beside the file of the backup, or in the present
        folder, where no name is given.

        Args:
            only: names, numbers and groups of the settings that are restored; all where there is none.
            save: the drive saves them over power-off, if all values were verified.

        Raises:
            SafetyError: for a backup of another kind of drive, and while a controller is connected.
            RefusedError, DifferenceError: when the drive is not as the backup says; `restore` has what was written.
        """
        settings, name = backup_of(backup)
        if way_back is None and not isinstance(backup, Backup):
            way_back = free_beside(os.fspath(backup))
        return self._do(_calls.restore(settings, name, only, save, False, way_back))

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
        return self._do(_calls.stop(disable))

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
            max_speed: any motion that is faster is refused; above 0, rpm where it has no unit.
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


def _errors_of(done: Sequence[tuple[str, str | None, object]]) -> list[tuple[str, object]]:
    return [(name, error) for name, _, error in done]


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

    def _do(self, what: str, call: Call[T], timeout: Duration | None = None) -> dict[str, T]:
        errors: dict[str, ProfidriveError] = {}
        results: dict[str, T] = {}
        asked, limit = (list(self._names), call.verb), optional_span(timeout)
        if call.is_stop:
            done = waiting.lasting(self._network.each, *asked, limit)
        else:
            names = ", ".join(self._names)
            done = waiting.change(names, call.changes, _errors_of, self._network.each, *asked, limit)
        for name, document, error in done:
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
    def read(self, parameter: str, /, *, timeout: Duration | None = None) -> dict[str, Parameter]: ...
    @overload
    def read(
        self,
        parameter: list[str] | tuple[str, ...],
        /,
        *,
        timeout: Duration | None = None,
        errors: Literal["raise", "collect"] = "raise",
    ) -> dict[str, Readings]: ...
    def read(
        self,
        parameter: str | list[str] | tuple[str, ...],
        /,
        *,
        timeout: Duration | None = None,
        errors: Literal["raise", "collect"] = "raise",
    ) -> dict[str, Parameter] | dict[str, Readings]:
        """Reads a parameter, or several, of each drive; see `Drive.read`."""
        if not isinstance(parameter, str):
            return self._do("read", read_all(parameter, errors), timeout)
        return self._do("read", read_one(parameter), timeout)

    def write(
        self, values: Mapping[str, Value], /, *, save: bool = False, dry_run: bool = False, beside_controller: bool = False
    ) -> dict[str, WriteReport]:
        """Writes the same values to each drive."""
        return self._do("write", _calls.write(values, save, dry_run, beside_controller))

    def status(self) -> dict[str, StatusReport]:
        """Reads how each drive is."""
        return self._do("status", _calls.status())

    def faults(self, *, history: bool = False) -> dict[str, FaultsReport]:
        """Reads faults and warnings of each drive."""
        return self._do("faults", _calls.faults(history))

    def ack(self, *, by_parameter: bool = False) -> dict[str, MotionReport]:
        """Acknowledges the faults of each drive."""
        return self._do("ack", _calls.acknowledge(by_parameter))

    def backup(self) -> dict[str, Backup]:
        """Reads all settings of each drive."""
        return self._do("backup", _calls.backup())

    def diff(self, other: Backup | Drive | Path, *, only: str | Sequence[str] = ()) -> dict[str, DiffReport]:
        """Compares the settings of each drive with a backup, its file or another drive; see `Drive.diff`."""
        settings, name = (other.backup(), other.name) if isinstance(other, Drive) else backup_of(other)
        return self._do("diff", _calls.diff(settings, name, only))

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
        return self._do("stop", _calls.stop(disable))

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
    ) -> GroupControl:
        """Returns what takes control of all axes in a `with` block, in their order; see `Drive.control`.

        Each motion is one of its axis: `run` leaves it turning, `wait=False` begins a move without waiting. While a call for one
        axis waits the others are kept, and when one of them fails the call ends along its ramp and raises why that one failed.
        However the block ends, all are stopped and released at the same time.

        Raises:
            DriveGroupError: at the begin of the block, when one cannot be taken: none is then; at its end, when one cannot be
                brought to rest.
        """
        return GroupControl(
            {
                drive.name: drive.control(
                    max_speed=max_speed,
                    mode=mode,
                    telegram=telegram,
                    cycle=cycle,
                    lease=lease,
                    set_mode=set_mode,
                    accept_no_timeout=accept_no_timeout,
                )
                for drive in self
            }
        )

    def __repr__(self) -> str:
        return f"<Drives {', '.join(self._names)}>"


class Axis:
    """An axis under control, in a `with` block of `Drive.control`.

    Motions wait until they have ended, and leave the axis holding, or at rest where they fail. The first one enables it. A motion
    that a limit forbids raises `SafetyError`, and the axis goes on as before. An axis that stopped by itself, by the end of its
    lease for example, is not started again: the next call raises why.

    Ctrl-C stops the axis along its ramp; again, at least a second later, by quick stop (OFF3); a third time ends the wait.

    Raises:
        AxisFault: when the drive reports a fault.
        NotReached: when a target or a speed is not reached in time.
        ConnectionLost: when the connection is lost. The axis cannot be used again, the drive can.
        InterruptedCall: when another thread stops it.
    """

    __slots__ = ("_axis", "_drive")

    def __init__(self, axis: _profidrive.Axis, drive: str) -> None:
        # named before it has what is to be stopped, whatever interrupts this
        self._drive = drive
        self._axis = axis

    def run(self, speed: Value, *, for_: Duration | None = None) -> MotionReport:
        """Turns at a speed. Returns at that speed and leaves it turning; with `for_` it keeps the speed for that time and halts."""
        return self._move(self._axis.run, value_text(speed), optional_span(for_))

    def jog(self, speed: Value | None = None, *, for_: Duration) -> MotionReport:
        """Jogs for a time and halts: at a speed (real-time jogging, position mode), or at the jog speed 1 of the drive."""
        return self._move(self._axis.jog, None if speed is None else value_text(speed), span(for_))

    def move_to(
        self,
        position: Value,
        *,
        speed: Value,
        acceleration: Value | None = None,
        deceleration: Value | None = None,
        wait: bool = True,
        timeout: Duration | None = None,
    ) -> MotionReport:
        """Goes to a position, such as `10rev`, and holds there. Without `wait` it returns once the drive has accepted the move.

        Numbers have the units of `position` and `speed`: revolutions and rpm. A text without a unit is a position in increments.
        Ramps are those of the drive where none are given. Without a timeout it may take some multiple of its computed time.
        """
        return self._go(position, False, speed, acceleration, deceleration, wait, timeout)

    def move_by(
        self,
        distance: Value,
        *,
        speed: Value,
        acceleration: Value | None = None,
        deceleration: Value | None = None,
        wait: bool = True,
        timeout: Duration | None = None,
    ) -> MotionReport:
        """Goes by a distance; see `move_to`."""
        return self._go(distance, True, speed, acceleration, deceleration, wait, timeout)

    def _go(
        self,
        target: Value,
        is_distance: bool,
        speed: Value,
        acceleration: Value | None,
        deceleration: Value | None,
        wait: bool,
        timeout: Duration | None,
    ) -> MotionReport:
        ramps = [None if ramp is None else value_text(ramp) for ramp in (acceleration, deceleration)]
        # a number is in the unit of `position`
        order = (value_text(target, "rev"), is_distance, value_text(speed), ramps[0], ramps[1])
        return self._move(self._axis.move_to, *order, wait, optional_span(timeout))

    def _move(self, motion: Callable[P, str], *arguments: P.args, **named: P.kwargs) -> MotionReport:
        return MotionReport._of(json.loads(waiting.motion(self._drive, self._axis.interrupt, motion, *arguments, **named)))

    def home(self, *, timeout: Duration = 60.0) -> MotionReport:
        """Sets the home position by the homing procedure of the drive."""
        return self._move(self._axis.home, span(timeout))

    def task(self, number: int, *, wait: bool = True, timeout: Duration = 60.0) -> MotionReport:
        """Carries out a motion task of the drive, or the chain that begins with it.

        Without `wait` it returns once the drive has accepted it.
        """
        return self._move(self._axis.task, number, wait, span(timeout))

    def stop(self, *, quick: bool = False, timeout: Duration | None = None) -> MotionReport:
        """Stops along the ramp (OFF1) or by quick stop (OFF3), ends operation and keeps control. Returns at standstill.

        Any thread may call it while another one waits for a motion, which raises `InterruptedCall` then.

        Raises:
            NotReached: when it is not at rest after `timeout`; it goes on stopping.
        """
        return MotionReport._of(json.loads(waiting.lasting(self._axis.stop, quick, optional_span(timeout))))

    def ack(self) -> None:
        """Acknowledges faults by an edge of STW1 bit 7."""
        waiting.call(self._axis.ack)

    def keep_alive(self) -> None:
        """Renews the lease, as every other call that waits does."""
        waiting.call(self._axis.keep_alive)

    @property
    def status(self) -> AxisState:
        """What the last frame reported: words, speed, position. Without any I/O, from any thread."""
        document = self._axis.status()
        if document is None:
            raise MisuseError("the axis was released", drive=self._drive)
        return AxisState._of(json.loads(document))

    @property
    def state(self) -> State | None:
        """State of the general state machine."""
        state = self.status.state
        return None if state is None else State[state.value]

    @property
    def zsw1(self) -> Zsw1 | None:
        """Status word of the last frame, in the bits of the profile that the drive is set to; None before the first one."""
        word = self.status.zsw1
        return None if word is None else Zsw1(word.number)

    @property
    def speed(self) -> float | None:
        """Speed of the motor, rpm; None where the telegram does not carry it."""
        speed = self.status.speed_actual
        return None if speed is None else speed.value

    @property
    def position(self) -> float | None:
        """Position in revolutions; None where the telegram does not carry it."""
        position = self.status.position
        return None if position is None else position.value

    @property
    def stats(self) -> CycleStats | None:
        """Frames of the connection; None on a serial line, and while another thread waits for a motion."""
        frames = self._axis.frames()
        return None if frames is None else CycleStats(*frames)

    def __repr__(self) -> str:
        return f"<Axis of {self._drive}>"

    def __del__(self) -> None:
        # it cannot be reached any more: the network brings it to rest
        axis = getattr(self, "_axis", None)
        if axis is not None and axis.abandon():
            warnings.warn(
                f"{self!r} was under control and is stopped: use a with block", ResourceWarning, stacklevel=2, source=self
            )


def _then(error: BaseException, unreleased: ProfidriveError) -> None:
    """Notes what comes on top of what ended a block."""
    if hasattr(error, "add_note") and type(unreleased) is not type(error):
        error.add_note(f"then: {unreleased}")


class Control:
    """Takes control of an axis in a `with` block. However the block ends, the axis is ramped down and released."""

    __slots__ = ("_arguments", "_axis", "_network")

    def __init__(
        self,
        network: _profidrive.Network,
        drive: str,
        max_speed: str,
        mode: str | None,
        telegram: int | None,
        cycle: float | str | None,
        lease: float | str,
        set_mode: bool,
        accept_no_timeout: bool,
    ) -> None:
        self._network = network
        self._arguments = (drive, max_speed, mode, telegram, cycle, lease, set_mode, accept_no_timeout)
        self._axis: Axis | None = None

    def __enter__(self) -> Axis:
        if self._axis is not None:
            raise MisuseError("control is for one block", drive=self._arguments[0])
        self._axis = Axis(waiting.call(self._network.control, *self._arguments), self._arguments[0])
        return self._axis

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        axis = self._axis
        if axis is None or not axis._axis.is_held:
            return
        try:
            waiting.lasting(axis._axis.release, isinstance(error, KeyboardInterrupt))
        except ProfidriveError as unreleased:
            if error is None:
                raise
            _then(error, unreleased)


class GroupControl:
    """Takes control of the axes of many drives in a `with` block. However the block ends, all are ramped down and released."""

    __slots__ = ("_controls",)

    def __init__(self, controls: dict[str, Control]) -> None:
        self._controls = controls

    def __enter__(self) -> Mapping[str, Axis]:
        if any(control._axis is not None for control in self._controls.values()):
            raise MisuseError("control is for one block")
        axes: dict[str, Axis] = {}
        errors: dict[str, ProfidriveError] = {}
        try:
            for name, control in self._controls.items():
                try:
                    axes[name] = control.__enter__()
                except ProfidriveError as error:
                    errors[name] = error
            if errors:
                raise grouped("control", errors, dict.fromkeys(axes))
        except BaseException as error:
            self.__exit__(type(error), error, error.__traceback__)
            raise
        _profidrive.hold_together([axis._axis for axis in axes.values()])
        return MappingProxyType(axes)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        taken = {name: control._axis._axis for name, control in self._controls.items() if control._axis is not None}
        held = {name: axis for name, axis in taken.items() if axis.is_held}
        interrupted = isinstance(error, KeyboardInterrupt)
        failed = waiting.lasting(_profidrive.release_together, list(held.values()), interrupted)
        errors = {name: one for name, one in zip(held, failed, strict=True) if isinstance(one, ProfidriveError)}
        if errors and error is None:
            raise grouped("release", errors, {name: None for name in held if name not in errors})
        if error is not None:
            for unreleased in errors.values():
                _then(error, unreleased)


class Recording(Table):
    """A table with the signals of drives: `t`, `wall` (time of arrival), `drive`, `gap`, then a column for each signal.

    One without a time grows beside other calls until the end of its `with` block, or `stop`. It can be looked at meanwhile: what is
    taken of it is what there is at that moment. In a plant time passes for it, too, only while a call waits.
    """

    __slots__ = ("_recording",)

    def __init__(self, recording: _profidrive.Recording) -> None:
        super().__init__(recording.table, recording.write)
        self._recording = recording

    @property
    def grows(self) -> bool:
        """Whether it is still recorded."""
        return self._recording.grows

    def stop(self) -> None:
        """Ends it, and returns when the drives are free again.

        Raises:
            ConnectionLost, UnreachableError: where it had ended before, by an error of the network.
        """
        waiting.lasting(self._recording.stop)

    def gaps(self) -> tuple[Gap, ...]:
        """Returns the rows in which values are missing."""
        return tuple(Gap(time, drive) for time, drive in self._recording.gaps())

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.stop()

    @property
    def drives(self) -> tuple[Recorded, ...]:
        """What was recorded of each drive, and what is missing."""
        return tuple(Recorded(**drive) for drive in json.loads(self._recording.drives()))

    def draw(self, path: Path, title: str = "") -> None:
        """Draws the signals to a file (SVG). Needs no other package."""
        pathlib.Path(path).write_text(self._recording.picture(title), encoding="utf-8")

    def plot(self, signals: Sequence[str] | None = None, ax: Axes | None = None) -> Axes:
        """Plots signals with matplotlib, all where none is named, marks the gaps, and returns the axes."""
        from profidrive._plot import plot

        chosen = [name for name in self.columns if name not in OF_ALL] if signals is None else signals
        drives = [recorded.drive for recorded in self.drives]
        return plot(self, drives, chosen, ax, gaps=[gap.time for gap in self.gaps()])

    def _repr_html_(self) -> str:
        """Signals of one unit as a picture, and the last rows of all, for notebooks."""
        units = self.units
        signals = [name for name in self.columns if name not in OF_ALL]
        shown = [name for name in signals if units[name] == units[signals[0]]]
        return page(self._recording.picture("", shown), super()._repr_html_())


def network_of(world: World) -> Network:
    """Returns the network of a plant. Time passes there only while a call waits."""
    return Network(world._world.network())


__all__ = ["Axis", "Control", "Drive", "Drives", "GroupControl", "Network", "Recording", "network_of", "open"]
