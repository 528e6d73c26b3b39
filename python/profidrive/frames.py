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


@dataclass(frozen=True, slots=True)
class CaptureSample:
    """A value in cyclic data."""

    slot: int
    """Slot of the drive."""
    subslot: int
    """Subslot of the drive."""
    signal: str
    """Name of the signal."""
    raw: int
    """The number in the frame."""
    value: float
    """The value in `unit`."""
    unit: str
    """Unit of `value`."""
    assumed: str | None
    """What the value rests on that the capture does not show."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureSample:
        return cls(
            data["slot"],
            data["subslot"],
            data["signal"],
            data["raw"],
            _number(data["value"]),
            data["unit"],
            data.get("assumed"),
        )


@dataclass(frozen=True, slots=True)
class CaptureState:
    """A control or status word."""

    slot: int
    """Slot of the drive."""
    subslot: int
    """Subslot of the drive."""
    telegram: int | None
    """Number of the telegram, where it is known."""
    word: str
    """`STW1`, `ZSW1`, or the vendor's name of the word."""
    before: int | None
    """Its value before; `None` for the first one of a connection."""
    value: int
    """Its value."""
    speed: CaptureSample | None
    """The speed beside it, where the telegram has one."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureState:
        return cls(
            data["slot"],
            data["subslot"],
            data["telegram"],
            data["word"],
            data["before"],
            data["value"],
            None if data["speed"] is None else CaptureSample._of(data["speed"]),
        )


@dataclass(frozen=True, slots=True)
class CaptureJob:
    """A parameter request or response."""

    channel: str
    """`record` (base mode parameter access) or `pkw` (parameter channel in cyclic data)."""
    request_frame: int | None
    """Frame of the request, in a response."""
    document: Mapping[str, object]
    """Its JSON document, with all that it has."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureJob:
        return cls(
            data["channel"],
            data.get("request_frame"),
            data,
        )


@dataclass(frozen=True, slots=True)
class CaptureDcpResult:
    """The answer to one block of a DCP Set."""

    option: int
    """Option."""
    suboption: int
    """Suboption."""
    error: int
    """BlockError: 0 ok."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureDcpResult:
        return cls(
            data["option"],
            data["suboption"],
            data["error"],
        )


@dataclass(frozen=True, slots=True)
class CaptureDcp:
    """A DCP service."""

    service: str
    """`identify`, `get`, `set` or `hello`."""
    response: bool
    """False for a request, true for an answer."""
    xid: int
    """Transaction number."""
    name: str | None
    """Name of station requested, set or reported."""
    ip: str | None
    """IP address requested, set or reported."""
    prefix: int | None
    """Prefix length of the IP address."""
    vendor: int | None
    """VendorID and DeviceID."""
    device: int | None
    """DeviceID."""
    results: tuple[CaptureDcpResult, ...]
    """What a set request was answered: option, suboption and BlockError of each block."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureDcp:
        return cls(
            data["service"],
            data["response"],
            data["xid"],
            data["name"],
            data["ip"],
            data["prefix"],
            data["vendor"],
            data["device"],
            tuple(CaptureDcpResult._of(item) for item in data.get("results", ())),
        )


