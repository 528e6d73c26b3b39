"""Device descriptions (GSDML): read and checked."""

from __future__ import annotations

import json
import os

from profidrive import _profidrive
from profidrive.reports import GsdmlCheckReport, GsdmlShowReport
from profidrive.types import Path


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


__all__ = ["check", "load"]
