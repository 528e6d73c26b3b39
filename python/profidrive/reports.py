# Generated from docs/schema by `cargo run -p xtask -- pages`. Do not edit.
"""Documents of the library as frozen data classes; their JSON schemas are in docs/schema."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias

from profidrive.types import State as State

if TYPE_CHECKING:
    import pint
    from pint import UnitRegistry


def _number(value: float | None) -> float:
    """JSON has no NaN: it is null there."""
    return float("nan") if value is None else value


ParameterContent: TypeAlias = float | str
"""What a parameter contains."""


@dataclass(frozen=True, slots=True)
class Word:
    """A word of bits: a control or status word, or a parameter whose bits have names."""

    number: int
    """The word as it travels."""
    hex: str
    """The same in hexadecimal: `0x047F`."""
    bits: tuple[str, ...]
    """Names of the bits that are set; of an inverse bit (OFF2, OFF3) what it says while it is 0."""
    meaning: str | None
    """What the whole word commands or reports."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Word:
        return cls(
            data["number"],
            data["hex"],
            tuple(item for item in data["bits"]),
            data["meaning"],
        )


@dataclass(frozen=True, slots=True)
class ParameterError:
    """Why a parameter was not read or written."""

    number: int | None
    """Error number that was received."""
    meaning: str
    """What it means."""
    information: int | None
    """Further information that was received with it."""
    remedy: str | None
    """What to do."""
    channel: str
    """Channel that the parameter was requested on: `records`, `fc` or `uss`."""
    sent: bool
    """False where the channel cannot carry the parameter and nothing was sent."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ParameterError:
        return cls(
            data["number"],
            data["meaning"],
            data["information"],
            data["remedy"],
            data["channel"],
            data["sent"],
        )


@dataclass(frozen=True, slots=True)
class Parameter:
    """One value of a parameter, or why it was not read."""

    pnu: int
    """Parameter number."""
    index: int | None
    """Element of an array."""
    number: str
    """The number as the vendor writes it: `p2108`, `1-20`, `ID 103`."""
    name: str | None
    """The vendor's name."""
    value: ParameterContent | None
    """The value in `unit`."""
    text: str | None
    """The value as it is shown to a person, without its unit."""
    unit: str
    """Unit of the value, empty for none."""
    meaning: str | None
    """What the value says: the choice of a list, the bits of a word."""
    word: Word | None
    """The bits, where the parameter is a word of bits."""
    beyond: str | None
    """`>` or `<` where a measured value may be higher or lower: its signal has no number beyond."""
    raw: float | None
    """The whole number that was received."""
    hex: str | None
    """The octets that were received."""
    format: int | None
    """Format code of the value (PROFIdrive data types)."""
    writable: bool | None
    """Whether the parameter can be written, where that is known."""
    error: ParameterError | None
    """Why there is no value."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Parameter:
        return cls(
            data["pnu"],
            data["index"],
            data["number"],
            data["name"],
            data["value"],
            data["text"],
            data["unit"],
            data["meaning"],
            None if data["word"] is None else Word._of(data["word"]),
            data["beyond"],
            data["raw"],
            data["hex"],
            data["format"],
            data["writable"],
            None if data["error"] is None else ParameterError._of(data["error"]),
        )

    def to_pint(self, ureg: UnitRegistry[Any]) -> pint.Quantity[Any]:
        """Returns the number as a quantity of pint.

        Raises:
            UsageError: where there is no number, or pint does not have its unit.
        """
        from profidrive.units import to_pint

        return to_pint(self.value, self.unit, ureg)


@dataclass(frozen=True, slots=True)
class ParametersReport:
    """Values of parameters."""

    drive: str
    """The drive."""
    parameters: tuple[Parameter, ...]
    """The values, in the order of the request."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ParametersReport:
        return cls(
            data["drive"],
            tuple(Parameter._of(item) for item in data["parameters"]),
        )


@dataclass(frozen=True, slots=True)
class Action:
    """Something to do next."""

    action: str
    """What it is: `stop`, `write`, `acknowledge`, .."""
    arguments: tuple[str, ...]
    """What it is done with: a device, parameters, `PARAMETER=VALUE`, a choice."""
    command: str | None
    """The call that does it; null where it is a choice of the call that was made."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Action:
        return cls(
            data["action"],
            tuple(item for item in data["arguments"]),
            data["command"],
        )


@dataclass(frozen=True, slots=True)
class StatusNote:
    """Something else that stands in the way."""

    cause: str
    """Stable name of the cause."""
    sentence: str
    """The cause in one sentence."""
    next: str | None
    """What to do about it."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> StatusNote:
        return cls(
            data["cause"],
            data["sentence"],
            data["next"],
        )


class DriveState(str, Enum):
    """State of a drive in the general state machine of PROFIdrive."""

    S1 = "S1"
    """Switching on inhibited."""
    S2 = "S2"
    """Ready for switching on."""
    S3 = "S3"
    """Switched on."""
    S4 = "S4"
    """Operation."""
    S5 = "S5"
    """Switching off."""


@dataclass(frozen=True, slots=True)
class Controller:
    """Who has the cyclic connection of a drive."""

    connected: bool
    """Whether a controller is connected."""
    name: str | None
    """Its name, where it has one."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Controller:
        return cls(
            data["connected"],
            data["name"],
        )


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with its unit."""

    value: float
    """The number."""
    unit: str
    """Its unit: `rpm`, `%`, `rev`, `V`; empty for none."""
    beyond: str | None
    """`>` or `<` where a measured value may be higher or lower: its signal has no number beyond."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Quantity:
        return cls(
            _number(data["value"]),
            data["unit"],
            data["beyond"],
        )

    def to_pint(self, ureg: UnitRegistry[Any]) -> pint.Quantity[Any]:
        """Returns the number as a quantity of pint.

        Raises:
            UsageError: where there is no number, or pint does not have its unit.
        """
        from profidrive.units import to_pint

        return to_pint(self.value, self.unit, ureg)


@dataclass(frozen=True, slots=True)
class LoadStatus:
    """Where the load of a drive is and how fast it goes, in the unit that the machine file has for it."""

    position: Quantity | None
    """Its position, counted from position 0 of the motor."""
    speed: Quantity | None
    """Its speed."""
    following_error: Quantity | None
    """Commanded position minus position."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> LoadStatus:
        return cls(
            None if data["position"] is None else Quantity._of(data["position"]),
            None if data["speed"] is None else Quantity._of(data["speed"]),
            None if data["following_error"] is None else Quantity._of(data["following_error"]),
        )