@dataclass(frozen=True, slots=True)
class CaptureConnectSubmodule:
    """A submodule of a connect."""

    subslot: int
    """Subslot."""
    ident: int
    """SubmoduleIdentNumber."""
    input: int | None
    """Octets of input data."""
    output: int | None
    """Octets of output data."""
    state: int | None
    """SubmoduleState of a difference."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureConnectSubmodule:
        return cls(
            data["subslot"],
            data["ident"],
            data.get("input"),
            data.get("output"),
            data.get("state"),
        )


@dataclass(frozen=True, slots=True)
class CaptureConnect:
    """A step of a connection."""

    step: str
    """`request`, `iocr`, `module`, `response`, `diff`, `control`, `release` or `earlier`."""
    api: int | None
    """API of a module."""
    ar_type: int | None
    """ARType."""
    ar_uuid: str | None
    """ARUUID."""
    command: int | None
    """ControlCommand."""
    cycle: float | None
    """Cycle in seconds."""
    direction: str | None
    """Direction of cyclic data: `input` or `output`."""
    frame_id: int | None
    """FrameID of cyclic data."""
    ident: int | None
    """ModuleIdentNumber: expected, or of a difference plugged."""
    octets: int | None
    """Octets of cyclic data."""
    session: int | None
    """SessionKey."""
    slot: int | None
    """Slot of a module."""
    state: int | None
    """ModuleState of a difference."""
    status: int | None
    """PNIOStatus of a refusal."""
    submodules: tuple[CaptureConnectSubmodule, ...]
    """Submodules of a module or of a difference."""
    telegram: int | None
    """Telegram of a module."""
    watchdog: float | None
    """Watchdog in seconds."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureConnect:
        return cls(
            data["step"],
            data.get("api"),
            data.get("ar_type"),
            data.get("ar_uuid"),
            data.get("command"),
            data.get("cycle"),
            data.get("direction"),
            data.get("frame_id"),
            data.get("ident"),
            data.get("octets"),
            data.get("session"),
            data.get("slot"),
            data.get("state"),
            data.get("status"),
            tuple(CaptureConnectSubmodule._of(item) for item in data.get("submodules", ())),
            data.get("telegram"),
            data.get("watchdog"),
        )


@dataclass(frozen=True, slots=True)
class CaptureRecord:
    """A record read or written."""

    service: str
    """`read` or `write`."""
    api: int
    """API."""
    slot: int
    """Slot."""
    subslot: int
    """Subslot."""
    index: int
    """Index."""
    octets: int
    """Octets of the record."""
    content: object
    """Content of a record of a known layout."""
    request_frame: int | None
    """Frame of the request, in an answer."""
    status: int | None
    """PNIOStatus of a refusal."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureRecord:
        return cls(
            data["service"],
            data["api"],
            data["slot"],
            data["subslot"],
            data["index"],
            data["octets"],
            data.get("content"),
            data.get("request_frame"),
            data.get("status"),
        )


@dataclass(frozen=True, slots=True)
class CaptureDiagnosis:
    """One diagnosis of a channel."""

    usi: int
    """UserStructureIdentifier."""
    channel: int | None
    """ChannelNumber; `None` for the whole submodule."""
    specifier: str
    """`appears`, `disappears`, `disappears, others remain` or `all disappear`."""
    severity: str
    """`fault`, `maintenance required`, `maintenance demanded` or `qualified`."""
    error_type: int
    """ChannelErrorType."""
    error: str | None
    """Meaning of the ChannelErrorType, where it is a standard one."""
    ext_error_type: int | None
    """ExtChannelErrorType."""
    add_value: int | None
    """ExtChannelAddValue."""
    qualifier: int | None
    """QualifiedChannelQualifier."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureDiagnosis:
        return cls(
            data["usi"],
            data["channel"],
            data["specifier"],
            data["severity"],
            data["error_type"],
            data["error"],
            data["ext_error_type"],
            data["add_value"],
            data["qualifier"],
        )


