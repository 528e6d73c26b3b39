"""Python values on their way to the library, which reads and checks them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from datetime import timedelta
from decimal import Decimal
from enum import IntFlag
from numbers import Integral, Real
from pathlib import PurePath
from typing import Any

from profidrive.errors import UsageError
from profidrive.types import Duration, HasUnits, State, Value

_TIMES = ("at", "within", "after", "for")


def span(time: Duration) -> float | str:
    """A time as the binding takes it."""
    if isinstance(time, timedelta):
        return time.total_seconds()
    if isinstance(time, str):
        return time
    try:
        return float(time)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{time!r}: a time is a number of seconds, a text with a unit or a timedelta") from error


def optional_span(time: Duration | None) -> float | str | None:
    return None if time is None else span(time)


def value_text(value: Value, unit: str = "") -> str:
    """A value as people write it; a number in this unit."""
    if isinstance(value, str):
        return value
    if isinstance(value, HasUnits):
        # pint has its short form of a unit by the format `~`: `rpm / s`
        return f"{value_text(value.magnitude)}{value.units:~}".replace(" ", "")
    return _digits(value) + unit


def _digits(value: object) -> str:
    """A number, without an exponent."""
    number = value
    if not isinstance(number, (Real, Decimal)) and hasattr(number, "item"):
        # a flag of numpy
        with suppress(TypeError, ValueError):
            number = number.item()
    if isinstance(number, Integral):
        return str(int(number))
    if isinstance(number, Real):
        number = Decimal(repr(float(number)))
    if isinstance(number, Decimal) and number.is_finite():
        return format(number, "f")
    raise UsageError(f"{value!r}: a value is a finite number, a text or a quantity with a unit")


def seed_of(seed: int) -> int:
    """A seed, of which a plant file has 63 bits."""
    if isinstance(seed, Integral) and 0 <= seed < 1 << 63:
        return int(seed)
    raise UsageError(f"{seed!r}: a seed is a whole number from 0 to 2**63 - 1")


def document(values: Mapping[str, object]) -> str:
    """A mapping as a JSON object."""
    try:
        return json.dumps({name: _written(value) for name, value in values.items()}, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{dict(values)!r}: {error}") from error


def _written(value: object) -> object:
    """A state, and bits of a word that are set, as a plant file has them; for JSON both are numbers."""
    if isinstance(value, State):
        return f"S{int(value)}"
    return f"{value:#06x}/{value:#06x}" if isinstance(value, IntFlag) else value


def _plain(value: Any) -> object:
    if isinstance(value, timedelta):
        return f"{value.total_seconds()!r}s"
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, HasUnits):
        return value_text(value)
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Decimal):
        return float(value)
    if hasattr(value, "item"):  # a number of numpy
        return value.item()
    raise TypeError(f"{type(value).__name__} is neither a number, a text, a list nor a mapping")


def expectation_text(expectation: str | Mapping[str, object]) -> str:
    """An expectation as the binding takes it; times may be seconds."""
    if isinstance(expectation, str):
        return expectation
    return document({key: _time(key, value) for key, value in expectation.items()})


def goal_text(drive: str, conditions: Mapping[str, object]) -> str:
    """Conditions given as keyword arguments: `target_reached=True`, `for_="200ms"`."""
    keys = {key.rstrip("_").replace("_", "-"): value for key, value in conditions.items()}
    return document({"drive": drive, **{key: _time(key, value) for key, value in keys.items()}})


def _time(key: str, value: object) -> object:
    if key in _TIMES and isinstance(value, (Real, Decimal)) and not isinstance(value, bool):
        return f"{_digits(value)}s"
    return value


def chosen(names: tuple[str, ...], wanted: str, what: str) -> str:
    """Returns one of these names."""
    if wanted in names:
        return wanted
    raise UsageError(f"no {what} `{wanted}`; there are: {', '.join(names)}", drive=wanted)
