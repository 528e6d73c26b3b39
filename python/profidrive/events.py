# Generated from docs/schema by `cargo run -p xtask -- pages`. Do not edit.
"""Documents of the library as frozen data classes; their JSON schemas are in docs/schema."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias

from profidrive.types import State as State

if TYPE_CHECKING:
    import pint
    from pint import UnitRegistry


def _number(value: float | None) -> float:
    """JSON has no NaN: it is null there."""
    return float("nan") if value is None else value


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The state of the general state machine changed."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    old: State
    """State before, 1 to 5."""
    new: State
    """State now, 1 to 5."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> StateChanged:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            State(data["old"]),
            State(data["new"]),
        )


@dataclass(frozen=True, slots=True)
class DriveMessage:
    """A fault or a warning of a drive."""

    number: int
    """Its number."""
    text: str
    """Its meaning; empty where the tables have none."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DriveMessage:
        return cls(
            data["number"],
            data["text"],
        )


@dataclass(frozen=True, slots=True)
class FaultRaised:
    """A fault came."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    fault: DriveMessage
    """The fault."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> FaultRaised:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            DriveMessage._of(data["fault"]),
        )


@dataclass(frozen=True, slots=True)
class FaultCleared:
    """A fault was acknowledged."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    fault: DriveMessage
    """The fault."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> FaultCleared:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            DriveMessage._of(data["fault"]),
        )


@dataclass(frozen=True, slots=True)
class WarningRaised:
    """A warning came."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    warning: DriveMessage
    """The warning."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> WarningRaised:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            DriveMessage._of(data["warning"]),
        )


@dataclass(frozen=True, slots=True)
class WarningCleared:
    """A warning went."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    warning: DriveMessage
    """The warning."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> WarningCleared:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            DriveMessage._of(data["warning"]),
        )


@dataclass(frozen=True, slots=True)
class Sample:
    """Where the drive is, at a sample or because its status word has changed."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    stw1: int
    """Control word in force."""
    zsw1: int
    """Status word it sends."""
    speed: float
    """Speed of the shaft, rpm."""
    position: float
    """Position that the drive reports, rev."""
    current: float
    """Current, A."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Sample:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["stw1"],
            data["zsw1"],
            _number(data["speed"]),
            _number(data["position"]),
            _number(data["current"]),
        )


@dataclass(frozen=True, slots=True)
class Connected:
    """A controller opened a connection."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    controller: str
    """Its name of station."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Connected:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["controller"],
        )


@dataclass(frozen=True, slots=True)
class Exchanging:
    """Controller and drive exchange data."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    telegram: int
    """Number of the telegram in use."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Exchanging:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["telegram"],
        )


@dataclass(frozen=True, slots=True)
class ConnectionLost:
    """The connection of the controller was lost."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    cause: str
    """The cause in words."""
    status: int
    """The PNIO status that stands for it: ErrorCode, ErrorDecode, ErrorCode1 and ErrorCode2 from the highest octet down."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ConnectionLost:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["cause"],
            data["status"],
        )


@dataclass(frozen=True, slots=True)
class Released:
    """The controller released its connection."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Released:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
        )


@dataclass(frozen=True, slots=True)
class Injected:
    """Something was done to the drive from outside, by its time line or by a caller."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    action: str
    """What, in the notation of plant files."""
    duration: float | None
    """Seconds until it ends by itself; null for something without an end."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Injected:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["action"],
            data["duration"],
        )


@dataclass(frozen=True, slots=True)
class Restored:
    """Something that was to last for a time has ended."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    action: str
    """What was done to end it, in the notation of plant files."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Restored:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["action"],
        )


@dataclass(frozen=True, slots=True)
class TargetReached:
    """The axis arrived at the target of a traversing task."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    position: float
    """Position that the drive reports, in revolutions."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> TargetReached:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            _number(data["position"]),
        )


@dataclass(frozen=True, slots=True)
class Homed:
    """The axis has its home position."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Homed:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
        )


@dataclass(frozen=True, slots=True)
class SetpointIgnored:
    """The drive ignores a setpoint that is outside its limits."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    parameter: str
    """Name of the parameter of the setpoint."""
    pnu: int
    """Its number."""
    raw: int
    """The number as it came."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> SetpointIgnored:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["parameter"],
            data["pnu"],
            data["raw"],
        )


ReadingValue: TypeAlias = float | str
"""Value of a parameter."""


@dataclass(frozen=True, slots=True)
class ParameterReading:
    """A parameter as its drive reports it."""

    name: str
    """Name of the vendor; empty where it has none."""
    parameter: str
    """As its vendor writes its number: `p2108`, `3-41`, `ID 103`."""
    pnu: int
    """Parameter number."""
    index: int
    """Subindex on the wire; of a string the place of its first octet."""
    value: ReadingValue
    """A number in `unit`, or a text."""
    unit: str
    """Unit of the number, empty for none."""
    raw: int | None
    """The number as on the wire, sign included; null for a text."""
    text: str | None
    """Text of the value of an enumeration."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ParameterReading:
        return cls(
            data["name"],
            data["parameter"],
            data["pnu"],
            data["index"],
            data["value"],
            data["unit"],
            data["raw"],
            data["text"],
        )

    def to_pint(self, ureg: UnitRegistry[Any]) -> pint.Quantity[Any]:
        """Returns the number as a quantity of pint.

        Raises:
            UsageError: where there is no number, or pint does not have its unit.
        """
        from profidrive.units import to_pint

        return to_pint(self.value, self.unit, ureg)