@dataclass(frozen=True, slots=True)
class LossReaction:
    """What a drive does when its controller is lost."""

    action: str
    """`ramp`, `quick-stop`, `coast`, `stop`, `keeps-turning` or `unknown`."""
    parameter: str | None
    """The parameter that decides."""
    setting: str | None
    """Its setting."""
    after: float | None
    """Seconds from the last control word until the drive reacts."""
    text: str
    """The same in words: `the drive keeps turning (8-04 is Off)`."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> LossReaction:
        return cls(
            data["action"],
            data["parameter"],
            data["setting"],
            data["after"],
            data["text"],
        )


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of a drive."""

    number: int
    """The vendor's number."""
    meaning: str | None
    """What it means."""
    reaction: str | None
    """What the drive does about it."""
    remedy: str | None
    """What to do."""
    parameters: tuple[str, ...]
    """The parameters that the remedy names, by name or number as their vendor writes them."""
    cleared: str | None
    """What ends it once the cause is gone."""
    needs_restart: bool | None
    """Whether only switching off and on ends it."""
    situation: int
    """Fault situation: 0 is not acknowledged yet, 1 the last acknowledged."""
    position: int
    """Position in its situation; 0 is the fault that came first."""
    acknowledged: bool
    """Whether it was acknowledged."""
    time: int | None
    """When it came, in the drive's own time (PNU 948)."""
    value: int | None
    """What else the drive noted (PNU 949)."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Fault:
        return cls(
            data["number"],
            data["meaning"],
            data["reaction"],
            data["remedy"],
            tuple(item for item in data["parameters"]),
            data["cleared"],
            data["needs_restart"],
            data["situation"],
            data["position"],
            data["acknowledged"],
            data["time"],
            data["value"],
        )


@dataclass(frozen=True, slots=True)
class Warning:
    """A warning of a drive."""

    number: int
    """The vendor's number."""
    meaning: str | None
    """What it means."""
    remedy: str | None
    """What to do."""
    parameters: tuple[str, ...]
    """The parameters that the remedy names, by name or number as their vendor writes them."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Warning:
        return cls(
            data["number"],
            data["meaning"],
            data["remedy"],
            tuple(item for item in data["parameters"]),
        )


@dataclass(frozen=True, slots=True)
class StatusReport:
    """How a drive is, and in one sentence why it does not run."""

    drive: str
    """The drive."""
    verdict: str
    """`runs`, `waits` (nothing is wrong) or `held`."""
    cause: str
    """Stable name of the cause."""
    sentence: str
    """The cause in one sentence."""
    next: str | None
    """What to do next."""
    actions: tuple[Action, ...]
    """The actions in it."""
    notes: tuple[StatusNote, ...]
    """What else stands in the way."""
    state: DriveState | None
    """State of the drive."""
    profile: str
    """Whose words these are: `PROFIdrive`, `FC profile`, .."""
    mode: str
    """Mode that decides over the bits: `velocity` or `position`."""
    stw1: Word | None
    """Control word that the drive acts on."""
    zsw1: Word | None
    """Status word of the drive."""
    fault_bit: bool | None
    """Whether the status word reports a fault."""
    warning_bit: bool | None
    """Whether the status word reports a warning."""
    state_text: str | None
    """The state in words."""
    controller: Controller | None
    """Who has its cyclic connection; null where it does not report that."""
    telegram: int | None
    """Telegram that is selected (PNU 922)."""
    operating_mode: int | None
    """Operating mode (PNU 930): 1 speed control, 2 positioning."""
    command_source: Word | None
    """Where the setpoints come from; `meaning` is what that source is called."""
    disable_sources: Word | None
    """What keeps the power stage off."""
    motion_disable_sources: Word | None
    """What keeps the axis from moving."""
    motion_status: Word | None
    """Status of the motion."""
    torque_allowed: bool | None
    """False for safe torque off."""
    homed: bool | None
    """Whether the axis has its home position; null in velocity mode."""
    negative_switch: bool | None
    """Whether the limit switch at the negative end is hit."""
    positive_switch: bool | None
    """Whether the limit switch at the positive end is hit."""
    software_limits: int | None
    """Software limits that are reached: bits 0 and 1."""
    bus_voltage: Quantity | None
    """Voltage of the DC bus."""
    current: Quantity | None
    """Current of the motor."""
    torque: Quantity | None
    """Torque of the motor; in `%` of its nominal torque where the drive does not report it in `Nm`."""
    temperature: Quantity | None
    """Temperature of the power stage, at the hottest of its sensors."""
    motor_temperature: Quantity | None
    """Temperature of the motor."""
    speed_set: Quantity | None
    """Speed that is commanded."""
    speed_actual: Quantity | None
    """Speed of the motor; in `%` of the reference where it is not known in `rpm`."""
    position: Quantity | None
    """Position."""
    following_error: Quantity | None
    """Commanded position minus position."""
    load: LoadStatus | None
    """The same of the load, where the machine file has its unit."""
    on_loss: LossReaction | None
    """What the drive does when its controller is lost."""
    faults: tuple[Fault, ...]
    """The faults that are present."""
    warnings: tuple[Warning, ...]
    """The warnings that are present."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> StatusReport:
        return cls(
            data["drive"],
            data["verdict"],
            data["cause"],
            data["sentence"],
            data["next"],
            tuple(Action._of(item) for item in data["actions"]),
            tuple(StatusNote._of(item) for item in data["notes"]),
            None if data["state"] is None else DriveState(data["state"]),
            data["profile"],
            data["mode"],
            None if data["stw1"] is None else Word._of(data["stw1"]),
            None if data["zsw1"] is None else Word._of(data["zsw1"]),
            data["fault_bit"],
            data["warning_bit"],
            data["state_text"],
            None if data["controller"] is None else Controller._of(data["controller"]),
            data["telegram"],
            data["operating_mode"],
            None if data["command_source"] is None else Word._of(data["command_source"]),
            None if data["disable_sources"] is None else Word._of(data["disable_sources"]),
            None if data["motion_disable_sources"] is None else Word._of(data["motion_disable_sources"]),
            None if data["motion_status"] is None else Word._of(data["motion_status"]),
            data["torque_allowed"],
            data["homed"],
            data["negative_switch"],
            data["positive_switch"],
            data["software_limits"],
            None if data["bus_voltage"] is None else Quantity._of(data["bus_voltage"]),
            None if data["current"] is None else Quantity._of(data["current"]),
            None if data["torque"] is None else Quantity._of(data["torque"]),
            None if data["temperature"] is None else Quantity._of(data["temperature"]),
            None if data["motor_temperature"] is None else Quantity._of(data["motor_temperature"]),
            None if data["speed_set"] is None else Quantity._of(data["speed_set"]),
            None if data["speed_actual"] is None else Quantity._of(data["speed_actual"]),
            None if data["position"] is None else Quantity._of(data["position"]),
            None if data["following_error"] is None else Quantity._of(data["following_error"]),
            None if data["load"] is None else LoadStatus._of(data["load"]),
            None if data["on_loss"] is None else LossReaction._of(data["on_loss"]),
            tuple(Fault._of(item) for item in data["faults"]),
            tuple(Warning._of(item) for item in data["warnings"]),
        )

    @property
    def runs(self) -> bool:
        """Whether the drive runs."""
        return self.verdict == "runs"

    def __bool__(self) -> bool:
        return self.runs

    def _repr_html_(self) -> str:
        """It in words and its values, for notebooks."""
        from profidrive._render import status

        return status(self)


