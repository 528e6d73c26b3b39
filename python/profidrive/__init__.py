"""PROFIdrive drives: on a network and virtual ones for tests.

Importing this package opens nothing, starts no thread, and loads the binding only when it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

from profidrive import errors, types
from profidrive.errors import ErrorKind, ProfidriveError
from profidrive.types import State

if TYPE_CHECKING:
    from profidrive import events, gsdml, reports
    from profidrive.axis import Axis, Control
    from profidrive.backup import Backup
    from profidrive.campaign import SweepResult, choice, log_uniform, normal, sweep, uniform
    from profidrive.network import Drive, Drives, Network, open
    from profidrive.plant import Plant, PlantDrive, VirtualDrive, World
    from profidrive.recording import Recording
    from profidrive.table import Table
    from profidrive.trace import Trace

_LAZY = {
    "Axis": "axis",
    "Backup": "backup",
    "Control": "axis",
    "Drive": "network",
    "Drives": "network",
    "Network": "network",
    "Plant": "plant",
    "PlantDrive": "plant",
    "Recording": "recording",
    "SweepResult": "campaign",
    "Table": "table",
    "Trace": "trace",
    "VirtualDrive": "plant",
    "World": "plant",
    "choice": "campaign",
    "log_uniform": "campaign",
    "normal": "campaign",
    "open": "network",
    "sweep": "campaign",
    "uniform": "campaign",
}


_MODULES = ("events", "gsdml", "reports")


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


def build_info() -> BuildInfo:
    """Returns what this package was built of."""
    from profidrive import _profidrive

    return BuildInfo(*_profidrive.build_info())


__all__ = [
    "Axis",
    "Backup",
    "BuildInfo",
    "Control",
    "Drive",
    "Drives",
    "ErrorKind",
    "Network",
    "Plant",
    "PlantDrive",
    "ProfidriveError",
    "Recording",
    "State",
    "SweepResult",
    "Table",
    "Trace",
    "VirtualDrive",
    "World",
    "build_info",
    "choice",
    "errors",
    "events",
    "gsdml",
    "log_uniform",
    "normal",
    "open",
    "reports",
    "sweep",
    "types",
    "uniform",
]
