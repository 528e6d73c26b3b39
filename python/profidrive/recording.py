"""Signals of drives, recorded."""

from __future__ import annotations

import json
from types import TracebackType
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


class Gap(NamedTuple):
    """A row in which values are missing: a reading that was not answered, a cycle that was lost."""

    time: float
    """Seconds from the start."""
    drive: str


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
        self._recording.stop()

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
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._recording.picture(title))


__all__ = ["Gap", "Recorded", "Recording"]