@dataclass(frozen=True, slots=True)
class LogEntry:
    """An entry of the log of a drive."""

    number: int
    """The vendor's number."""
    meaning: str | None
    """What it means."""
    value: int | None
    """What the drive noted with it."""
    time: int | None
    """When it came, in the drive's own time."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> LogEntry:
        return cls(
            data["number"],
            data["meaning"],
            data["value"],
            data["time"],
        )


@dataclass(frozen=True, slots=True)
class FaultsReport:
    """What is wrong with a drive, and what was."""

    drive: str
    """The drive."""
    counter: int
    """Fault message counter (PNU 944)."""
    counts: str
    """What that counts: `changes` of the fault buffer or fault `situations`."""
    situation_counter: int | None
    """Fault situations that the drive has counted (PNU 952); null where it has no such counter."""
    situations: int
    """Situations of the fault buffer."""
    faults_per_situation: int
    """Faults of a situation."""
    fault_bit: bool | None
    """Whether the status word reports a fault."""
    warning_bit: bool | None
    """Whether the status word reports a warning."""
    faults: tuple[Fault, ...]
    """The faults that are present, and with the history those that were acknowledged."""
    acknowledged: int
    """Faults that were acknowledged before."""
    warnings: tuple[Warning, ...]
    """The warnings that are present."""
    log: tuple[LogEntry, ...]
    """The log that the drive keeps beside the fault buffer, the newest first; empty without the history."""
    history: bool
    """Whether the history is a part of this report."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> FaultsReport:
        return cls(
            data["drive"],
            data["counter"],
            data["counts"],
            data["situation_counter"],
            data["situations"],
            data["faults_per_situation"],
            data["fault_bit"],
            data["warning_bit"],
            tuple(Fault._of(item) for item in data["faults"]),
            data["acknowledged"],
            tuple(Warning._of(item) for item in data["warnings"]),
            tuple(LogEntry._of(item) for item in data["log"]),
            data["history"],
        )


@dataclass(frozen=True, slots=True)
class SettingChange:
    """A setting that is changed."""

    pnu: int
    """Parameter number."""
    index: int | None
    """Element of an array."""
    name: str | None
    """The vendor's name."""
    old: Parameter | None
    """The value before, or why it cannot be read; null for a command, which has none."""
    new: Parameter
    """The value that the drive is to have, as it can represent it."""
    asked: float | None
    """The number that was requested, in the unit of `new`; null for a text and for a value of a file."""
    rounded: bool
    """Whether `new` is rounded."""
    minimum: float | None
    """Lowest value that is valid, where that is known."""
    maximum: float | None
    """Highest value that is valid, where that is known."""
    step: str
    """How far it is: `same` (the drive had it before), `not written`, `in doubt` (sent, no answer), `written`,
`read back`, `differs` (another value was read back), `refused` or `not carried` (the channel cannot)."""
    same: bool
    """Whether the drive had the value before."""
    sent: bool
    """Whether it was sent."""
    written: bool
    """Whether the drive confirmed it."""
    differs: bool
    """Whether another value was read back."""
    read_back: Parameter | None
    """The value after, or why it cannot be read."""
    can_be_kept: bool | None
    """Whether the drive has non-volatile memory for it."""
    saved: bool
    """Whether the drive saved it."""
    error: ParameterError | None
    """Why it was not written."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> SettingChange:
        return cls(
            data["pnu"],
            data["index"],
            data["name"],
            None if data["old"] is None else Parameter._of(data["old"]),
            Parameter._of(data["new"]),
            data["asked"],
            data["rounded"],
            data["minimum"],
            data["maximum"],
            data["step"],
            data["same"],
            data["sent"],
            data["written"],
            data["differs"],
            None if data["read_back"] is None else Parameter._of(data["read_back"]),
            data["can_be_kept"],
            data["saved"],
            None if data["error"] is None else ParameterError._of(data["error"]),
        )


@dataclass(frozen=True, slots=True)
class WriteReport:
    """Parameters that were written, or in a dry run would be."""

    drive: str
    """The drive."""
    dry_run: bool
    """Whether nothing was written."""
    changes: tuple[SettingChange, ...]
    """The changes in the order of the request, then the command that saves."""
    controller: Controller | None
    """Who has the cyclic connection of the drive; null where it does not report that."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> WriteReport:
        return cls(
            data["drive"],
            data["dry_run"],
            tuple(SettingChange._of(item) for item in data["changes"]),
            None if data["controller"] is None else Controller._of(data["controller"]),
        )


@dataclass(frozen=True, slots=True)
class StopReport:
    """What became of a stop."""

    drive: str
    """The drive."""
    sent: str | None
    """What was sent; `None` when the axis was at rest already, or its power stage off: then no command holds it."""
    speed_before: Quantity | None
    """Speed before; in `%` of the reference where it is not known in `rpm`."""
    speed: Quantity | None
    """Speed at the end, likewise."""
    enabled: bool | None
    """The power stage is on at the end."""
    at_rest: bool
    """The axis stands, and is off where that was requested."""
    controller: Controller | None
    """The controller that goes on commanding the drive; null where it does not report that."""
    unread: str | None
    """Why parameters of the drive could not be read."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> StopReport:
        return cls(
            data["drive"],
            data["sent"],
            None if data["speed_before"] is None else Quantity._of(data["speed_before"]),
            None if data["speed"] is None else Quantity._of(data["speed"]),
            data["enabled"],
            data["at_rest"],
            None if data["controller"] is None else Controller._of(data["controller"]),
            data["unread"],
        )


@dataclass(frozen=True, slots=True)
class Frames:
    """Cyclic frames of a motion."""

    received: int | None
    """Received."""
    missed: int | None
    """Lost between them, by their counter."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Frames:
        return cls(
            data["received"],
            data["missed"],
        )


@dataclass(frozen=True, slots=True)
class PutBack:
    """A setting that was changed for a motion, after it."""

    parameter: str | None
    """The parameter; null where mode and telegram of the drive cannot be read."""
    number: str | None
    """Its number as its vendor writes it: `930`, `p1004`."""
    value: str | None
    """Its value from before the motion."""
    failed: str | None
    """Why it does not have that value again; null where it has."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> PutBack:
        return cls(
            data["parameter"],
            data["number"],
            data["value"],
            data["failed"],
        )


@dataclass(frozen=True, slots=True)
class MoveReport:
    """A move as it travels, with everything that speaks against it."""

    drive: str
    """The drive."""
    from_: Quantity | None
    """Where the axis is."""
    target: Quantity | None
    """Where it goes."""
    speed: Quantity
    """Speed as the drive takes it."""
    acceleration: Quantity
    """Acceleration as the drive takes it."""
    deceleration: Quantity
    """Deceleration as the drive takes it."""
    duration: float | None
    """Computed time, s."""
    satzanw: int
    """SATZANW."""
    mdi_tarpos: int
    """MDI_TARPOS."""
    mdi_velocity: int
    """MDI_VELOCITY."""
    mdi_acc: int
    """MDI_ACC."""
    mdi_dec: int
    """MDI_DEC."""
    mdi_mod: int
    """MDI_MOD."""
    objections: tuple[str, ...]
    """What speaks against it."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> MoveReport:
        return cls(
            data["drive"],
            None if data["from"] is None else Quantity._of(data["from"]),
            None if data["target"] is None else Quantity._of(data["target"]),
            Quantity._of(data["speed"]),
            Quantity._of(data["acceleration"]),
            Quantity._of(data["deceleration"]),
            data["duration"],
            data["satzanw"],
            data["mdi_tarpos"],
            data["mdi_velocity"],
            data["mdi_acc"],
            data["mdi_dec"],
            data["mdi_mod"],
            tuple(item for item in data["objections"]),
        )


