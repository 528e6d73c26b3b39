"""Device descriptions (GSDML): read, checked and written."""

from __future__ import annotations

import json
import os
import pathlib

from profidrive import _profidrive
from profidrive._values import optional_span
from profidrive.reports import GsdmlCheckReport, GsdmlShowReport
from profidrive.types import Duration, Path


def load(source: Path, *, language: str | None = None) -> GsdmlShowReport:
    """Reads the description of a vendor: device, access points, modules with their ident numbers, timings.

    Args:
        source: the file.
        language: of its texts, such as `de`; the primary one where it is None.

    Raises:
        LocalError: when the file cannot be read, or what it means is not certain; `check` has everything that is wrong with it.
        UsageError: for a language that it does not have.
    """
    return GsdmlShowReport._of(json.loads(_profidrive.gsdml_show(os.fspath(source), language)))


def check(source: Path) -> GsdmlCheckReport:
    """Returns everything in a description that is against the rules, with its place, and the pictures that are missing beside it.

    Raises:
        LocalError: when the file cannot be read.
    """
    return GsdmlCheckReport._of(json.loads(_profidrive.gsdml_check(os.fspath(source))))


def export(model: str, folder: Path = ".", *, min_cycle: Duration | None = None) -> tuple[pathlib.Path, ...]:
    """Writes the device description of a virtual drive and its picture, for the engineering tool of a PLC.

    Files are replaced. Their names are those that the rules give.

    Args:
        model: `akd`, `vlt` or `vacon`.
        folder: it is made where it does not exist.
        min_cycle: the fastest update time in the description; that of the model where it is None.

    Raises:
        LocalError: when a file cannot be written.
    """
    written = json.loads(_profidrive.gsdml_export(model, os.fspath(folder), optional_span(min_cycle)))
    return tuple(pathlib.Path(file) for file in written["files"])


__all__ = ["check", "export", "load"]
