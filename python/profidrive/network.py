"""Drives as a client reaches them: on a network, or on that of a plant in virtual time."""

from __future__ import annotations

import atexit
import json
import os
from collections.abc import Mapping
from types import TracebackType
from typing import Literal, overload

from profidrive import _profidrive
from profidrive._values import optional_span, span, value_text
from profidrive.axis import Control
from profidrive.errors import UsageError
from profidrive.reports import FaultsReport, Parameter, ParametersReport, StatusReport, StopReport, WriteReport
from profidrive.types import Duration, Value

_AT_EXIT = 10.0
"""Seconds that a program which ends waits for its axes."""


def open(interface: str | None = None, *, ip: bool = False) -> Network:
    """Opens a network.

    Args:
        interface: a network interface such as `eth0`, or the serial line of a drive such as `fc:ttyUSB0/1`. When None it is that
            of the environment variable `PROFIDRIVE_INTERFACE`, else the only one that is up.
        ip: open UDP alone: drives are given by their IP addresses, can be read, written and stopped, and need no permission.
            Where no interface is named and raw sockets are not permitted, it is that anyway.

    Raises:
        PermissionMissing: when raw sockets are required and not permitted (CAP_NET_RAW).
        UnreachableError: when the interface is not there or is down.
    """
    named = interface or os.environ.get("PROFIDRIVE_INTERFACE") or None
    opened = Network(_profidrive.open(named, ip))
    atexit.unregister(_leave_all)
    atexit.register(_leave_all)
    return opened


def _leave_all() -> None:
    """No axis is left under control when the program ends, wherever that is."""
    _profidrive.leave_all(_AT_EXIT)


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
    """A drive on a network. Making one sends nothing; its calls read, and only `write` changes anything."""

    __slots__ = ("_network", "name")

    def __init__(self, network: _profidrive.Network, name: str) -> None:
        self._network = network
        self.name = name

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
        names = [parameter] if isinstance(parameter, str) else list(parameter)
        report = ParametersReport._of(json.loads(self._network.read(self.name, names)))
        if not isinstance(parameter, str):
            return report.parameters
        if len(report.parameters) != 1:
            message = f"{parameter} has {len(report.parameters)} values: name an element, such as p922[0], or give a list"
            raise UsageError(message, drive=self.name)
        return report.parameters[0]

    def write(self, values: Mapping[str, Value], /, *, save: bool = False, dry_run: bool = False) -> WriteReport:
        """Checks values, writes them in this order, and reads them back. With `dry_run` nothing is written.

        Not saved values are lost at the next power cycle.

        Raises:
            UsageError: for a value that does not fit; nothing is written then.
            RefusedError: when the drive refuses the only value.
            PartialWrite: when it refuses one of several; `report` has what was written.
        """
        pairs = [(name, value_text(value)) for name, value in values.items()]
        return WriteReport._of(json.loads(self._network.write(self.name, pairs, save, dry_run)))

    def status(self) -> StatusReport:
        """Reads how the drive is, and in one sentence why it does not run."""
        return StatusReport._of(json.loads(self._network.status(self.name)))

    def faults(self, *, history: bool = False) -> FaultsReport:
        """Reads faults and warnings; acknowledged faults and the log with `history`."""
        return FaultsReport._of(json.loads(self._network.faults(self.name, history)))

    def stop(self, *, disable: bool = False) -> StopReport:
        """Brings the drive to rest by the means that it has, whoever commands it, and waits for that. Any thread may call it.

        With `disable` the power stage is switched off too. This is not an emergency stop.

        Raises:
            SafetyError, NotReached: when the axis is not at rest.
            UnsupportedError: when another controller commands it and it has no parameter that stops it.
        """
        return StopReport._of(json.loads(self._network.stop(self.name, disable)))

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


__all__ = ["Drive", "Network", "open"]
