"""PROFIdrive drives: on a network and virtual ones for tests.

Importing this package opens nothing, starts no thread, and loads the binding only when it is used.
"""

from __future__ import annotations

import logging
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

from profidrive import errors, types
from profidrive.errors import ErrorKind, ProfidriveError
from profidrive.types import State

if TYPE_CHECKING:
    from profidrive import aio, events, frames, gsdml, reports
    from profidrive._sync import Axis, Control, Drive, Drives, GroupControl, Network, Recording, open
    from profidrive.backup import Backup
    from profidrive.campaign import SweepResult, choice, log_uniform, normal, sweep, uniform
    from profidrive.capture import Decoded, Pdu, decode
    from profidrive.plant import Plant, PlantDrive, Served, VirtualDrive, World
    from profidrive.readings import Readings
    from profidrive.table import Table
    from profidrive.trace import Trace
    from profidrive.words import Stw1, Zsw1

# records are silent unless the program configures logging
logging.getLogger(__name__).addHandler(logging.NullHandler())

_LAZY = {
    "Axis": "_sync",
    "Backup": "backup",
    "Control": "_sync",
    "Decoded": "capture",
    "Drive": "_sync",
    "Drives": "_sync",
    "GroupControl": "_sync",
    "Network": "_sync",
    "Pdu": "capture",
    "Plant": "plant",
    "PlantDrive": "plant",
    "Readings": "readings",
    "Recording": "_sync",
    "Served": "plant",
    "Stw1": "words",
    "SweepResult": "campaign",
    "Table": "table",
    "Trace": "trace",
    "VirtualDrive": "plant",
    "World": "plant",
    "Zsw1": "words",
    "choice": "campaign",
    "decode": "capture",
    "log_uniform": "campaign",
    "normal": "campaign",
    "open": "_sync",
    "sweep": "campaign",
    "uniform": "campaign",
}


_MODULES = ("aio", "events", "frames", "gsdml", "reports")


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return import_module(f"profidrive.{name}")
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(import_module(f"profidrive.{_LAZY[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY, *_MODULES})


class BuildInfo(NamedTuple):
    """What this package was built of."""

    version: str
    commit: str | None
    """The commit, where the build knows it."""
    profile: str
    """`release` or `dev`."""
    features: tuple[str, ...]
    """Features of the library, such as `raw-ethernet`."""


def build_info() -> BuildInfo:
    """Returns what this package was built of."""
    from profidrive import _profidrive

    version, commit, profile, features = _profidrive.build_info()
    return BuildInfo(version, commit, profile, tuple(features))


__all__ = [
    "Axis",
    "Backup",
    "BuildInfo",
    "Control",
    "Decoded",
    "Drive",
    "Drives",
    "ErrorKind",
    "GroupControl",
    "Network",
    "Pdu",
    "Plant",
    "PlantDrive",
    "ProfidriveError",
    "Readings",
    "Recording",
    "Served",
    "State",
    "Stw1",
    "SweepResult",
    "Table",
    "Trace",
    "VirtualDrive",
    "World",
    "Zsw1",
    "aio",
    "build_info",
    "choice",
    "decode",
    "errors",
    "events",
    "frames",
    "gsdml",
    "log_uniform",
    "normal",
    "open",
    "reports",
    "sweep",
    "types",
    "uniform",
]
