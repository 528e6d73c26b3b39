"""Values that several modules share."""

from __future__ import annotations

from enum import IntEnum
from os import PathLike
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeAlias, runtime_checkable

if TYPE_CHECKING:
    from datetime import timedelta
    from decimal import Decimal


@runtime_checkable
class HasUnits(Protocol):
    """A quantity of another package, such as one of pint."""

    @property
    def magnitude(self) -> float | int | Decimal: ...

    @property
    def units(self) -> object: ...


Value: TypeAlias = "float | int | str | bool | Decimal | HasUnits"
"""A value to write: a text with its unit (`"60rpm"`), a number in the unit of the parameter, or a quantity. Numbers of numpy are
numbers."""

Duration: TypeAlias = "float | int | str | timedelta"
"""A time: seconds, a text with its unit (`"400ms"`), or a `timedelta`."""

Path: TypeAlias = "str | PathLike[str]"


class State(IntEnum):
    """A state of the general state machine of PROFIdrive."""

    S1 = 1
    """Switching on inhibited."""
    S2 = 2
    """Ready for switching on."""
    S3 = 3
    """Switched on."""
    S4 = 4
    """Operation."""
    S5 = 5
    """Switching off."""

    @property
    def text(self) -> str:
        """The state in words: `operation`."""
        return _STATES[self]

    def __str__(self) -> str:
        return f"{self.name} {self.text}"


class CycleStats(NamedTuple):
    """Frames of a connection."""

    received: int
    missed: int
    """Lost between them, by their counter."""
    longest_gap: float
    """Seconds of the longest time between two of them."""


_STATES = {
    State.S1: "switching on inhibited",
    State.S2: "ready for switching on",
    State.S3: "switched on",
    State.S4: "operation",
    State.S5: "switching off",
}

__all__ = ["CycleStats", "Duration", "HasUnits", "Path", "State", "Value"]
