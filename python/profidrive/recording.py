"""Signals of drives, recorded."""

from __future__ import annotations

import json
from typing import NamedTuple

from profidrive import _profidrive
from profidrive.table import Table
from profidrive.types import Path


class Recorded(NamedTuple):
    """What was recorded of a drive."""

    drive: str
    rows: int
    """Rows with values."""
    gaps: int
    """Rows in which values are missing: a reading that was not answered, a cycle that was lost."""
    missed: int
    """Readings or cycles that are missing, in gaps or beside them."""
    outages: int
    """How often nothing was recorded of the drive for a while."""
    outage_time: float
    """How long that was, s."""
    ended: str | None
    """Why the drive was no longer recorded; None where it was until the end."""


class Recording(Table):
    """A table with the signals of drives: `t`, `wall` (time of arrival), `drive`, `gap`, then a column for each signal."""

    __slots__ = ("_recording",)

    def __init__(self, recording: _profidrive.Recording) -> None:
        super().__init__(recording.table(), recording.write)
        self._recording = recording

    @property
    def drives(self) -> tuple[Recorded, ...]:
        """What was recorded of each drive, and what is missing."""
        return tuple(Recorded(**drive) for drive in json.loads(self._recording.drives()))

    def draw(self, path: Path, title: str = "") -> None:
        """Draws the signals to a file (SVG). Needs no other package."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._recording.picture(title))


__all__ = ["Recorded", "Recording"]