@dataclass(frozen=True, slots=True)
class CaptureAlarm:
    """An alarm, its acknowledgement, or the end of a connection by an error PDU."""

    step: str
    """`notification`, `acknowledgement`, `nack` or `abort`."""
    alarm_type: int | None
    """AlarmType."""
    api: int | None
    """API."""
    diagnosis: tuple[CaptureDiagnosis, ...]
    """What is wrong."""
    priority: str | None
    """`high` or `low`."""
    sequence: int | None
    """Sequence number of the alarm, 0 to 2047."""
    slot: int | None
    """Slot."""
    status: int | None
    """PNIOStatus of an acknowledgement or of an abort."""
    subslot: int | None
    """Subslot."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureAlarm:
        return cls(
            data["step"],
            data.get("alarm_type"),
            data.get("api"),
            tuple(CaptureDiagnosis._of(item) for item in data.get("diagnosis", ())),
            data.get("priority"),
            data.get("sequence"),
            data.get("slot"),
            data.get("status"),
            data.get("subslot"),
        )


@dataclass(frozen=True, slots=True)
class CaptureCyclic:
    """Status of cyclic data."""

    iops: int | None
    """Provider status of that slot."""
    problem: bool | None
    """The station reports a problem."""
    run: bool | None
    """The provider runs."""
    slot: int | None
    """Slot whose provider status changed."""
    status: int | None
    """DataStatus octet."""
    valid: bool | None
    """The data is valid."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureCyclic:
        return cls(
            data.get("iops"),
            data.get("problem"),
            data.get("run"),
            data.get("slot"),
            data.get("status"),
            data.get("valid"),
        )


@dataclass(frozen=True, slots=True)
class CaptureNeighbour:
    """A neighbour reported by LLDP."""

    port: str
    """Name of the port."""
    station: str
    """Name of the station; empty without one."""
    ip: str | None
    """Management address."""
    ttl: int
    """Seconds for which it is valid; 0 when the neighbour leaves."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureNeighbour:
        return cls(
            data["port"],
            data["station"],
            data["ip"],
            data["ttl"],
        )


@dataclass(frozen=True, slots=True)
class Malformed:
    """A PDU that cannot be decoded."""

    offset: int
    """Octet at which decoding failed."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Malformed:
        return cls(
            data["offset"],
        )


@dataclass(frozen=True, slots=True)
class Unanswered:
    """An unanswered call, parameter request, DCP service or alarm."""

    what: str
    """What was requested."""
    sent: int
    """How often it was sent."""
    waited: float
    """From the first request until it was given up, in seconds."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Unanswered:
        return cls(
            data["what"],
            data["sent"],
            _number(data["waited"]),
        )


@dataclass(frozen=True, slots=True)
class Unasked:
    """An answer whose request is not in the capture."""

    what: str
    """What was answered."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Unasked:
        return cls(
            data["what"],
        )


@dataclass(frozen=True, slots=True)
class Late:
    """An answer that came only after repetitions."""

    what: str
    """What was requested."""
    sent: int
    """How often it was sent."""
    waited: float
    """From the first request to the answer, in seconds."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Late:
        return cls(
            data["what"],
            data["sent"],
            _number(data["waited"]),
        )


@dataclass(frozen=True, slots=True)
class DuplicateName:
    """Two stations have the same name of station."""

    name: str
    """The name."""
    mac: str
    """One of them."""
    other: str
    """The other."""
    ago: float
    """Time since the other was seen with this name, in seconds."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DuplicateName:
        return cls(
            data["name"],
            data["mac"],
            data["other"],
            _number(data["ago"]),
        )


@dataclass(frozen=True, slots=True)
class DuplicateAddress:
    """Two stations have the same IP address, or a station reports a conflict."""

    ip: str
    """The address."""
    mac: str
    """One of them."""
    other: str | None
    """The other; `None` where the station reports the conflict itself."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DuplicateAddress:
        return cls(
            data["ip"],
            data["mac"],
            data["other"],
        )


@dataclass(frozen=True, slots=True)
class ArpFlood:
    """Far more ARP frames than a network of this kind needs."""

    frames: int
    """ARP frames of the sender within one second."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> ArpFlood:
        return cls(
            data["frames"],
        )


@dataclass(frozen=True, slots=True)
class Lost:
    """Cyclic frames are missing by their cycle counter."""

    frames: int
    """Frames missing since the last report."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Lost:
        return cls(
            data["frames"],
        )


@dataclass(frozen=True, slots=True)
class Silent:
    """No cyclic frame for longer than the watchdog."""

    gap: float
    """Time without a frame, in seconds."""
    watchdog: float
    """Watchdog, in seconds."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Silent:
        return cls(
            _number(data["gap"]),
            _number(data["watchdog"]),
        )


