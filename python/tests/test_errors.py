"""Errors: a class for each kind, which behave as exceptions of Python do."""

from __future__ import annotations

import copy
import pickle

import pytest

from profidrive import _profidrive, errors
from profidrive.errors import ErrorKind, ProfidriveError, UnknownParameter, UsageError
from profidrive.types import State

CLASSES = [getattr(errors, name) for name in errors.__all__ if name not in ("ErrorKind", "ProfidriveError")]


def test_every_kind_of_the_library_has_a_class() -> None:
    assert [kind.value for kind in ErrorKind] == _profidrive.error_kinds()
    for kind in _profidrive.error_kinds():
        error = errors._made(kind, "", "failed", None, "{}")
        assert error.kind.value == kind
        assert type(error) is not ProfidriveError


def test_states_are_those_of_the_library() -> None:
    # the library has two of S5: `switching off, ramp stop` and `switching off, quick stop`
    assert {number for number, _ in _profidrive.states()} == set(State)
    for number, name in _profidrive.states():
        assert name.split(",")[0] == State(number).text


@pytest.mark.parametrize("error", CLASSES, ids=lambda error: error.__name__)
def test_errors_pickle_with_all_they_have(error: type[ProfidriveError]) -> None:
    made = error("read akd-1: failed", drive="akd-1", hint="try again", number=17)
    for other in (pickle.loads(pickle.dumps(made)), copy.copy(made)):
        assert type(other) is error
        assert str(other) == "read akd-1: failed"
        assert (other.drive, other.hint) == ("akd-1", "try again")
        assert vars(other)["number"] == 17
        # notes exist from Python 3.11 on
        assert getattr(other, "__notes__", ["hint: try again"]) == ["hint: try again"]


def test_errors_are_those_of_python_too() -> None:
    bases = {
        "UsageError": ValueError,
        "UnknownParameter": KeyError,
        "UnreachableError": ConnectionError,
        "DifferenceError": AssertionError,
        "UnsupportedError": NotImplementedError,
        "LocalError": OSError,
    }
    for name, base in bases.items():
        assert issubclass(getattr(errors, name), base)
    # a KeyError shows the repr of its message
    assert str(UnknownParameter("no DRV.ACX")) == "no DRV.ACX"
    assert UsageError("x").hint is None
