//! What a frame of a capture means: one event each, in words and as typed numbers.

use std::fmt::Display;
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::MacAddress;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use crate::Weight;
use crate::job::RefusedParameter;

/// One end of a frame, by its addresses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureParty")
)]
pub struct Party {
    /// Ethernet address; `None` for multicast.
    #[serde(serialize_with = "option_text")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<String>"))]
    pub mac: Option<MacAddress>,
    /// IP address of a datagram.
    pub ip: Option<Ipv4Addr>,
}

/// One thing that happened.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureEvent")
)]
pub struct Event {
    /// Number of the frame in the capture, from 1, as Wireshark counts.
    pub frame: u64,
    /// Time since the first frame, in seconds.
    #[serde(rename = "time", serialize_with = "seconds")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub at: Duration,
    /// Name or address of the sender.
    pub from: String,
    /// Name or address of the receiver; empty for multicast.
    pub to: String,
    /// Addresses of the sender.
    pub source: Party,
    /// Addresses of the receiver.
    pub target: Party,
    /// DCP, LLDP, connect, record, parameter, cyclic, alarm, ...
    pub topic: &'static str,
    /// What happened, in words.
    pub text: String,
    /// How much it matters.
    pub weight: Weight,
    /// What happened, in numbers.
    #[serde(flatten)]
    pub detail: Detail,
}

impl Event {
    /// Returns true for what points to a fault: warnings, errors, and everything of the kind [`Detail::Trouble`].
    pub fn is_trouble(&self) -> bool {
        self.weight != Weight::Normal || matches!(self.detail, Detail::Trouble(_))
    }
}

/// What happened, in numbers: one struct for each kind of event.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureDetail")
)]
#[serde(tag = "kind", content = "data", rename_all = "snake_case")]
pub enum Detail {
    /// A control or status word changed.
    State(State),
    /// A status word reports a fault that it did not report before.
    Fault(State),
    /// A parameter request or response, in a record or in the parameter channel.
    Job(Job),
    /// Discovery and addressing.
    Dcp(Dcp),
    /// A step of establishing, starting or releasing a connection.
    Connect(Connect),
    /// A record that is not a parameter job.
    Record(Record),
    /// An alarm or its acknowledgement.
    Alarm(Alarm),
    /// A value in cyclic data.
    Sample(Sample),
    /// Status of cyclic data as a whole or of one submodule.
    Cyclic(Cyclic),
    /// A neighbour reported by LLDP.
    Neighbour(Neighbour),
    /// Something that should not happen, whatever protocol it is in.
    Trouble(Trouble),
}

/// A control or status word.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureState")
)]
pub struct State {
    /// Slot of the drive.
    pub slot: u16,
    /// Subslot of the drive.
    pub subslot: u16,
    /// Number of the telegram, where it is known.
    pub telegram: Option<u16>,
    /// `STW1`, `ZSW1`, or the vendor's name of the word.
    pub word: &'static str,
    /// Its value before; `None` for the first one of a connection.
    pub before: Option<u16>,
    /// Its value.
    pub value: u16,
    /// The speed beside it, where the telegram has one.
    pub speed: Option<Sample>,
}

/// A value in cyclic data.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureSample")
)]
pub struct Sample {
    /// Slot of the drive.
    pub slot: u16,
    /// Subslot of the drive.
    pub subslot: u16,
    /// Name of the signal.
    pub signal: &'static str,
    /// The number in the frame.
    pub raw: i64,
    /// The value in `unit`.
    pub value: f64,
    /// Unit of `value`.
    pub unit: &'static str,
    /// What the value rests on that the capture does not show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assumed: Option<String>,
}

/// A parameter request or response.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureJob")
)]
pub struct Job {
    /// `record` (base mode parameter access) or `pkw` (parameter channel in cyclic data).
    pub channel: &'static str,
    /// The job: side, reference, parameters and values.
    #[serde(flatten)]
    pub job: Map<String, Value>,
    /// Frame of the request, in a response.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub request_frame: Option<u64>,
    /// What is refused in this event.
    #[serde(skip)]
    pub refused: Option<RefusedParameter>,
}

/// A DCP service.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureDcp")
)]
pub struct Dcp {
    /// `identify`, `get`, `set` or `hello`.
    pub service: &'static str,
    /// False for a request, true for an answer.
    pub response: bool,
    /// Transaction number.
    pub xid: u32,
    /// Name of station requested, set or reported.
    pub name: Option<String>,
    /// IP address requested, set or reported.
    pub ip: Option<Ipv4Addr>,
    /// Prefix length of the IP address.
    pub prefix: Option<u32>,
    /// VendorID and DeviceID.
    pub vendor: Option<u16>,
    /// DeviceID.
    pub device: Option<u16>,
    /// What a set request was answered: option, suboption and BlockError of each block.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<DcpResult>,
}