@dataclass(frozen=True, slots=True)
class Rejected:
    """A call was refused by the RPC layer."""

    status: int
    """Status word."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Rejected:
        return cls(
            data["status"],
        )


@dataclass(frozen=True, slots=True)
class Unknown:
    """A service that does not exist."""

    service: int
    """Number of the service."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Unknown:
        return cls(
            data["service"],
        )


@dataclass(frozen=True, slots=True)
class Repeated:
    """An RTA PDU was sent again."""

    sequence: int
    """Sequence number of the PDU."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Repeated:
        return cls(
            data["sequence"],
        )


CaptureTrouble: TypeAlias = (
    Malformed
    | Unanswered
    | Unasked
    | Late
    | DuplicateName
    | DuplicateAddress
    | ArpFlood
    | Lost
    | Silent
    | Rejected
    | Unknown
    | Repeated
)
"""Something that should not happen."""

_CAPTURE_TROUBLES: dict[str, Any] = {
    "malformed": Malformed,
    "unanswered": Unanswered,
    "unasked": Unasked,
    "late": Late,
    "duplicate_name": DuplicateName,
    "duplicate_address": DuplicateAddress,
    "arp_flood": ArpFlood,
    "lost": Lost,
    "silent": Silent,
    "rejected": Rejected,
    "unknown": Unknown,
    "repeated": Repeated,
}


def capture_trouble_of(data: Mapping[str, Any]) -> CaptureTrouble:
    """Returns it from its JSON document."""
    made: CaptureTrouble = _CAPTURE_TROUBLES[data["problem"]]._of(data)
    return made


_CAPTURE_EVENTS: dict[str, Any] = {
    "state": CaptureState._of,
    "fault": CaptureState._of,
    "job": CaptureJob._of,
    "dcp": CaptureDcp._of,
    "connect": CaptureConnect._of,
    "record": CaptureRecord._of,
    "alarm": CaptureAlarm._of,
    "sample": CaptureSample._of,
    "cyclic": CaptureCyclic._of,
    "neighbour": CaptureNeighbour._of,
    "trouble": capture_trouble_of,
}


CaptureEventData: TypeAlias = (
    CaptureState
    | CaptureJob
    | CaptureDcp
    | CaptureConnect
    | CaptureRecord
    | CaptureAlarm
    | CaptureSample
    | CaptureCyclic
    | CaptureNeighbour
    | CaptureTrouble
)
"""What happened, in numbers."""


@dataclass(frozen=True, slots=True)
class CaptureParty:
    """One end of a frame, by its addresses."""

    mac: str | None
    """Ethernet address; `None` for multicast."""
    ip: str | None
    """IP address of a datagram."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureParty:
        return cls(
            data["mac"],
            data["ip"],
        )


class Weight(str, Enum):
    """How much something matters that was found in a capture or in octets."""

    NORMAL = "normal"
    """What is to be expected."""
    WARNING = "warning"
    """Worth a look."""
    ERROR = "error"
    """A refusal, a fault, a malformed PDU."""