@dataclass(frozen=True, slots=True)
class MotionReport:
    """A motion that ended, or faults that were acknowledged."""

    released: bool
    """Control of the axis was taken and given back. False where the connection was lost, and where control was not needed:
there is no fault to acknowledge, or a parameter acknowledges it."""
    rest: str
    """How the axis was when control of it was given back: `stands`, `coasts`, `runs`, or `unknown` where the drive
reported nothing any more or was not under control."""
    coasts: bool
    """The axis turned with its power stage off when control of it was given back."""
    interrupted: bool
    """The caller stopped it before its end."""
    frames: Frames
    """Counters of the cyclic connection; a serial line has none."""
    put_back: tuple[PutBack, ...]
    """The settings that were changed for it, after their values from before were written."""
    reached: bool
    """The speed, the target or the home position was reached, or no fault is left."""
    speed: Quantity | None
    """Speed of the motor before the stop, where the telegram carries it."""
    highest_speed: Quantity | None
    """Highest speed of the motor by its amount."""
    time_at_speed: float | None
    """Time at the speed of a run or a jog, s."""
    distance: Quantity | None
    """How far the axis went until its release: by its position, else by its speed in rpm over time."""
    position: Quantity | None
    """Where the axis was at its target or home position."""
    left_to: Quantity | None
    """Where it is since the power stage is off, if that is another place."""
    homed: bool | None
    """Whether the axis has its home position, after homing."""
    task: int | None
    """Number of the motion task."""
    active_task: int | None
    """The motion task that the drive reported last (AKTSATZ)."""
    plan: MoveReport | None
    """The move."""
    acknowledged: bool | None
    """Whether there were faults to acknowledge, where that was requested."""
    faults: tuple[Fault, ...]
    """The faults that are left, where they were to be acknowledged."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> MotionReport:
        return cls(
            data["released"],
            data["rest"],
            data["coasts"],
            data["interrupted"],
            Frames._of(data["frames"]),
            tuple(PutBack._of(item) for item in data["put_back"]),
            data["reached"],
            None if data["speed"] is None else Quantity._of(data["speed"]),
            None if data["highest_speed"] is None else Quantity._of(data["highest_speed"]),
            data["time_at_speed"],
            None if data["distance"] is None else Quantity._of(data["distance"]),
            None if data["position"] is None else Quantity._of(data["position"]),
            None if data["left_to"] is None else Quantity._of(data["left_to"]),
            data["homed"],
            data["task"],
            data["active_task"],
            None if data["plan"] is None else MoveReport._of(data["plan"]),
            data["acknowledged"],
            tuple(Fault._of(item) for item in data["faults"]),
        )


@dataclass(frozen=True, slots=True)
class AxisState:
    """An axis at one moment."""

    time: float
    """Seconds since control was taken."""
    state: DriveState | None
    """State of the drive."""
    profile: str
    """Whose words these are: `PROFIdrive`, `FC profile`, .."""
    mode: str
    """Mode that decides over the bits: `velocity` or `position`."""
    stw1: Word | None
    """Control word that the drive acts on."""
    zsw1: Word | None
    """Status word of the drive."""
    fault_bit: bool | None
    """Whether the status word reports a fault."""
    warning_bit: bool | None
    """Whether the status word reports a warning."""
    connected: bool
    """False when the connection is lost: then all of this was reported before."""
    speed_set: Quantity | None
    """Speed that is commanded."""
    speed_actual: Quantity | None
    """Speed of the motor."""
    target: Quantity | None
    """Position that a move leads to."""
    position: Quantity | None
    """Position of the axis."""
    following_error: Quantity | None
    """Commanded position minus position."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> AxisState:
        return cls(
            _number(data["time"]),
            None if data["state"] is None else DriveState(data["state"]),
            data["profile"],
            data["mode"],
            None if data["stw1"] is None else Word._of(data["stw1"]),
            None if data["zsw1"] is None else Word._of(data["zsw1"]),
            data["fault_bit"],
            data["warning_bit"],
            data["connected"],
            None if data["speed_set"] is None else Quantity._of(data["speed_set"]),
            None if data["speed_actual"] is None else Quantity._of(data["speed_actual"]),
            None if data["target"] is None else Quantity._of(data["target"]),
            None if data["position"] is None else Quantity._of(data["position"]),
            None if data["following_error"] is None else Quantity._of(data["following_error"]),
        )


@dataclass(frozen=True, slots=True)
class ValueText:
    """A value, or a bit, and what it means."""

    value: int
    """The value, or the number of the bit."""
    text: str
    """What it means."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ValueText:
        return cls(
            data["value"],
            data["text"],
        )


@dataclass(frozen=True, slots=True)
class ParameterDescription:
    """A parameter as the tables of a model have it."""

    pnu: int
    """Parameter number."""
    index: int | None
    """Element of a number that collects parameters."""
    number: str
    """The number as the vendor writes it: `p2108`, `1-20`, `ID 103`."""
    name: str
    """The vendor's name."""
    common_names: tuple[str, ...]
    """Names that mean the same on the drives of every vendor: `ramp-up`."""
    description: str
    """What it is."""
    unit: str
    """Unit of the value, empty for none."""
    access: str
    """`read`, `read, write` or `command`."""
    elements: int
    """Number of elements."""
    octets: int
    """Octets of one element."""
    signed: bool
    """Whether the number has a sign."""
    high: int | None
    """Parameter number of the high half of a 64-bit value."""
    saved: bool
    """Whether the drive can keep the value over a power cycle."""
    minimum: float | None
    """Lowest value; null where only the data type limits it."""
    maximum: float | None
    """Highest value; null where only the data type limits it."""
    default: float | None
    """Value as delivered."""
    choices: tuple[ValueText, ...]
    """The values of a list."""
    bits: tuple[ValueText, ...]
    """The bits of a word."""
    source: str
    """Where this is from: manual and section."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ParameterDescription:
        return cls(
            data["pnu"],
            data["index"],
            data["number"],
            data["name"],
            tuple(item for item in data["common_names"]),
            data["description"],
            data["unit"],
            data["access"],
            data["elements"],
            data["octets"],
            data["signed"],
            data["high"],
            data["saved"],
            data["minimum"],
            data["maximum"],
            data["default"],
            tuple(ValueText._of(item) for item in data["choices"]),
            tuple(ValueText._of(item) for item in data["bits"]),
            data["source"],
        )


@dataclass(frozen=True, slots=True)
class ReportedDescription:
    """A parameter as a drive describes it."""

    name: str | None
    """Name in the words of the drive."""
    data_type: str | None
    """Name of the data type."""
    unit: str
    """Unit of the limits."""
    minimum: float | None
    """Lowest value; null where only the data type limits it."""
    maximum: float | None
    """Highest value; null where only the data type limits it."""
    elements: int
    """Number of elements."""
    read_only: bool
    """Whether it cannot be written."""
    changed: bool
    """Whether it differs from the value as delivered."""
    texts: tuple[ValueText, ...]
    """Texts of its values."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ReportedDescription:
        return cls(
            data["name"],
            data["data_type"],
            data["unit"],
            data["minimum"],
            data["maximum"],
            data["elements"],
            data["read_only"],
            data["changed"],
            tuple(ValueText._of(item) for item in data["texts"]),
        )