class WrittenBy(str, Enum):
    """How a change of a parameter reached the drive."""

    RECORD = "record"
    """A record of a connection: a parameter job, or a record that is a parameter itself."""
    PKW = "pkw"
    """The parameter channel (PKW), cyclic or at a serial line."""
    OTHER = "other"
    """Anything else: the owner of the simulation."""


@dataclass(frozen=True, slots=True)
class ParameterWritten:
    """A parameter was written: by a controller, a tool or the owner of the simulation."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    reading: ParameterReading
    """The parameter as the drive reports it since."""
    by: WrittenBy
    """How the change reached the drive."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ParameterWritten:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            ParameterReading._of(data["reading"]),
            WrittenBy(data["by"]),
        )


@dataclass(frozen=True, slots=True)
class Note:
    """Anything else, in words."""

    time: float
    """Seconds since the start of the simulation."""
    time_ns: int
    """The same in nanoseconds."""
    drive: str
    """Name of the drive."""
    text: str
    """The words."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Note:
        return cls(
            _number(data["time"]),
            data["time_ns"],
            data["drive"],
            data["text"],
        )


Event: TypeAlias = (
    StateChanged
    | FaultRaised
    | FaultCleared
    | WarningRaised
    | WarningCleared
    | Sample
    | Connected
    | Exchanging
    | ConnectionLost
    | Released
    | Injected
    | Restored
    | TargetReached
    | Homed
    | SetpointIgnored
    | ParameterWritten
    | Note
)
"""Something that happened to a drive of a plant. The same plant gives the same events every time."""

_EVENTS: dict[str, Any] = {
    "state_changed": StateChanged,
    "fault_raised": FaultRaised,
    "fault_cleared": FaultCleared,
    "warning_raised": WarningRaised,
    "warning_cleared": WarningCleared,
    "sample": Sample,
    "connected": Connected,
    "exchanging": Exchanging,
    "connection_lost": ConnectionLost,
    "released": Released,
    "injected": Injected,
    "restored": Restored,
    "target_reached": TargetReached,
    "homed": Homed,
    "setpoint_ignored": SetpointIgnored,
    "parameter_written": ParameterWritten,
    "note": Note,
}


def event_of(data: Mapping[str, Any]) -> Event:
    """Returns it from its JSON document."""
    made: Event = _EVENTS[data["event"]]._of(data)
    return made


class Outcome(str, Enum):
    """What came of an expectation."""

    MET = "met"
    """It came true."""
    NOT_MET = "not_met"
    """It did not come true."""
    NEVER_STARTED = "never_started"
    """Its clock never started."""
    NOT_ENDED = "not_ended"
    """The run ended before its time."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """The value of a quantity that came nearest to the expected ones."""

    quantity: str
    """Which quantity."""
    value: float
    """Its value."""
    unit: str
    """Its unit, empty for none."""
    time: float
    """Seconds from the start to that moment."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Nearest:
        return cls(
            data["quantity"],
            _number(data["value"]),
            data["unit"],
            _number(data["time"]),
        )


@dataclass(frozen=True, slots=True)
class ExpectationResult:
    """What came of one expectation for one drive."""

    file: str | None
    """The file that has the expectation; null for a text."""
    name: str
    """Name of the expectation."""
    line: int
    """Line where it begins, from 1."""
    drive: str
    """The drive."""
    outcome: Outcome
    """What came of it."""
    expected: str
    """What was expected, as written."""
    actual: str
    """What the drive reported when it was decided."""
    time: float
    """Seconds from the start to the moment when it was decided."""
    nearest: Nearest | None
    """The nearest value of a quantity that was not met."""
    last_events: tuple[Event, ...] = field(repr=False)
    """The last events of the drive before that moment, five at most; without samples."""
    seed: int
    """Seed of the run."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ExpectationResult:
        return cls(
            data["file"],
            data["name"],
            data["line"],
            data["drive"],
            Outcome(data["outcome"]),
            data["expected"],
            data["actual"],
            _number(data["time"]),
            None if data["nearest"] is None else Nearest._of(data["nearest"]),
            tuple(event_of(item) for item in data["last_events"]),
            data["seed"],
        )

    def __str__(self) -> str:
        what = f"{self.drive}: {self.name}: {self.outcome.value.replace('_', ' ')}"
        return f"{what}: expected {self.expected}; actual: {self.actual} at {self.time} s"


__all__ = [
    "Connected",
    "ConnectionLost",
    "DriveMessage",
    "Event",
    "Exchanging",
    "ExpectationResult",
    "FaultCleared",
    "FaultRaised",
    "Homed",
    "Injected",
    "Nearest",
    "Note",
    "Outcome",
    "ParameterReading",
    "ParameterWritten",
    "ReadingValue",
    "Released",
    "Restored",
    "Sample",
    "SetpointIgnored",
    "StateChanged",
    "TargetReached",
    "WarningCleared",
    "WarningRaised",
    "WrittenBy",
    "event_of",
]
