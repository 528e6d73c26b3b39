"""What a recording counts."""

from __future__ import annotations

from typing import NamedTuple


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


__all__ = ["Gap", "Recorded"]