/// The answer to one block of a DCP Set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureDcpResult")
)]
pub struct DcpResult {
    /// Option.
    pub option: u8,
    /// Suboption.
    pub suboption: u8,
    /// BlockError: 0 ok.
    pub error: u8,
}

/// A step of a connection.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureConnect")
)]
pub struct Connect {
    /// `request`, `iocr`, `module`, `response`, `diff`, `control`, `release` or `earlier`.
    pub step: &'static str,
    /// ARType.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ar_type: Option<u16>,
    /// ARUUID.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ar_uuid: Option<String>,
    /// SessionKey.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub session: Option<u16>,
    /// Direction of cyclic data: `input` or `output`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<&'static str>,
    /// FrameID of cyclic data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_id: Option<u16>,
    /// Octets of cyclic data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub octets: Option<u16>,
    /// Cycle in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycle: Option<f64>,
    /// Watchdog in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub watchdog: Option<f64>,
    /// API of a module.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub api: Option<u32>,
    /// Slot of a module.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slot: Option<u16>,
    /// ModuleIdentNumber: expected, or of a difference plugged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ident: Option<u32>,
    /// ModuleState of a difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<u16>,
    /// Telegram of a module.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub telegram: Option<u16>,
    /// Submodules of a module or of a difference.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub submodules: Vec<ConnectSubmodule>,
    /// ControlCommand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<u16>,
    /// PNIOStatus of a refusal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u32>,
}

/// A submodule of a connect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureConnectSubmodule")
)]
pub struct ConnectSubmodule {
    /// Subslot.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Octets of input data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<u16>,
    /// Octets of output data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<u16>,
    /// SubmoduleState of a difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<u16>,
}

/// A record read or written.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureRecord")
)]
pub struct Record {
    /// `read` or `write`.
    pub service: &'static str,
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Index.
    pub index: u16,
    /// Octets of the record.
    pub octets: usize,
    /// Content of a record of a known layout.
    #[serde(skip_serializing_if = "Value::is_null")]
    pub content: Value,
    /// PNIOStatus of a refusal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u32>,
    /// Frame of the request, in an answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub request_frame: Option<u64>,
}

/// An alarm, its acknowledgement, or the end of a connection by an error PDU.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureAlarm")
)]
pub struct Alarm {
    /// `notification`, `acknowledgement`, `nack` or `abort`.
    pub step: &'static str,
    /// AlarmType.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarm_type: Option<u16>,
    /// `high` or `low`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub priority: Option<&'static str>,
    /// API.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub api: Option<u32>,
    /// Slot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slot: Option<u16>,
    /// Subslot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subslot: Option<u16>,
    /// Sequence number of the alarm, 0 to 2047.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequence: Option<u16>,
    /// What is wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub diagnosis: Vec<Diagnosis>,
    /// PNIOStatus of an acknowledgement or of an abort.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u32>,
}

/// One diagnosis of a channel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureDiagnosis")
)]
pub struct Diagnosis {
    /// UserStructureIdentifier.
    pub usi: u16,
    /// ChannelNumber; `None` for the whole submodule.
    pub channel: Option<u16>,
    /// `appears`, `disappears`, `disappears, others remain` or `all disappear`.
    pub specifier: &'static str,
    /// `fault`, `maintenance required`, `maintenance demanded` or `qualified`.
    pub severity: &'static str,
    /// ChannelErrorType.
    pub error_type: u16,
    /// Meaning of the ChannelErrorType, where it is a standard one.
    pub error: Option<&'static str>,
    /// ExtChannelErrorType.
    pub ext_error_type: Option<u16>,
    /// ExtChannelAddValue.
    pub add_value: Option<u32>,
    /// QualifiedChannelQualifier.
    pub qualifier: Option<u32>,
}

/// Status of cyclic data.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureCyclic")
)]
pub struct Cyclic {
    /// DataStatus octet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u8>,
    /// The provider runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<bool>,
    /// The data is valid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid: Option<bool>,
    /// The station reports a problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<bool>,
    /// Slot whose provider status changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slot: Option<u16>,
    /// Provider status of that slot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iops: Option<u8>,
}

/// A neighbour reported by LLDP.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureNeighbour")
)]
pub struct Neighbour {
    /// Name of the port.
    pub port: String,
    /// Name of the station; empty without one.
    pub station: String,
    /// Management address.
    pub ip: Option<Ipv4Addr>,
    /// Seconds for which it is valid; 0 when the neighbour leaves.
    pub ttl: u16,
}