@dataclass(frozen=True, slots=True)
class DescribeReport:
    """One parameter in full."""

    drive: str
    """The drive."""
    model: str
    """Name of its model."""
    parameter: ParameterDescription | None
    """The parameter as the tables have it; null where they do not."""
    saved_by: str | None
    """What lets the drive save the value over a power cycle: `nothing`, `every-write`, `request` (a write that requests it) or
`command` (for all values at once); null where it is in no table."""
    scaling: str | None
    """How the number that travels becomes a value: `raw 1000 = 1 rpm/s`."""
    reported: ReportedDescription | None
    """How the drive describes it; null where it does not."""
    values: tuple[Parameter, ...]
    """Its values now."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DescribeReport:
        return cls(
            data["drive"],
            data["model"],
            None if data["parameter"] is None else ParameterDescription._of(data["parameter"]),
            data["saved_by"],
            data["scaling"],
            None if data["reported"] is None else ReportedDescription._of(data["reported"]),
            tuple(Parameter._of(item) for item in data["values"]),
        )


@dataclass(frozen=True, slots=True)
class ListReport:
    """The parameters of a drive."""

    drive: str
    """The drive."""
    model: str
    """Name of its model."""
    parameters: tuple[ParameterDescription, ...]
    """The parameters as the tables have them."""
    numbers: tuple[int, ...]
    """Their numbers alone, for a drive without tables."""
    values: tuple[Parameter, ...]
    """Their values instead, where they were requested."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ListReport:
        return cls(
            data["drive"],
            data["model"],
            tuple(ParameterDescription._of(item) for item in data["parameters"]),
            tuple(item for item in data["numbers"]),
            tuple(Parameter._of(item) for item in data["values"]),
        )


@dataclass(frozen=True, slots=True)
class Station:
    """A station on the network, as it answers to discovery."""

    name: str | None
    """Name of station."""
    mac: str
    """Ethernet address."""
    ip: str | None
    """IP address."""
    mask: str | None
    """Subnet mask."""
    prefix: int | None
    """Prefix length of the subnet mask."""
    gateway: str | None
    """Gateway."""
    vendor_id: int
    """VendorID."""
    vendor: str | None
    """Name of the vendor, where it is in the tables."""
    device_id: int
    """DeviceID."""
    instance: int
    """Instance of the device."""
    type: str
    """Type of station in the vendor's words."""
    role: str | None
    """`device`, `controller` or `supervisor`."""
    model: str | None
    """Model whose tables are built in: `AKD`, `VLT`, `Vacon`."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Station:
        return cls(
            data["name"],
            data["mac"],
            data["ip"],
            data["mask"],
            data["prefix"],
            data["gateway"],
            data["vendor_id"],
            data["vendor"],
            data["device_id"],
            data["instance"],
            data["type"],
            data["role"],
            data["model"],
        )


@dataclass(frozen=True, slots=True)
class Identity:
    """Identification and maintenance records."""

    vendor_id: int
    """Vendor."""
    order_id: str
    """Order number."""
    serial_number: str
    """Serial number."""
    hardware_revision: int
    """Hardware revision."""
    software_revision: str
    """Software revision."""
    profile_id: int
    """Profile, 0x3A00 for PROFIdrive."""
    profile_type: int
    """Type within the profile."""
    function: str
    """Function (I&M1)."""
    location: str
    """Location (I&M1)."""
    installed: str
    """Installation date (I&M2)."""
    descriptor: str
    """Descriptor (I&M3)."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Identity:
        return cls(
            data["vendor_id"],
            data["order_id"],
            data["serial_number"],
            data["hardware_revision"],
            data["software_revision"],
            data["profile_id"],
            data["profile_type"],
            data["function"],
            data["location"],
            data["installed"],
            data["descriptor"],
        )


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A station at the other end of a cable."""

    own_port: str
    """The drive's own port."""
    port: str
    """The port of the neighbour."""
    station: str | None
    """Name of the neighbour."""
    mac: str
    """Its Ethernet address."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Neighbour:
        return cls(
            data["own_port"],
            data["port"],
            data["station"],
            data["mac"],
        )


@dataclass(frozen=True, slots=True)
class Submodule:
    """A submodule that is plugged."""

    subslot: int
    """Subslot."""
    ident: int
    """Ident number."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Submodule:
        return cls(
            data["subslot"],
            data["ident"],
        )


@dataclass(frozen=True, slots=True)
class Module:
    """A module that is plugged."""

    api: int
    """API."""
    slot: int
    """Slot."""
    ident: int
    """Ident number."""
    submodules: tuple[Submodule, ...]
    """Its submodules."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Module:
        return cls(
            data["api"],
            data["slot"],
            data["ident"],
            tuple(Submodule._of(item) for item in data["submodules"]),
        )


@dataclass(frozen=True, slots=True)
class Software:
    """Software of a drive unit or of a drive object: `manufacturer 261 (0x0105), type 100, software 1.15, 2017-10-01`."""

    manufacturer: int
    """Number of the manufacturer."""
    kind: int
    """Type, a number of the manufacturer."""
    version: str
    """Version."""
    date: str
    """Date, YYYY-MM-DD."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Software:
        return cls(
            data["manufacturer"],
            data["kind"],
            data["version"],
            data["date"],
        )


@dataclass(frozen=True, slots=True)
class ProfileVersion:
    """The profile of a drive: `3 PROFIdrive, version 4.1`."""

    number: int
    """Number of the profile; 3 is PROFIdrive."""
    version: str
    """Version."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ProfileVersion:
        return cls(
            data["number"],
            data["version"],
        )


@dataclass(frozen=True, slots=True)
class DriveObject:
    """One axis, or another object, of a drive unit."""

    manufacturer: int
    """Number of the manufacturer."""
    kind: int
    """Type, a number of the manufacturer."""
    version: str
    """Version."""
    date: str
    """Date, YYYY-MM-DD."""
    class_: int | None
    """Class: 1 is an axis, 5 an encoder."""
    id: int | None
    """DO-ID."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DriveObject:
        return cls(
            data["manufacturer"],
            data["kind"],
            data["version"],
            data["date"],
            data["class"],
            data["id"],
        )


