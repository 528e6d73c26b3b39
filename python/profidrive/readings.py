"""Values that were read together."""

from __future__ import annotations

from collections.abc import Iterable

from profidrive._render import page, table
from profidrive.errors import ProfidriveError
from profidrive.reports import Parameter


class Readings(tuple[Parameter, ...]):
    """Values of parameters in the order of the request; of an array one for each element.

    One that the drive refused has `error` in place of its value. That is so with `errors="collect"` only.
    """

    errors: tuple[ProfidriveError, ...]
    """What was not read, with `errors="collect"`: names that the drive does not have, and refusals."""

    def __new__(cls, parameters: Iterable[Parameter] = (), errors: Iterable[ProfidriveError] = ()) -> Readings:
        """Returns these values."""
        readings = super().__new__(cls, parameters)
        readings.errors = tuple(errors)
        return readings

    def _repr_html_(self) -> str:
        """The values in a table, for notebooks."""
        rows = [
            (one.number, one.name or "", one.error.meaning if one.error else one.text or "", one.unit, one.meaning or "")
            for one in self
        ]
        errors = [(type(error).__name__, str(error)) for error in self.errors]
        parts = [table(("number", "name", "value", "unit", "meaning"), rows, f"{len(rows)} values", first=True)]
        return page(*parts, *([table(("error", "what"), errors, f"{len(errors)} not read", first=True)] if errors else []))


__all__ = ["Readings"]