/// Something that should not happen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CaptureTrouble")
)]
#[serde(tag = "problem", rename_all = "snake_case")]
pub enum Trouble {
    /// A PDU that cannot be decoded.
    Malformed {
        /// Octet at which decoding failed.
        offset: usize,
    },
    /// An unanswered call, parameter request, DCP service or alarm.
    Unanswered {
        /// What was requested.
        what: String,
        /// How often it was sent.
        sent: u32,
        /// From the first request until it was given up, in seconds.
        #[serde(serialize_with = "seconds")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        waited: Duration,
    },
    /// An answer whose request is not in the capture.
    Unasked {
        /// What was answered.
        what: String,
    },
    /// An answer that came only after repetitions.
    Late {
        /// What was requested.
        what: String,
        /// How often it was sent.
        sent: u32,
        /// From the first request to the answer, in seconds.
        #[serde(serialize_with = "seconds")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        waited: Duration,
    },
    /// Two stations have the same name of station.
    DuplicateName {
        /// The name.
        name: String,
        /// One of them.
        #[serde(serialize_with = "text")]
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        mac: MacAddress,
        /// The other.
        #[serde(serialize_with = "text")]
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        other: MacAddress,
        /// Time since the other was seen with this name, in seconds.
        #[serde(serialize_with = "seconds")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        ago: Duration,
    },
    /// Two stations have the same IP address, or a station reports a conflict.
    DuplicateAddress {
        /// The address.
        ip: Ipv4Addr,
        /// One of them.
        #[serde(serialize_with = "text")]
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        mac: MacAddress,
        /// The other; `None` where the station reports the conflict itself.
        #[serde(serialize_with = "option_text")]
        #[cfg_attr(feature = "schema", schemars(with = "Option<String>"))]
        other: Option<MacAddress>,
    },
    /// Far more ARP frames than a network of this kind needs.
    ArpFlood {
        /// ARP frames of the sender within one second.
        frames: u32,
    },
    /// Cyclic frames are missing by their cycle counter.
    Lost {
        /// Frames missing since the last report.
        frames: u64,
    },
    /// No cyclic frame for longer than the watchdog.
    Silent {
        /// Time without a frame, in seconds.
        #[serde(serialize_with = "seconds")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        gap: Duration,
        /// Watchdog, in seconds.
        #[serde(serialize_with = "seconds")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        watchdog: Duration,
    },
    /// A call was refused by the RPC layer.
    Rejected {
        /// Status word.
        status: u32,
    },
    /// A service that does not exist.
    Unknown {
        /// Number of the service.
        service: u16,
    },
    /// An RTA PDU was sent again.
    Repeated {
        /// Sequence number of the PDU.
        sequence: u16,
    },
}

fn text<T: Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

fn option_text<T: Display, S: Serializer>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => serializer.collect_str(value),
        None => serializer.serialize_none(),
    }
}

fn seconds<S: Serializer>(value: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(value.as_secs_f64())
}

/// Collects the events of one frame.
#[derive(Debug)]
pub struct Sink<'a> {
    /// Number of the frame.
    pub frame: u64,
    /// Time of the frame.
    pub at: Duration,
    /// Who sent it.
    pub source: Party,
    /// To whom.
    pub target: Party,
    /// The events so far.
    pub events: &'a mut Vec<Event>,
}

impl Sink<'_> {
    /// Adds an event of this frame. The names of the parties are filled in when the frame is done.
    pub fn report(&mut self, weight: Weight, topic: &'static str, text: impl Into<String>, detail: Detail) {
        self.events.push(Event {
            frame: self.frame,
            at: self.at,
            from: String::new(),
            to: String::new(),
            source: self.source,
            target: self.target,
            topic,
            text: text.into(),
            weight,
            detail,
        });
    }

    /// Adds an event of an earlier frame: of a request that is given up now.
    pub fn report_of(
        &mut self,
        origin: Origin,
        weight: Weight,
        topic: &'static str,
        text: impl Into<String>,
        detail: Detail,
    ) {
        self.report(weight, topic, text, detail);
        if let Some(event) = self.events.last_mut() {
            event.frame = origin.frame;
            event.source = origin.source;
            event.target = origin.target;
        }
    }

    /// Returns the origin of this frame, to be kept with a request that waits for its answer.
    pub const fn origin(&self) -> Origin {
        Origin {
            frame: self.frame,
            at: self.at,
            source: self.source,
            target: self.target,
        }
    }
}

/// The frame of a request.
#[derive(Debug, Clone, Copy, Default)]
pub struct Origin {
    /// Its number.
    pub frame: u64,
    /// Its time.
    pub at: Duration,
    /// Who sent it.
    pub source: Party,
    /// To whom.
    pub target: Party,
}