@dataclass(frozen=True, slots=True)
class CaptureEvent:
    """One thing that happened."""

    frame: int
    """Number of the frame in the capture, from 1, as Wireshark counts."""
    time: float
    """Time since the first frame, in seconds."""
    from_: str
    """Name or address of the sender."""
    to: str
    """Name or address of the receiver; empty for multicast."""
    source: CaptureParty
    """Addresses of the sender."""
    target: CaptureParty
    """Addresses of the receiver."""
    topic: str
    """DCP, LLDP, connect, record, parameter, cyclic, alarm, ..."""
    text: str
    """What happened, in words."""
    weight: Weight
    """How much it matters."""
    kind: str
    """What `data` is."""
    data: CaptureEventData
    """What happened, in numbers."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> CaptureEvent:
        return cls(
            data["frame"],
            _number(data["time"]),
            data["from"],
            data["to"],
            CaptureParty._of(data["source"]),
            CaptureParty._of(data["target"]),
            data["topic"],
            data["text"],
            Weight(data["weight"]),
            data["kind"],
            _CAPTURE_EVENTS[data["kind"]](data["data"]),
        )


@dataclass(frozen=True, slots=True)
class StreamSummary:
    """The cyclic frames of one direction. Times are in seconds."""

    from_: str
    """Name or address of the sender."""
    to: str
    """Name or address of the receiver."""
    direction: str
    """`input`, `output`, or `unknown` where no connect is in the capture."""
    frames: int
    """Frames."""
    cycle: float
    """Time between two frames as agreed, or as the cycle counter shows."""
    jitter_p50: float | None
    """Deviation from the cycle that half of the frames do not exceed."""
    jitter_p99: float | None
    """Deviation from the cycle that 99 % of the frames do not exceed."""
    lost: int
    """Frames missing by the cycle counter."""
    repeated: int
    """Frames received twice, or out of order."""
    longest_gap: float
    """Longest time between two frames of one connection."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> StreamSummary:
        return cls(
            data["from"],
            data["to"],
            data["direction"],
            data["frames"],
            _number(data["cycle"]),
            data["jitter_p50"],
            data["jitter_p99"],
            data["lost"],
            data["repeated"],
            _number(data["longest_gap"]),
        )


@dataclass(frozen=True, slots=True)
class DeviceSummary:
    """A device with cyclic connections."""

    device: str
    """Name or address."""
    mac: str
    """Ethernet address."""
    ip: str | None
    """IP address, where the capture shows it."""
    restarts: int
    """Connections after the first one."""
    connection_losses: int
    """Times that its connection was silent for longer than the watchdog, or ended by an error PDU."""
    alarms: int
    """Alarms."""
    faults: int
    """Faults that its status words report."""
    streams: tuple[StreamSummary, ...]
    """Its cyclic frames, each direction."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> DeviceSummary:
        return cls(
            data["device"],
            data["mac"],
            data["ip"],
            data["restarts"],
            data["connection_losses"],
            data["alarms"],
            data["faults"],
            tuple(StreamSummary._of(item) for item in data["streams"]),
        )


@dataclass(frozen=True, slots=True)
class FrameNode:
    """A part of a frame.

    The octets of a node contain those of its children. What no child covers is padding, or has no meaning here."""

    name: str
    """Name of the field, of the block, or of the signal."""
    value: str
    """Its value in words; empty where the children give it."""
    start: int
    """First octet, from the start of the frame."""
    end: int
    """Octet behind the last one."""
    weight: Weight
    """How much it matters: that of the gravest child at least."""
    children: tuple[FrameNode, ...]
    """Its parts, in the order of their octets."""

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> FrameNode:
        return cls(
            data["name"],
            data["value"],
            data["start"],
            data["end"],
            Weight(data["weight"]),
            tuple(FrameNode._of(item) for item in data.get("children", ())),
        )


__all__ = [
    "ArpFlood",
    "CaptureAlarm",
    "CaptureConnect",
    "CaptureConnectSubmodule",
    "CaptureCyclic",
    "CaptureDcp",
    "CaptureDcpResult",
    "CaptureDiagnosis",
    "CaptureEvent",
    "CaptureJob",
    "CaptureNeighbour",
    "CaptureParty",
    "CaptureRecord",
    "CaptureSample",
    "CaptureState",
    "CaptureTrouble",
    "DeviceSummary",
    "DuplicateAddress",
    "DuplicateName",
    "FrameNode",
    "Late",
    "Lost",
    "Malformed",
    "Rejected",
    "Repeated",
    "Silent",
    "StreamSummary",
    "Unanswered",
    "Unasked",
    "Unknown",
    "Weight",
    "capture_trouble_of",
]
