//! Everything that can go wrong between a person's wish and a drive, by kind.

mod hint;
mod kind;
mod problem;
mod refusal;
mod rule;
mod text;

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use profile::notation::figures;
use profile::pkw::JobError;
use profile::state::Mode;
use profinet::MacAddress;
use profinet::controller::{DcpError, LostCause, Misuse, ServiceError, Station};

use crate::axis::{Evidence, NoTelegram, Objection, SpeedUnit, Trouble};
use crate::{Action, AtWork, ClosedRoute, DriveAddress, LocalControl, LossReaction};
use profile::value::ParameterProblem;

pub use kind::ErrorKind;
pub use refusal::{ChannelCause, ChannelRefusal, NotCarried, Refusal};
pub use rule::Rule;
pub use text::describe;
pub(crate) use text::mode_words;
use text::{
    closed_text, frequency_text, highest_text, holders_text, in_place, join, move_ended_text,
    objections_text, once, others, owner_text, reaction_text, scaling_text, speed_limit_text, speed_text,
    telegram_text, times_text, unit_text,
};

/// Why the wire failed; shared by all waiting calls.
pub type WireFailure = Arc<dyn std::error::Error + Send + Sync>;

/// What brought an axis to rest before its move was at its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MoveEnd {
    /// It was halted along its ramp, and the rest of the move was discarded.
    Halted,
    /// The same, at the end of the travel of this session.
    Travel,
    /// An intermediate stop holds it: the move can go on.
    Paused,
}