@dataclass(frozen=True, slots=True)
class ProfileIdentity:
    """What a drive says about itself, beside its identification records. What it does not have is null."""

    drive_unit: Software | None
    """The drive unit (PNU 964)."""
    profile: ProfileVersion | None
    """The profile (PNU 965)."""
    drive_object: DriveObject | None
    """The drive object (PNU 975)."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ProfileIdentity:
        return cls(
            None if data["drive_unit"] is None else Software._of(data["drive_unit"]),
            None if data["profile"] is None else ProfileVersion._of(data["profile"]),
            None if data["drive_object"] is None else DriveObject._of(data["drive_object"]),
        )


@dataclass(frozen=True, slots=True)
class InfoReport:
    """Who a drive is and in which state."""

    drive: str
    """The drive as it was called."""
    model: str
    """Name of its model."""
    is_drive: bool
    """Whether it is a drive."""
    station: Station
    """How it answers to discovery."""
    identity: Identity | None
    """Its identification records (I&M0 to I&M3)."""
    state: DriveState | None
    """State of the drive."""
    profile: str
    """Whose words these are: `PROFIdrive`, `FC profile`, .."""
    mode: str
    """Mode that decides over the bits: `velocity` or `position`."""
    stw1: Word | None
    """Control word that the drive acts on."""
    zsw1: Word | None
    """Status word of the drive."""
    fault_bit: bool | None
    """Whether the status word reports a fault."""
    warning_bit: bool | None
    """Whether the status word reports a warning."""
    controller: Controller | None
    """Who has its cyclic connection; null where it does not report that."""
    neighbours: tuple[Neighbour, ...]
    """Who is at the other end of its cables."""
    modules: tuple[Module, ...]
    """The modules that are plugged."""
    route: str | None
    """How its records were read: `device access`, `implicit reads`, `connection as IO controller`."""
    identification: ProfileIdentity
    """What its identification parameters (PNU 964, 965 and 975) say."""
    parameters: tuple[Parameter, ...]
    """The parameters that identify it."""
    faults: tuple[Fault, ...]
    """Its fault buffer."""
    refused: tuple[str, ...]
    """Records and parameters that it refused, with its reason."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> InfoReport:
        return cls(
            data["drive"],
            data["model"],
            data["is_drive"],
            Station._of(data["station"]),
            None if data["identity"] is None else Identity._of(data["identity"]),
            None if data["state"] is None else DriveState(data["state"]),
            data["profile"],
            data["mode"],
            None if data["stw1"] is None else Word._of(data["stw1"]),
            None if data["zsw1"] is None else Word._of(data["zsw1"]),
            data["fault_bit"],
            data["warning_bit"],
            None if data["controller"] is None else Controller._of(data["controller"]),
            tuple(Neighbour._of(item) for item in data["neighbours"]),
            tuple(Module._of(item) for item in data["modules"]),
            data["route"],
            ProfileIdentity._of(data["identification"]),
            tuple(Parameter._of(item) for item in data["parameters"]),
            tuple(Fault._of(item) for item in data["faults"]),
            tuple(item for item in data["refused"]),
        )


class Remark(str, Enum):
    """What is to be known about the name or the address of a station."""

    NO_NAME = "no_name"
    """It has no name: no controller finds it."""
    NO_ADDRESS = "no_address"
    """It has no IP address: nothing can be read."""
    OTHER_SUBNET = "other_subnet"
    """It is in another subnet and has no gateway: no answer can come to this computer."""
    ROUTED = "routed"
    """It is in another subnet: it takes a router between them."""
    NAME_TWICE = "name_twice"
    """Another station has the same name."""
    ADDRESS_TWICE = "address_twice"
    """Another station has the same address."""
    CONFLICT = "conflict"
    """It reports itself that another station has its address."""


@dataclass(frozen=True, slots=True)
class Scanned:
    """A station that answered."""

    name: str | None
    """Name of station."""
    mac: str
    """Ethernet address."""
    ip: str | None
    """IP address."""
    mask: str | None
    """Subnet mask."""
    prefix: int | None
    """Prefix length of the subnet mask."""
    gateway: str | None
    """Gateway."""
    vendor_id: int
    """VendorID."""
    vendor: str | None
    """Name of the vendor, where it is in the tables."""
    device_id: int
    """DeviceID."""
    instance: int
    """Instance of the device."""
    type: str
    """Type of station in the vendor's words."""
    role: str | None
    """`device`, `controller` or `supervisor`."""
    model: str | None
    """Model whose tables are built in: `AKD`, `VLT`, `Vacon`."""
    remarks: tuple[Remark, ...]
    """What is to be known about its name and its address."""
    info: InfoReport | None
    """Its own description; null where it was not read."""
    unread: str | None
    """Why it was not read, or what of it was not answered; null where all was read, or where this was not requested."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Scanned:
        return cls(
            data["name"],
            data["mac"],
            data["ip"],
            data["mask"],
            data["prefix"],
            data["gateway"],
            data["vendor_id"],
            data["vendor"],
            data["device_id"],
            data["instance"],
            data["type"],
            data["role"],
            data["model"],
            tuple(Remark(item) for item in data["remarks"]),
            None if data["info"] is None else InfoReport._of(data["info"]),
            data["unread"],
        )


@dataclass(frozen=True, slots=True)
class ScanReport:
    """The stations on a network."""

    stations: tuple[Scanned, ...]
    """The stations that answered."""
    more: bool
    """Whether more stations answered than one search takes; those are missing here."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ScanReport:
        return cls(
            tuple(Scanned._of(item) for item in data["stations"]),
            data["more"],
        )

    def __len__(self) -> int:
        return len(self.stations)

    def __iter__(self) -> Iterator[Scanned]:
        return iter(self.stations)

    def __getitem__(self, place: int) -> Scanned:
        return self.stations[place]

    def _repr_html_(self) -> str:
        """The stations in a table, for notebooks."""
        from profidrive._render import stations

        return stations(self)


@dataclass(frozen=True, slots=True)
class NameReport:
    """A new name of a station."""

    mac: str
    """Ethernet address of the station."""
    old: str | None
    """Its name before."""
    name: str | None
    """Its name now; null where it was taken away."""
    permanent: bool
    """Whether the name is kept over power-off."""
    dry_run: bool
    """Whether nothing was changed."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> NameReport:
        return cls(
            data["mac"],
            data["old"],
            data["name"],
            data["permanent"],
            data["dry_run"],
        )


@dataclass(frozen=True, slots=True)
class IpReport:
    """A new IP address of a station."""

    mac: str
    """Ethernet address of the station."""
    name: str | None
    """Its name."""
    ip: str
    """Its IP address."""
    mask: str
    """Its subnet mask."""
    gateway: str | None
    """Its gateway."""
    permanent: bool
    """Whether the address is kept over power-off."""
    dry_run: bool
    """Whether nothing was changed."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> IpReport:
        return cls(
            data["mac"],
            data["name"],
            data["ip"],
            data["mask"],
            data["gateway"],
            data["permanent"],
            data["dry_run"],
        )


@dataclass(frozen=True, slots=True)
class BlinkReport:
    """A station that blinked."""

    mac: str
    """Ethernet address of the station."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> BlinkReport:
        return cls(
            data["mac"],
        )


@dataclass(frozen=True, slots=True)
class NumberedTask:
    """A motion task with its number."""

    number: int
    """Number of the task."""
    empty: bool
    """Whether it has no values."""
    values: tuple[Parameter, ...]
    """Its values."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> NumberedTask:
        return cls(
            data["number"],
            data["empty"],
            tuple(Parameter._of(item) for item in data["values"]),
        )


