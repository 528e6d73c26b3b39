# Generated from docs/schema by `cargo run -p xtask -- pages`. Do not edit.
"""Documents of the library as frozen data classes; their JSON schemas are in docs/schema."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeAlias

from profidrive.types import State as State


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
            number=data["number"],
            hex=data["hex"],
            bits=tuple(item for item in data["bits"]),
            meaning=data["meaning"],
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
            number=data["number"],
            meaning=data["meaning"],
            information=data["information"],
            remedy=data["remedy"],
            channel=data["channel"],
            sent=data["sent"],
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
            pnu=data["pnu"],
            index=data["index"],
            number=data["number"],
            name=data["name"],
            value=data["value"],
            text=data["text"],
            unit=data["unit"],
            meaning=data["meaning"],
            word=None if data["word"] is None else Word._of(data["word"]),
            beyond=data["beyond"],
            raw=data["raw"],
            hex=data["hex"],
            format=data["format"],
            writable=data["writable"],
            error=None if data["error"] is None else ParameterError._of(data["error"]),
        )


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
            drive=data["drive"],
            parameters=tuple(Parameter._of(item) for item in data["parameters"]),
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
            action=data["action"],
            arguments=tuple(item for item in data["arguments"]),
            command=data["command"],
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
            cause=data["cause"],
            sentence=data["sentence"],
            next=data["next"],
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
            connected=data["connected"],
            name=data["name"],
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
            value=_number(data["value"]),
            unit=data["unit"],
            beyond=data["beyond"],
        )


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
            position=None if data["position"] is None else Quantity._of(data["position"]),
            speed=None if data["speed"] is None else Quantity._of(data["speed"]),
            following_error=None if data["following_error"] is None else Quantity._of(data["following_error"]),
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
            action=data["action"],
            parameter=data["parameter"],
            setting=data["setting"],
            after=data["after"],
            text=data["text"],
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
            number=data["number"],
            meaning=data["meaning"],
            reaction=data["reaction"],
            remedy=data["remedy"],
            cleared=data["cleared"],
            needs_restart=data["needs_restart"],
            situation=data["situation"],
            position=data["position"],
            acknowledged=data["acknowledged"],
            time=data["time"],
            value=data["value"],
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

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Warning:
        return cls(
            number=data["number"],
            meaning=data["meaning"],
            remedy=data["remedy"],
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
            drive=data["drive"],
            verdict=data["verdict"],
            cause=data["cause"],
            sentence=data["sentence"],
            next=data["next"],
            actions=tuple(Action._of(item) for item in data["actions"]),
            notes=tuple(StatusNote._of(item) for item in data["notes"]),
            state=None if data["state"] is None else DriveState(data["state"]),
            profile=data["profile"],
            mode=data["mode"],
            stw1=None if data["stw1"] is None else Word._of(data["stw1"]),
            zsw1=None if data["zsw1"] is None else Word._of(data["zsw1"]),
            fault_bit=data["fault_bit"],
            warning_bit=data["warning_bit"],
            state_text=data["state_text"],
            controller=None if data["controller"] is None else Controller._of(data["controller"]),
            telegram=data["telegram"],
            operating_mode=data["operating_mode"],
            command_source=None if data["command_source"] is None else Word._of(data["command_source"]),
            disable_sources=None if data["disable_sources"] is None else Word._of(data["disable_sources"]),
            motion_disable_sources=None if data["motion_disable_sources"] is None else Word._of(data["motion_disable_sources"]),
            motion_status=None if data["motion_status"] is None else Word._of(data["motion_status"]),
            torque_allowed=data["torque_allowed"],
            homed=data["homed"],
            negative_switch=data["negative_switch"],
            positive_switch=data["positive_switch"],
            software_limits=data["software_limits"],
            bus_voltage=None if data["bus_voltage"] is None else Quantity._of(data["bus_voltage"]),
            speed_set=None if data["speed_set"] is None else Quantity._of(data["speed_set"]),
            speed_actual=None if data["speed_actual"] is None else Quantity._of(data["speed_actual"]),
            position=None if data["position"] is None else Quantity._of(data["position"]),
            following_error=None if data["following_error"] is None else Quantity._of(data["following_error"]),
            load=None if data["load"] is None else LoadStatus._of(data["load"]),
            on_loss=None if data["on_loss"] is None else LossReaction._of(data["on_loss"]),
            faults=tuple(Fault._of(item) for item in data["faults"]),
            warnings=tuple(Warning._of(item) for item in data["warnings"]),
        )


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
            number=data["number"],
            meaning=data["meaning"],
            value=data["value"],
            time=data["time"],
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
            drive=data["drive"],
            counter=data["counter"],
            counts=data["counts"],
            situations=data["situations"],
            faults_per_situation=data["faults_per_situation"],
            fault_bit=data["fault_bit"],
            warning_bit=data["warning_bit"],
            faults=tuple(Fault._of(item) for item in data["faults"]),
            acknowledged=data["acknowledged"],
            warnings=tuple(Warning._of(item) for item in data["warnings"]),
            log=tuple(LogEntry._of(item) for item in data["log"]),
            history=data["history"],
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
            pnu=data["pnu"],
            index=data["index"],
            name=data["name"],
            old=None if data["old"] is None else Parameter._of(data["old"]),
            new=Parameter._of(data["new"]),
            asked=data["asked"],
            rounded=data["rounded"],
            minimum=data["minimum"],
            maximum=data["maximum"],
            step=data["step"],
            same=data["same"],
            sent=data["sent"],
            written=data["written"],
            differs=data["differs"],
            read_back=None if data["read_back"] is None else Parameter._of(data["read_back"]),
            can_be_kept=data["can_be_kept"],
            saved=data["saved"],
            error=None if data["error"] is None else ParameterError._of(data["error"]),
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
            drive=data["drive"],
            dry_run=data["dry_run"],
            changes=tuple(SettingChange._of(item) for item in data["changes"]),
            controller=None if data["controller"] is None else Controller._of(data["controller"]),
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
            drive=data["drive"],
            sent=data["sent"],
            speed_before=None if data["speed_before"] is None else Quantity._of(data["speed_before"]),
            speed=None if data["speed"] is None else Quantity._of(data["speed"]),
            enabled=data["enabled"],
            at_rest=data["at_rest"],
            controller=None if data["controller"] is None else Controller._of(data["controller"]),
            unread=data["unread"],
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
            received=data["received"],
            missed=data["missed"],
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
            parameter=data["parameter"],
            number=data["number"],
            value=data["value"],
            failed=data["failed"],
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
            drive=data["drive"],
            from_=None if data["from"] is None else Quantity._of(data["from"]),
            target=None if data["target"] is None else Quantity._of(data["target"]),
            speed=Quantity._of(data["speed"]),
            acceleration=Quantity._of(data["acceleration"]),
            deceleration=Quantity._of(data["deceleration"]),
            duration=data["duration"],
            satzanw=data["satzanw"],
            mdi_tarpos=data["mdi_tarpos"],
            mdi_velocity=data["mdi_velocity"],
            mdi_acc=data["mdi_acc"],
            mdi_dec=data["mdi_dec"],
            mdi_mod=data["mdi_mod"],
            objections=tuple(item for item in data["objections"]),
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
            released=data["released"],
            rest=data["rest"],
            coasts=data["coasts"],
            interrupted=data["interrupted"],
            frames=Frames._of(data["frames"]),
            put_back=tuple(PutBack._of(item) for item in data["put_back"]),
            reached=data["reached"],
            speed=None if data["speed"] is None else Quantity._of(data["speed"]),
            highest_speed=None if data["highest_speed"] is None else Quantity._of(data["highest_speed"]),
            time_at_speed=data["time_at_speed"],
            distance=None if data["distance"] is None else Quantity._of(data["distance"]),
            position=None if data["position"] is None else Quantity._of(data["position"]),
            left_to=None if data["left_to"] is None else Quantity._of(data["left_to"]),
            homed=data["homed"],
            task=data["task"],
            active_task=data["active_task"],
            plan=None if data["plan"] is None else MoveReport._of(data["plan"]),
            acknowledged=data["acknowledged"],
            faults=tuple(Fault._of(item) for item in data["faults"]),
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
            time=_number(data["time"]),
            state=None if data["state"] is None else DriveState(data["state"]),
            profile=data["profile"],
            mode=data["mode"],
            stw1=None if data["stw1"] is None else Word._of(data["stw1"]),
            zsw1=None if data["zsw1"] is None else Word._of(data["zsw1"]),
            fault_bit=data["fault_bit"],
            warning_bit=data["warning_bit"],
            connected=data["connected"],
            speed_set=None if data["speed_set"] is None else Quantity._of(data["speed_set"]),
            speed_actual=None if data["speed_actual"] is None else Quantity._of(data["speed_actual"]),
            target=None if data["target"] is None else Quantity._of(data["target"]),
            position=None if data["position"] is None else Quantity._of(data["position"]),
            following_error=None if data["following_error"] is None else Quantity._of(data["following_error"]),
        )


__all__ = [
    "Action",
    "AxisState",
    "Controller",
    "DriveState",
    "Fault",
    "FaultsReport",
    "Frames",
    "LoadStatus",
    "LogEntry",
    "LossReaction",
    "MotionReport",
    "MoveReport",
    "Parameter",
    "ParameterContent",
    "ParameterError",
    "ParametersReport",
    "PutBack",
    "Quantity",
    "SettingChange",
    "StatusNote",
    "StatusReport",
    "StopReport",
    "Warning",
    "Word",
    "WriteReport",
]
