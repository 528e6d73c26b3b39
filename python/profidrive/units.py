"""Numbers with their units as quantities of pint."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from profidrive.errors import UsageError

if TYPE_CHECKING:
    import pint
    from pint import UnitRegistry

_PINT = {
    "%": "percent",
    "Arms": "ampere",
    "Nm": "newton*meter",
    "Vrms": "volt",
    "kgcm^2": "kilogram*centimeter**2",
    "rev": "turn",
}
"""Units whose name is another one there."""


def to_pint(value: object, unit: str, ureg: UnitRegistry[Any]) -> pint.Quantity[Any]:
    """Returns a number in this unit as a quantity of pint.

    Raises:
        UsageError: where the value is no number, or pint does not have its unit.
    """
    if not isinstance(value, (int, float)):
        raise UsageError(f"{value!r} is no number with a unit")
    named = "".join(_PINT.get(part, part) for part in re.split(r"([*/()])", unit))
    try:
        made: pint.Quantity[Any] = ureg.Quantity(value, named)
        return made
    except Exception as error:
        # whatever a registry of the user raises
        raise UsageError(f"pint has no unit `{unit}`: {error}") from error


__all__ = ["to_pint"]
