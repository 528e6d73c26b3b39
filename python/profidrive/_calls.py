"""What calls are made of, for both faces."""

from __future__ import annotations

import atexit
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from profidrive import _profidrive
from profidrive._values import value_text
from profidrive.backup import Backup
from profidrive.errors import DriveGroupError, LocalError, ProfidriveError, UsageError, _made
from profidrive.readings import Readings
from profidrive.reports import (
    DescribeReport,
    DiffReport,
    FaultsReport,
    InfoReport,
    ListReport,
    MotionReport,
    Parameter,
    ParametersReport,
    RestoreReport,
    StatusReport,
    StopReport,
    WriteReport,
)
from profidrive.types import Path, Value

T = TypeVar("T")

_AT_EXIT = 10.0
"""Seconds that a program which ends waits for its axes."""


def leave_at_exit() -> None:
    """No axis is left under control when the program ends, wherever that is."""
    atexit.unregister(_leave_all)
    atexit.register(_leave_all)


def _leave_all() -> None:
    _profidrive.leave_all(_AT_EXIT)


@dataclass(frozen=True, slots=True)
class Call(Generic[T]):
    """A call for a drive, with what makes its result of the document."""

    verb: _profidrive.Verb
    made: Callable[[Any], T]
    changes: tuple[str, ...] = ()
    """What it writes."""
    is_stop: bool = False


def read_all(names: Sequence[str], errors: Literal["raise", "collect"]) -> Call[Readings]:
    def collected(data: Any) -> Readings:
        problems = tuple(_made(*problem) for problem in data["problems"])
        return Readings(ParametersReport._of(data["report"]).parameters, problems)

    if errors == "collect":
        return Call(_profidrive.Verb.read(list(names), True), collected)
    if errors != "raise":
        raise UsageError(f"errors={errors!r}: there are `raise` and `collect`")
    return Call(_profidrive.Verb.read(list(names), False), lambda data: Readings(ParametersReport._of(data).parameters))


def read_one(name: str) -> Call[Parameter]:
    def one(data: Any) -> Parameter:
        report = ParametersReport._of(data)
        if len(report.parameters) != 1:
            message = f"{name} has {len(report.parameters)} values: name an element, such as p922[0], or give a list"
            raise UsageError(message, drive=report.drive)
        return report.parameters[0]

    return Call(_profidrive.Verb.read([name], False), one)


def write(values: Mapping[str, Value], save: bool, dry_run: bool, beside_controller: bool) -> Call[WriteReport]:
    pairs = [(name, value_text(value)) for name, value in values.items()]
    return Call(_profidrive.Verb.write(pairs, save, dry_run, beside_controller), WriteReport._of, () if dry_run else tuple(values))


def status() -> Call[StatusReport]:
    return Call(_profidrive.Verb.status(), StatusReport._of)


def faults(history: bool) -> Call[FaultsReport]:
    return Call(_profidrive.Verb.faults(history), FaultsReport._of)


def acknowledge(by_parameter: bool) -> Call[MotionReport]:
    return Call(_profidrive.Verb.ack(by_parameter), MotionReport._of)


def stop(disable: bool) -> Call[StopReport]:
    return Call(_profidrive.Verb.stop(disable), StopReport._of, is_stop=True)


def backup() -> Call[Backup]:
    return Call(_profidrive.Verb.backup(), lambda data: Backup(data["text"], missing=data["missing"]))


def describe(parameter: str) -> Call[DescribeReport]:
    return Call(_profidrive.Verb.describe(parameter), DescribeReport._of)


def parameters(text: str | None, values: bool) -> Call[ListReport]:
    return Call(_profidrive.Verb.list(text, values), ListReport._of)


def identity() -> Call[InfoReport]:
    return Call(_profidrive.Verb.identity(), InfoReport._of)


def diff(other: Backup, name: str, only: str | Sequence[str]) -> Call[DiffReport]:
    return Call(_profidrive.Verb.diff(other.text, name, _meant(only)), DiffReport._of)


def _meant(only: str | Sequence[str]) -> list[str]:
    return [only] if isinstance(only, str) else list(only)


def restore(
    settings: Backup, name: str, only: str | Sequence[str], save: bool, dry_run: bool, way_back: Path | None
) -> Call[RestoreReport]:
    kept = None if way_back is None else os.fspath(way_back)
    verb = _profidrive.Verb.restore(settings.text, name, _meant(only), save, dry_run, kept)
    return Call(verb, RestoreReport._of, () if dry_run else (f"settings of {name}",))


def backup_of(source: Backup | Path) -> tuple[Backup, str]:
    if isinstance(source, Backup):
        return source, "the backup"
    return Backup.load(source), os.fspath(source)


def free_beside(path: str) -> str:
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
