"""Errors. Each kind of the library has one class, and all carry `kind`, `drive` and `hint`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from profidrive.events import ExpectationResult
    from profidrive.reports import Fault, MotionReport, Quantity, RestoreReport, WriteReport


class ErrorKind(str, Enum):
    """What kind of error it is."""

    USAGE = "usage"
    """What was requested is wrong, whatever the drive is like: a value, a unit, a name."""
    REFUSED = "refused"
    """The drive or the device refused."""
    UNREACHABLE = "unreachable"
    """The drive, the network or the permission to use it is not there."""
    LOST = "lost"
    """A connection that was there is gone, while an axis was under control."""
    SAFETY = "safety"
    """A rule that protects people or machines stopped it."""
    FAULT = "fault"
    """The drive has a fault."""
    NOT_REACHED = "not_reached"
    """What was commanded was not reached: speed, position, state."""
    PARTIAL = "partial"
    """A part was done, a part was not."""
    DIFFERENCE = "difference"
    """Something differs from what it should be."""
    UNSUPPORTED = "unsupported"
    """The drive cannot do it, or not as it is now set up."""
    INTERRUPTED = "interrupted"
    """The caller requested a stop."""
    LOCAL = "local"
    """Something on this computer cannot be used, or the content of a file is wrong."""
    INTERNAL = "internal"
    """The drive sent an answer that has no meaning, or this package has an error."""


class ProfidriveError(Exception):
    """An error of this package."""

    kind: ClassVar[ErrorKind] = ErrorKind.INTERNAL
    drive: str | None = None
    """The drive that it is about."""
    hint: str | None = None
    """What to do next."""

    def __init__(self, message: str = "", **fields: object) -> None:
        super().__init__(message)
        self._message = message
        for name, value in fields.items():
            setattr(self, name, value)
        if self.hint and hasattr(self, "add_note"):
            self.add_note(f"hint: {self.hint}")

    def __str__(self) -> str:
        return self._message

    def __reduce__(self) -> tuple[Any, ...]:
        # the second base of some classes has a form of its own
        return type(self), (self._message,), self.__dict__


class UsageError(ProfidriveError, ValueError):
    """A unit, a notation, a name or a plant file is not valid."""

    kind = ErrorKind.USAGE
    line: int | None = None
    """The line of a text in which something is wrong, from 1."""


class UnknownParameter(UsageError, KeyError):
    """The drive has no parameter of this name."""

    nearest: tuple[str, ...] = ()
    """Names that are near, best first."""


class RefusedError(ProfidriveError):
    """The drive refused a request."""

    kind = ErrorKind.REFUSED
    owner: str | None = None
    """Station name of the controller that has the drive, where that is the reason and the drive reports it."""
    restore: RestoreReport | None = None
    """What a restore has written, where the drive refused some of it."""
    parameter: str | None = None
    """The parameter as its vendor writes it."""
    pnu: int | None = None
    index: int | None = None
    number: int | None = None
    """The error number of the profile."""
    text: str = ""


class UnreachableError(ProfidriveError, ConnectionError):
    """The drive or the network is not there."""

    kind = ErrorKind.UNREACHABLE


class DriveTimeout(UnreachableError, TimeoutError):
    """The drive did not answer in time."""


class ConnectionLost(UnreachableError):
    """The connection was lost while an axis was under control. The drive can be used again at the next call, the axis cannot."""

    kind = ErrorKind.LOST
    after: float | None = None
    """Seconds from the last control word until the drive reacts to the loss, where it has a setting for that."""
    drive_continues: bool | None = None
    """Whether the motor keeps turning, by the settings of the drive; None where that is not known."""


class PermissionMissing(UnreachableError, PermissionError):
    """This program may not open raw sockets (CAP_NET_RAW)."""


class SafetyError(ProfidriveError):
    """A rule that protects people or machines stopped it."""

    kind = ErrorKind.SAFETY
    rule: str | None = None
    """The rule: `speed_limit`, `mode`, `controller_loss`, `control`, `at_rest`, `move`, `scale`, `lease`, `standstill` or
    `read_only`."""
    owner: str | None = None
    """Station name of the controller that has the drive, where the drive reports it."""
    motion: MotionReport | None = None
    """What the motion was like until then, where it began."""


class AxisFault(ProfidriveError):
    """The drive has a fault."""

    kind = ErrorKind.FAULT
    fault: Fault | None = None
    """The first fault of the drive, where it was read."""
    motion: MotionReport | None = None
    """What the motion was like until then, where it began."""


class NotReached(ProfidriveError):
    """What was commanded was not reached."""

    kind = ErrorKind.NOT_REACHED
    target: Quantity | None = None
    """What was to be reached, where it is one number."""
    actual: Quantity | None = None
    """What was reached."""
    motion: MotionReport | None = None
    """What the motion was like until then, where it began."""


class PartialWrite(ProfidriveError):
    """A part was written, a part was not."""

    kind = ErrorKind.PARTIAL
    report: WriteReport | None = None
    """What was written, and what was not."""


class DifferenceError(ProfidriveError, AssertionError):
    """Something differs from what it should be."""

    kind = ErrorKind.DIFFERENCE
    report: WriteReport | None = None
    """What was written, where the drive has another value since."""
    restore: RestoreReport | None = None
    """What a restore has written, where the drive is not as its backup says."""


class ExpectationFailed(DifferenceError):
    """An expectation did not come true."""

    results: tuple[ExpectationResult, ...] = ()
    """The results of all expectations that were checked."""


class UnsupportedError(ProfidriveError, NotImplementedError):
    """The drive, this computer or this Python cannot do it."""

    kind = ErrorKind.UNSUPPORTED


class InterruptedCall(ProfidriveError):
    """The call was ended by a request to stop."""

    kind = ErrorKind.INTERRUPTED
    motion: MotionReport | None = None
    """What the motion was like until then, where it began."""


class LocalError(ProfidriveError, OSError):
    """A file or another thing of this computer cannot be used."""

    kind = ErrorKind.LOCAL


class InternalError(ProfidriveError, RuntimeError):
    """An answer has no meaning, or this package has an error."""

    kind = ErrorKind.INTERNAL


class MisuseError(ProfidriveError, RuntimeError):
    """An object is used in a way that it cannot be used: after its end, by two threads, or after a fork."""

    kind = ErrorKind.USAGE


class DriveGroupError(ProfidriveError):
    """Some drives of many failed."""

    kind = ErrorKind.PARTIAL
    errors: Mapping[str, ProfidriveError] = {}
    """The error of each drive that failed."""
    results: Mapping[str, object] = {}
    """What came of the others."""


_KINDS: Mapping[str, type[ProfidriveError]] = {
    found.kind.value: found
    for found in (
        UsageError,
        RefusedError,
        UnreachableError,
        ConnectionLost,
        SafetyError,
        AxisFault,
        NotReached,
        PartialWrite,
        DifferenceError,
        UnsupportedError,
        InterruptedCall,
        LocalError,
        InternalError,
    )
}
_NAMED: Mapping[str, type[ProfidriveError]] = {
    found.__name__: found for found in (UnknownParameter, DriveTimeout, ExpectationFailed, PermissionMissing, MisuseError)
}
_DOCUMENTS = {
    "report": "WriteReport",
    "restore": "RestoreReport",
    "fault": "Fault",
    "motion": "MotionReport",
    "target": "Quantity",
    "actual": "Quantity",
}
"""Attributes that are documents, with their classes."""


def _made(kind: str, name: str, message: str, hint: str | None, fields: str) -> ProfidriveError:
    """Makes an error of the library; called by the binding."""
    attributes: dict[str, Any] = json.loads(fields)
    if "results" in attributes:
        from profidrive.events import ExpectationResult

        attributes["results"] = tuple(ExpectationResult._of(result) for result in attributes["results"])
    for attribute in _DOCUMENTS.keys() & attributes.keys():
        from profidrive import reports

        attributes[attribute] = getattr(reports, _DOCUMENTS[attribute])._of(attributes[attribute])
    if "nearest" in attributes:
        attributes["nearest"] = tuple(attributes["nearest"])
    return _NAMED.get(name, _KINDS[kind])(message, hint=hint, **attributes)


__all__ = [
    "AxisFault",
    "ConnectionLost",
    "DifferenceError",
    "DriveGroupError",
    "DriveTimeout",
    "ErrorKind",
    "ExpectationFailed",
    "InternalError",
    "InterruptedCall",
    "LocalError",
    "MisuseError",
    "NotReached",
    "PartialWrite",
    "PermissionMissing",
    "ProfidriveError",
    "RefusedError",
    "SafetyError",
    "UnknownParameter",
    "UnreachableError",
    "UnsupportedError",
    "UsageError",
]