@dataclass(frozen=True, slots=True)
class BackupReport:
    """The settings of a drive."""

    drive: str
    """The drive."""
    model: str
    """Name of its model."""
    file: str | None
    """The file that was written."""
    parameters: tuple[Parameter, ...]
    """The settings."""
    refused: tuple[Parameter, ...]
    """The settings that could not be read, with the reason."""
    tasks: tuple[NumberedTask, ...] | None
    """The motion tasks; null where they are left out."""
    complete: bool
    """Whether no setting and no motion task is missing."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> BackupReport:
        return cls(
            data["drive"],
            data["model"],
            data["file"],
            tuple(Parameter._of(item) for item in data["parameters"]),
            tuple(Parameter._of(item) for item in data["refused"]),
            None if data["tasks"] is None else tuple(NumberedTask._of(item) for item in data["tasks"]),
            data["complete"],
        )


@dataclass(frozen=True, slots=True)
class Difference:
    """A setting that differs."""

    pnu: int | None
    """Parameter number."""
    index: int | None
    """Element of an array."""
    name: str | None
    """The vendor's name."""
    connection: bool
    """Whether a controller decides it by connecting: telegram, mapping, command source, address."""
    left: Parameter | None
    """The value on the left; null where it is missing."""
    right: Parameter | None
    """The value on the right; null where it is missing."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Difference:
        return cls(
            data["pnu"],
            data["index"],
            data["name"],
            data["connection"],
            None if data["left"] is None else Parameter._of(data["left"]),
            None if data["right"] is None else Parameter._of(data["right"]),
        )


@dataclass(frozen=True, slots=True)
class MotionTask:
    """A motion task of the drive's own table."""

    empty: bool
    """Whether it has no values."""
    values: tuple[Parameter, ...]
    """Its values."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> MotionTask:
        return cls(
            data["empty"],
            tuple(Parameter._of(item) for item in data["values"]),
        )


@dataclass(frozen=True, slots=True)
class TaskDifference:
    """A motion task that differs."""

    number: int
    """Number of the task."""
    left: MotionTask
    """The task on the left."""
    right: MotionTask
    """The task on the right."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> TaskDifference:
        return cls(
            data["number"],
            MotionTask._of(data["left"]),
            MotionTask._of(data["right"]),
        )


@dataclass(frozen=True, slots=True)
class NetworkDifference:
    """Something in name or address that differs."""

    setting: str
    """`name of station`, `IP address`, `subnet mask` or `gateway`."""
    left: str
    """What it is on the left; empty for no name."""
    right: str
    """What it is on the right; empty for no name."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> NetworkDifference:
        return cls(
            data["setting"],
            data["left"],
            data["right"],
        )


@dataclass(frozen=True, slots=True)
class DiffReport:
    """What differs between two sets of settings."""

    left: str
    """File or drive on the left."""
    right: str
    """File or drive on the right."""
    differences: tuple[Difference, ...]
    """The settings that differ."""
    tasks: tuple[TaskDifference, ...]
    """The motion tasks that differ."""
    network: tuple[NetworkDifference, ...]
    """What differs in name and address. A restore does not write it, and it does not count as a difference."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DiffReport:
        return cls(
            data["left"],
            data["right"],
            tuple(Difference._of(item) for item in data["differences"]),
            tuple(TaskDifference._of(item) for item in data["tasks"]),
            tuple(NetworkDifference._of(item) for item in data["network"]),
        )

    def _repr_html_(self) -> str:
        """The differences in a table, for notebooks."""
        from profidrive._render import differences

        return differences(self)


@dataclass(frozen=True, slots=True)
class SkippedSetting:
    """A setting of a file that is not written."""

    why: str
    """Why."""
    refused: bool
    """Whether that is because the drive cannot have it."""
    setting: Parameter
    """The setting in the file."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> SkippedSetting:
        return cls(
            data["why"],
            data["refused"],
            Parameter._of(data["setting"]),
        )


@dataclass(frozen=True, slots=True)
class MotionTaskChange:
    """A motion task that is changed."""

    number: int
    """Number of the task."""
    old: MotionTask
    """The task before."""
    new: MotionTask
    """The task that the drive is to have."""
    step: str
    """How far it is, as for a setting."""
    error: ParameterError | None
    """Why it was not written."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> MotionTaskChange:
        return cls(
            data["number"],
            MotionTask._of(data["old"]),
            MotionTask._of(data["new"]),
            data["step"],
            None if data["error"] is None else ParameterError._of(data["error"]),
        )


@dataclass(frozen=True, slots=True)
class RestoreReport:
    """Settings that were restored, or in a dry run would be."""

    drive: str
    """The drive."""
    file: str
    """The file with the settings."""
    dry_run: bool
    """Whether nothing was written."""
    complete: bool
    """Whether everything that was to be written is written and read back."""
    saved: bool
    """Whether the drive saved it."""
    way_back: str | None
    """The file with the values before; null where nothing was written."""
    changes: tuple[SettingChange, ...]
    """The values."""
    skipped: tuple[SkippedSetting, ...]
    """What is in the file and is not written."""
    tasks: tuple[MotionTaskChange, ...]
    """The motion tasks."""
    tasks_left_out: str | None
    """Why no motion task of the file is written."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> RestoreReport:
        return cls(
            data["drive"],
            data["file"],
            data["dry_run"],
            data["complete"],
            data["saved"],
            data["way_back"],
            tuple(SettingChange._of(item) for item in data["changes"]),
            tuple(SkippedSetting._of(item) for item in data["skipped"]),
            tuple(MotionTaskChange._of(item) for item in data["tasks"]),
            data["tasks_left_out"],
        )


@dataclass(frozen=True, slots=True)
class GsdmlProblem:
    """Something that is against the rules."""

    severity: str
    """`warning`, `error` or `unusable`."""
    rule: str
    """Name of the rule."""
    line: int
    """Line in the file, from 1."""
    column: int
    """Column in the line, from 1."""
    message: str
    """What is wrong."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlProblem:
        return cls(
            data["severity"],
            data["rule"],
            data["line"],
            data["column"],
            data["message"],
        )


@dataclass(frozen=True, slots=True)
class GsdmlCheckReport:
    """What is against the rules in a device description."""

    file: str
    """The file."""
    sound: bool
    """Whether nothing is against the rules."""
    usable: bool
    """Whether the file can be used."""
    problems: tuple[GsdmlProblem, ...]
    """What was found."""
    left_out: int
    """Problems that were found and are not listed."""
    pictures: tuple[str, ...]
    """What is wrong with the pictures beside the file."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlCheckReport:
        return cls(
            data["file"],
            data["sound"],
            data["usable"],
            tuple(GsdmlProblem._of(item) for item in data["problems"]),
            data["left_out"],
            tuple(item for item in data["pictures"]),
        )


@dataclass(frozen=True, slots=True)
class GsdmlItem:
    """A value in cyclic data."""

    type: str
    """Data type."""
    octets: int
    """Length in octets."""
    name: str
    """Name."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlItem:
        return cls(
            data["type"],
            data["octets"],
            data["name"],
        )


