"""Drives as a client reaches them: by records over the network of a plant, in virtual time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import overload

from profidrive import _profidrive
from profidrive._values import value_text
from profidrive.errors import UsageError
from profidrive.reports import FaultsReport, Parameter, ParametersReport, StatusReport, WriteReport
from profidrive.types import Value


class Network:
    """The network of a world. Its calls take virtual time, as they would take time on a wire; none sleeps."""

    __slots__ = ("_network",)

    def __init__(self, network: _profidrive.Network) -> None:
        self._network = network

    def __getitem__(self, drive: str) -> Drive:
        """Returns a drive by its station name or IP address. It is searched at its first use."""
        return Drive(self._network, drive)


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

    def __repr__(self) -> str:
        return f"<Drive {self.name}>"


__all__ = ["Drive", "Network"]