/// Why something did not come about.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The medium failed: interface gone, permission lost.
    #[error("the network interface failed: {0}")]
    Medium(WireFailure),
    /// The network was left: nothing is carried any more.
    #[error("the network is closed")]
    Closed,
    /// The thread that carries the network has panicked: nothing is carried any more, and no axis of this program is stopped
    /// by it. What stops them is the watchdog of each drive.
    #[error(
        "the thread that carries the network has failed, which is an error of this program; nothing is carried any more"
    )]
    DriverFailed,
    /// More requests wait for this drive than it makes sense to keep.
    #[error("{drive}: too many requests wait for it already")]
    Busy {
        /// The drive.
        drive: String,
    },
    /// The caller was requested to stop.
    #[error("interrupted")]
    Interrupted,
    /// The caller was requested to stop while a drive was brought to rest.
    #[error("{drive}: interrupted; {seen}")]
    StopInterrupted {
        /// The drive.
        drive: String,
        /// How it was seen last.
        seen: String,
    },
    /// No station with this name or address answered.
    #[error("no answer from {drive}{}", others(.drive, .answered))]
    NotFound {
        /// Who was looked for.
        drive: DriveAddress,
        /// Who answered instead.
        answered: Vec<Station>,
    },
    /// More than one station has this name or address.
    #[error("{} stations are {drive}: {}", .macs.len(), join(.macs))]
    Ambiguous {
        /// Who was looked for.
        drive: DriveAddress,
        /// All that answered.
        macs: Vec<MacAddress>,
    },
    /// A name or MAC address on a medium without discovery.
    #[error("{drive} cannot be looked up without a raw socket; give its IP address")]
    NeedsDiscovery {
        /// Who was looked for.
        drive: DriveAddress,
    },
    /// Control on a medium that carries UDP only. Nothing was sent.
    #[error(
        "{drive}: control travels in raw Ethernet frames, and only UDP is open here; nothing was commanded"
    )]
    NeedsRawFrames {
        /// The drive.
        drive: String,
    },
    /// Another program has the UDP port on which a drive calls its controller. Nothing was sent.
    #[error(
        "{drive}: a drive calls its controller on UDP port 34964, which is in use by another program on this computer; nothing was commanded"
    )]
    NeedsCallPort {
        /// The drive.
        drive: String,
    },
    /// The station has no IP address yet.
    #[error("{drive} has no IP address, records cannot be reached")]
    NoIpAddress {
        /// The drive.
        drive: String,
    },
    /// No answer from this address of a serial line.
    #[error("no answer from {drive}{}", in_place(*.telegrams, *.noise))]
    NoAnswer {
        /// The drive that was requested.
        drive: DriveAddress,
        /// Telegrams received from others.
        telegrams: u64,
        /// Invalid octets and telegrams.
        noise: u64,
    },
    /// A drive at a serial line does not answer any more.
    #[error("{drive} does not answer any more{}", reaction_text(.reaction))]
    LineSilent {
        /// The drive.
        drive: String,
        /// What the drive does without its master, where an axis was under control.
        reaction: Option<Box<LossReaction>>,
    },
    /// The parameter channel of a serial line did not do what was requested.
    #[error("{drive}: {error}")]
    Channel {
        /// The drive.
        drive: String,
        /// Why.
        error: JobError,
    },
    /// Something that drives at a serial line do not have.
    #[error("{drive} is at a serial line: there is no {what}")]
    NotOnLine {
        /// The drive.
        drive: String,
        /// What there is not.
        what: &'static str,
    },
    /// A drive at a serial line was requested on a network, or the other way about.
    #[error("{drive} cannot be reached this way")]
    OtherWire {
        /// Who was requested.
        drive: DriveAddress,
    },
    /// A DCP request failed.
    #[error("{drive}: {what}: {error}")]
    Dcp {
        /// The drive.
        drive: String,
        /// What was tried.
        what: &'static str,
        /// Why it failed.
        error: DcpError,
    },
    /// The drive refused a connection or could not be reached for it.
    #[error("{drive}: connecting: {cause}")]
    Connect {
        /// The drive.
        drive: String,
        /// Why.
        cause: LostCause,
    },
    /// Another device answered at the address of the drive.
    #[error("{drive}: another device answers at {ip}{}", holders_text(.macs))]
    SharedAddress {
        /// The drive.
        drive: String,
        /// The address.
        ip: Ipv4Addr,
        /// All stations that claim it.
        macs: Vec<MacAddress>,
    },
    /// Another controller owns what was requested.
    #[error("{drive} refuses control: {} owns it ({cause})", owner_text(.controller.as_deref()))]
    OwnedByController {
        /// The drive.
        drive: String,
        /// Its station name, if the drive reports it.
        controller: Option<String>,
        /// What the drive reported.
        cause: String,
    },
    /// The device accepts no connection beside that of its controller, and parameters need one.
    #[error("{drive}: parameters can be neither read nor written: {} has its only connection{}", owner_text(.controller.as_deref()), closed_text(.closed))]
    ParametersOwned {
        /// The drive.
        drive: String,
        /// Station name of the controller, where the device reports it.
        controller: Option<String>,
        /// Ways that the device refuses.
        closed: Vec<ClosedRoute>,
    },
    /// The device refuses every way to its records.
    #[error("{drive}: no way to its records{}", closed_text(.closed))]
    NoRoute {
        /// The drive.
        drive: String,
        /// Ways that were tried.
        closed: Vec<ClosedRoute>,
    },
    /// The device has no module of the drive profile, so it has no parameters.
    #[error("{drive} is not a drive: no module of the drive profile (API 0x3A00) is plugged")]
    NotADrive {
        /// The device.
        drive: String,
    },
    /// A required connection ended.
    #[error("{drive}: connection lost: {cause}{}", reaction_text(.reaction))]
    ConnectionLost {
        /// The drive.
        drive: String,
        /// Why.
        cause: LostCause,
        /// What the drive does without its controller, where an axis was under control.
        reaction: Option<Box<LossReaction>>,
    },
    /// What carries the frames or octets to a drive failed: interface down, serial port gone.
    #[error("{drive}: connection lost: {error}{}", reaction_text(.reaction))]
    CarrierLost {
        /// The drive.
        drive: String,
        /// Why.
        error: WireFailure,
        /// What the drive does without its controller, where an axis was under control.
        reaction: Option<Box<LossReaction>>,
    },
    /// A record could not be read or written.
    #[error("{drive}: {}", once(.what, .error))]
    Record {
        /// The drive.
        drive: String,
        /// What was tried.
        what: String,
        /// Why it failed.
        error: ServiceError,
    },
    /// The drive refused one parameter, or the channel to it cannot carry it.
    #[error("{drive}: {refusal}")]
    Refused {
        /// The drive.
        drive: String,
        /// Which parameter and why.
        refusal: Refusal,
    },
    /// A parameter or value that cannot be used; nothing was sent.
    #[error(transparent)]
    Parameter(#[from] ParameterProblem),
    /// The drive's answer cannot be understood.
    #[error("{drive}: the answer to the parameter request cannot be understood: {reason}")]
    Malformed {
        /// The drive.
        drive: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The drive does not support a request of the parameter channel; nothing was changed.
    #[error("{drive} does not know parameter request 0x{id:02X}: {words}")]
    UnknownRequest {
        /// The drive.
        drive: String,
        /// Request ID.
        id: u8,
        /// The drive's error number with its meaning.
        words: String,
    },
    /// The axis did not do what was requested.
    #[error("{drive}: {trouble}")]
    Axis {
        /// The drive.
        drive: String,
        /// What happened.
        trouble: Trouble,
    },
    /// The drive is in another mode than required. It is changed only on request.
    #[error("{drive} is in {present}, this needs {}", mode_words(*needed))]
    WrongMode {
        /// The drive.
        drive: String,
        /// The mode needed.
        needed: Mode,
        /// The mode it is in, in words.
        present: String,
    },
    /// A drive without positions was to go to one. Nothing was sent.
    #[error(
        "{drive} controls speed only: the telegrams of model {model} carry no positions, tasks or homing"
    )]
    SpeedOnly {
        /// The drive.
        drive: String,
        /// Its model.
        model: &'static str,
    },
    /// A drive whose control word has no bit for it was to jog. Nothing was sent.
    #[error("{drive} does not jog: its control word ({profile}) has no bit for it")]
    NoJog {
        /// The drive.
        drive: String,
        /// Whose bits the control word has.
        profile: &'static str,
    },
    /// No telegram of the drive carries what is needed.
    #[error("{drive}: {problem}")]
    Telegram {
        /// The drive.
        drive: String,
        /// What is missing.
        problem: NoTelegram,
    },
    /// The plugged module comes from an unknown device description of the vendor, and is not the required telegram.
    #[error("{drive} has {} plugged, module 0x{ident:08X}, which is not in the tables; the ident number of the module of telegram {wanted} is not known", telegram_text(*.plugged))]
    ForeignModule {
        /// The drive.
        drive: String,
        /// Ident number of the module plugged.
        ident: u32,
        /// The telegram plugged (PNU 922).
        plugged: Option<u16>,
        /// The telegram needed.
        wanted: u16,
    },
    /// The drive is in local operation; nothing was sent.
    #[error("{drive} is in local operation (ZSW1 bit 9 is 0): {by}")]
    LocalOperation {
        /// The drive.
        drive: String,
        /// Who.
        by: LocalControl,
    },
    /// This program has the axis under control already: another connection would end that one. Nothing was sent.
    #[error("{drive}: this program has its axis under control already")]
    UnderControl {
        /// The drive.
        drive: String,
    },
    /// The drive is in operation though no controller commands it; nothing was sent.
    #[error(
        "{drive} is in operation though no controller is connected: its last control word commands it, or what it does without a controller"
    )]
    Ownerless {
        /// The drive.
        drive: String,
        /// What brings it to rest.
        stop: Action,
    },
    /// No setting of the drive stops the axis when its controller is lost, and the caller has not consented to that; nothing
    /// was sent.
    #[error("{drive} was not enabled: when its controller is lost, {reaction}")]
    RunsOn {
        /// The drive.
        drive: String,
        /// What the drive does, and the setting that decides.
        reaction: Box<LossReaction>,
    },
    /// A drive is to be observed that may begin or keep up a motion when the connection is lost; nothing was sent.
    #[error("{drive} is not observed: it may move its motor when the connection is lost ({})", .reaction.named())]
    MovesWhenLost {
        /// The drive.
        drive: String,
        /// What the drive does, and the setting that decides.
        reaction: Box<LossReaction>,
    },
    /// A drive is to be observed whose status word is not readable: whether its power stage is on is not known. Nothing was
    /// sent.
    #[error("{drive} is not observed: its status word is not readable, so its power stage may be on")]
    StatusUnread {
        /// The drive.
        drive: String,
    },
    /// The drive is at work, which this would disturb; nothing was sent.
    #[error("{drive} is not {undone}: {works}")]
    AtWork {
        /// The drive.
        drive: String,
        /// What is not done: `reset`.
        undone: &'static str,
        /// What it is at work with.
        works: AtWork,
    },
    /// The axis is not enabled any more; nothing was sent.
    #[error("{drive}: the axis is not enabled any more")]
    NotEnabled {
        /// The drive.
        drive: String,
    },
    /// Something speaks against a move; nothing was sent.
    #[error("{drive}: {}", objections_text(.objections))]
    Objections {
        /// The drive.
        drive: String,
        /// What, at least one.
        objections: Vec<Objection>,
    },
    /// A motion took longer than it may; the axis is being stopped.
    #[error("{drive}: {what} took longer than {:.1} s", .limit.as_secs_f64())]
    NotInTime {
        /// The drive.
        drive: String,
        /// What was waited for.
        what: &'static str,
        /// How long.
        limit: Duration,
    },
    /// Something halted the axis while it homed; it stays enabled.
    #[error("{drive}: homing was ended {}: the home position is not set", if *.by_travel { "at the end of the travel of this session" } else { "by a halt" })]
    HomingEnded {
        /// The drive.
        drive: String,
        /// Whether the end of its travel halted it, not its caller.
        by_travel: bool,
    },
    /// Something brought the axis to rest before its move was at its target; it stays enabled.
    #[error("{drive}: {}", move_ended_text(*.end, *.position, *.target))]
    MoveEnded {
        /// The drive.
        drive: String,
        /// What did.
        end: MoveEnd,
        /// Where the axis stands, in turns, if its telegram carries the position.
        position: Option<f64>,
        /// Where the move was to end, in turns, if that is known.
        target: Option<f64>,
    },
    /// The axis did not come up to its speed; it is being stopped.
    #[error("{drive}: {} {unit} not reached within {:.1} s, the highest speed was {}", figures(*.wanted), .limit.as_secs_f64(), speed_text(*.highest, .unit))]
    SpeedNotReached {
        /// The drive.
        drive: String,
        /// Speed requested.
        wanted: f64,
        /// Highest speed in that direction, if the telegram carries speeds.
        highest: Option<f64>,
        /// How long.
        limit: Duration,
        /// Unit of the speeds.
        unit: &'static str,
    },
    /// The axis stood during a whole jog; it is being stopped.
    #[error(
        "{drive}: jogging at {} rpm for {:.1} s did not move the axis{}",
        figures(*.wanted), .time.as_secs_f64(), highest_text(*.highest, .unit)
    )]
    NotMoved {
        /// The drive.
        drive: String,
        /// Speed of the jog, rpm.
        wanted: f64,
        /// Highest speed, if the telegram carries speeds.
        highest: Option<f64>,
        /// How long it jogged.
        time: Duration,
        /// Unit of the highest speed.
        unit: &'static str,
    },
    /// The axis had its speed and does not follow any more; it is being stopped.
    #[error("{drive}: {} {unit} was reached and is not kept: {} for {:.1} s", figures(*.wanted), speed_text(*.actual, .unit), .time.as_secs_f64())]
    SpeedLost {
        /// The drive.
        drive: String,
        /// Speed requested.
        wanted: f64,
        /// Actual speed, if the telegram carries speeds.
        actual: Option<f64>,
        /// How long it was away from its speed.
        time: Duration,
        /// Unit of the speeds.
        unit: &'static str,
    },
    /// Another client changed the scale of the speed setpoint while the axis ran; it is being stopped.
    #[error(
        "{drive}: the scale of its speeds was changed while it ran, from {before} to {now}: the setpoint meant another speed"
    )]
    ScaleChanged {
        /// The drive.
        drive: String,
        /// Scale that the setpoints were made with.
        before: u16,
        /// Scale of the drive.
        now: u16,
    },
    /// A speed that is not representable, and the nearest step is too far away
    /// ([`MOST_ROUNDING`](profile::value::MOST_ROUNDING)); nothing was sent.
    #[error(
        "{drive}: {} {unit} is not representable: the nearest speeds are {} {unit} and {} {unit}",
        figures(*.wanted),
        figures(.nearest[0]),
        figures(.nearest[1])
    )]
    SpeedStep {
        /// The drive.
        drive: String,
        /// Speed requested.
        wanted: f64,
        /// The nearest representable speeds below and above.
        nearest: [f64; 2],
        /// Unit of the speeds.
        unit: &'static str,
    },
    /// A speed above the highest number of the speed setpoint; nothing was sent.
    #[error(
        "{drive}: {} {unit} is beyond what the speed setpoint carries, {} {unit}{}",
        figures(*.wanted),
        figures(*.highest),
        scaling_text(.scaling.as_ref())
    )]
    SpeedRange {
        /// The drive.
        drive: String,
        /// Speed requested.
        wanted: f64,
        /// The highest speed in that direction.
        highest: f64,
        /// Unit of the speeds.
        unit: &'static str,
        /// The parameter that scales the setpoint and its value, where the drive has one.
        scaling: Option<(String, u16)>,
    },
    /// The axis is held by something; what the drive reported while it was still in operation.
    #[error("{error}; {evidence}")]
    Held {
        /// What went wrong.
        error: Box<Error>,
        /// What the drive reported.
        evidence: Evidence,
    },
    /// A speed that the caller did not allow.
    #[error("{}", speed_limit_text(*.wanted, *.limit, .unit))]
    SpeedLimit {
        /// Requested speed.
        wanted: f64,
        /// Speed allowed.
        limit: f64,
        /// Unit of the speeds.
        unit: &'static str,
    },
    /// A model without a parameter that stops it, while its controller has the control word.
    #[error(
        "{drive}: model {model} has no parameter that stops it, and controller \"{controller}\" has its control word"
    )]
    NoStopBeside {
        /// The drive.
        drive: String,
        /// The model.
        model: &'static str,
        /// Name of the controller.
        controller: String,
    },
    /// The parameter that stops a drive was sent and not answered, while its controller has the control word.
    #[error(
        "{drive}: {command} was sent without an answer that counts ({cause}), and controller \"{controller}\" has its control word"
    )]
    StopUnanswered {
        /// The drive.
        drive: String,
        /// The parameter.
        command: &'static str,
        /// Name of the controller.
        controller: String,
        /// What became of its parameters.
        cause: String,
    },
    /// Speeds of this drive have another unit.
    #[error("{drive}: {}", unit_text(*.wanted))]
    SpeedUnit {
        /// The drive.
        drive: String,
        /// The requested unit.
        wanted: SpeedUnit,
    },
    /// A speed in Hz for a drive whose speed is no output frequency.
    #[error("{drive}: a speed in Hz cannot be converted: {}", frequency_text(*.converter))]
    NoFrequency {
        /// The drive.
        drive: String,
        /// It is a frequency converter, but its motor data are not valid.
        converter: bool,
    },
    /// A telegram that the drive has not.
    #[error("{drive} has no telegram {wanted}")]
    NoSuchTelegram {
        /// The drive.
        drive: String,
        /// The requested number.
        wanted: u16,
        /// Those that there are.
        possible: Vec<u16>,
    },
    /// The drive's model is not known well enough for this.
    #[error("{drive}: {what} is not known for vendor 0x{vendor_id:04X} device 0x{device_id:04X}")]
    UnknownModel {
        /// The drive.
        drive: String,
        /// What would have to be known.
        what: &'static str,
        /// Vendor.
        vendor_id: u16,
        /// Device.
        device_id: u16,
    },
    /// There is no room for the parameter tables of one more kind of drive.
    #[error(
        "{drive}: no room for the parameter tables of one more kind of drive, this program has stored {} parameters of drives without a built-in catalogue, the most that it may",
        crate::learn::MOST_ROWS
    )]
    TooManyKinds {
        /// The drive.
        drive: String,
    },
    /// Nothing is written while the axis may move.
    #[error("{drive}: {what}, nothing is written")]
    NotAtRest {
        /// The drive.
        drive: String,
        /// What was found.
        what: &'static str,
    },
    /// What was done could not be noted, so nothing more was done.
    #[error("{drive}: stopped: {source}")]
    Journal {
        /// The drive.
        drive: String,
        /// Why not.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The fault buffer changed during every attempt to read it.
    #[error("{drive}: the fault buffer changed while it was read, {attempts} times")]
    Changing {
        /// The drive.
        drive: String,
        /// How often it was read.
        attempts: u8,
    },
    /// Nothing came back in time.
    #[error("{drive}: {what}: nothing within {} ms", .limit.as_millis())]
    Timeout {
        /// The drive.
        drive: String,
        /// What was waited for.
        what: &'static str,
        /// How long.
        limit: Duration,
    },
    /// The drive does not exchange data in this update time.
    #[error("no update time of {}: offered are {}", times_text(std::slice::from_ref(.asked)), times_text(.offered))]
    UpdateTime {
        /// What was requested.
        asked: Duration,
        /// What the drive offers, shortest first.
        offered: Vec<Duration>,
    },
    /// Requested something that cannot be.
    #[error(transparent)]
    Misuse(#[from] Misuse),
}