@dataclass(frozen=True, slots=True)
class GsdmlSubmodule:
    """A submodule. What the system defines, interface and ports, has no identifier and no name."""

    id: str | None
    """Identifier in the file."""
    name: str | None
    """Name."""
    subslots: str
    """Subslots where it may be."""
    pluggable: bool
    """Whether it can be left out."""
    ident: int
    """Ident number."""
    api: int
    """API, 0x3A00 for PROFIdrive."""
    input: int
    """Octets of input data."""
    output: int
    """Octets of output data."""
    input_items: tuple[GsdmlItem, ...]
    """The input data."""
    output_items: tuple[GsdmlItem, ...]
    """The output data."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlSubmodule:
        return cls(
            data["id"],
            data["name"],
            data["subslots"],
            data["pluggable"],
            data["ident"],
            data["api"],
            data["input"],
            data["output"],
            tuple(GsdmlItem._of(item) for item in data["input_items"]),
            tuple(GsdmlItem._of(item) for item in data["output_items"]),
        )


@dataclass(frozen=True, slots=True)
class GsdmlSystemSubmodule:
    """A submodule that PROFINET defines: the interface or a port."""

    subslot: int
    """Its subslot, from 0x8000."""
    ident: int
    """Ident number."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlSystemSubmodule:
        return cls(
            data["subslot"],
            data["ident"],
        )


@dataclass(frozen=True, slots=True)
class GsdmlAccessPoint:
    """An access point: a variant of the device on the network."""

    id: str
    """Identifier in the file."""
    name: str
    """Name."""
    order_number: str | None
    """Order number."""
    hardware: str | None
    """Hardware release."""
    software: str | None
    """Software release."""
    module_ident: int
    """Ident number."""
    slots: str
    """Slots: `0..2`."""
    min_device_interval: int
    """Shortest update time, in steps of 31.25 us."""
    instance: int
    """Instance of the device."""
    reset_modes: str
    """Modes of a reset to factory values."""
    max_input: int
    """Most octets of input data."""
    max_output: int
    """Most octets of output data."""
    submodules: tuple[GsdmlSubmodule, ...]
    """Its own submodules."""
    interface: GsdmlSystemSubmodule | None
    """The submodule of its interface."""
    ports: tuple[GsdmlSystemSubmodule, ...]
    """The submodules of its ports."""
    conformance_class: str | None
    """Conformance class: `A`, `B` or `C`."""
    modules: tuple[str, ...]
    """Identifiers of the modules that fit."""
    rt_classes: tuple[str, ...]
    """Classes of real-time communication."""
    start_up: tuple[str, ...]
    """Modes of start-up."""
    protocols: tuple[str, ...]
    """Other protocols: `SNMP`, `LLDP`."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlAccessPoint:
        return cls(
            data["id"],
            data["name"],
            data["order_number"],
            data["hardware"],
            data["software"],
            data["module_ident"],
            data["slots"],
            data["min_device_interval"],
            data["instance"],
            data["reset_modes"],
            data["max_input"],
            data["max_output"],
            tuple(GsdmlSubmodule._of(item) for item in data["submodules"]),
            None if data["interface"] is None else GsdmlSystemSubmodule._of(data["interface"]),
            tuple(GsdmlSystemSubmodule._of(item) for item in data["ports"]),
            data["conformance_class"],
            tuple(item for item in data["modules"]),
            tuple(item for item in data["rt_classes"]),
            tuple(item for item in data["start_up"]),
            tuple(item for item in data["protocols"]),
        )


@dataclass(frozen=True, slots=True)
class GsdmlModule:
    """A module."""

    id: str
    """Identifier in the file."""
    name: str
    """Name."""
    ident: int
    """Ident number."""
    info: str
    """What it is."""
    slots: str
    """Slots where it may be."""
    submodules: tuple[GsdmlSubmodule, ...]
    """Its submodules."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlModule:
        return cls(
            data["id"],
            data["name"],
            data["ident"],
            data["info"],
            data["slots"],
            tuple(GsdmlSubmodule._of(item) for item in data["submodules"]),
        )


@dataclass(frozen=True, slots=True)
class GsdmlShowReport:
    """A device description."""

    schema_version: str | None
    """Version of GSDML; null where the file does not name one."""
    vendor_id: int
    """VendorID."""
    device_id: int
    """DeviceID."""
    vendor: str
    """Name of the vendor."""
    info: str
    """What the device is."""
    main_family: str
    """Main family: `Drives`."""
    product_family: str | None
    """Product family."""
    access_points: tuple[GsdmlAccessPoint, ...]
    """The access points."""
    modules: tuple[GsdmlModule, ...]
    """The modules of all access points."""
    texts: Mapping[str, str]
    """Texts of the primary language by their identifiers."""
    languages: Mapping[str, Mapping[str, str]]
    """The same of all other languages, by their tags."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> GsdmlShowReport:
        return cls(
            data["schema_version"],
            data["vendor_id"],
            data["device_id"],
            data["vendor"],
            data["info"],
            data["main_family"],
            data["product_family"],
            tuple(GsdmlAccessPoint._of(item) for item in data["access_points"]),
            tuple(GsdmlModule._of(item) for item in data["modules"]),
            {key: item for key, item in data["texts"].items()},
            {key: {key: item for key, item in item.items()} for key, item in data["languages"].items()},
        )


__all__ = [
    "Action",
    "AxisState",
    "BackupReport",
    "BlinkReport",
    "Controller",
    "DescribeReport",
    "DiffReport",
    "Difference",
    "DriveObject",
    "DriveState",
    "Fault",
    "FaultsReport",
    "Frames",
    "GsdmlAccessPoint",
    "GsdmlCheckReport",
    "GsdmlItem",
    "GsdmlModule",
    "GsdmlProblem",
    "GsdmlShowReport",
    "GsdmlSubmodule",
    "GsdmlSystemSubmodule",
    "Identity",
    "InfoReport",
    "IpReport",
    "ListReport",
    "LoadStatus",
    "LogEntry",
    "LossReaction",
    "Module",
    "MotionReport",
    "MotionTask",
    "MotionTaskChange",
    "MoveReport",
    "NameReport",
    "Neighbour",
    "NetworkDifference",
    "NumberedTask",
    "Parameter",
    "ParameterContent",
    "ParameterDescription",
    "ParameterError",
    "ParametersReport",
    "ProfileIdentity",
    "ProfileVersion",
    "PutBack",
    "Quantity",
    "Remark",
    "ReportedDescription",
    "RestoreReport",
    "ScanReport",
    "Scanned",
    "SettingChange",
    "SkippedSetting",
    "Software",
    "Station",
    "StatusNote",
    "StatusReport",
    "StopReport",
    "Submodule",
    "TaskDifference",
    "ValueText",
    "Warning",
    "Word",
    "WriteReport",
]
