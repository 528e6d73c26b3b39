//! Everything that can go wrong between a person's wish and a drive, by kind.

use std::fmt;
use std::time::Duration;

use profidrive::catalogue::name_distance;
use profidrive::notation::Shown;
use profidrive::parameter::{ErrorNames, ErrorNumber};
use profidrive::pkw::{JobError, PkwErrorNames};
use profinet::MacAddress;
use profinet::controller::{DcpError, LostCause, Misuse, ServiceError, Station};
use profinet::wire::PnioStatus;

use crate::DriveAddress;
use profidrive::state::Mode;

use crate::axis::{Evidence, NoTelegram, Objection, Trouble};
use crate::parameter::ParameterProblem;

/// Why something did not come about.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The medium failed: interface gone, permission lost.
    #[error("the network interface failed: {0}")]
    Medium(Box<dyn std::error::Error + Send + Sync>),
    /// The caller was asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// Nobody of this name or address answered.
    #[error("no station {drive} answered{}", others(.drive, .heard))]
    NotFound {
        /// Who was looked for.
        drive: DriveAddress,
        /// Who answered instead.
        heard: Vec<Station>,
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
    /// The station has no IP address yet.
    #[error("{drive} has no IP address, records cannot be reached")]
    NoIpAddress {
        /// The drive.
        drive: String,
    },
    /// Nobody answers at this address of a serial line.
    #[error("no answer from {drive}{}", in_place(*.telegrams, *.noise))]
    NoAnswer {
        /// Who was asked.
        drive: DriveAddress,
        /// Telegrams heard of others.
        telegrams: u64,
        /// Octets and telegrams that make no sense.
        noise: u64,
    },
    /// A drive at a serial line does not answer any more.
    #[error("{drive} does not answer any more")]
    LineSilent {
        /// The drive.
        drive: String,
    },
    /// The parameter channel of a serial line did not do what was wanted.
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
    /// A drive at a serial line was asked for on a network, or the other way about.
    #[error("{drive} is not to be reached this way")]
    OtherWire {
        /// Who was asked for.
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
    /// Another controller owns what was asked for.
    #[error("{drive} refuses control: another controller owns it ({cause})")]
    OwnedByController {
        /// The drive.
        drive: String,
        /// What the drive said.
        cause: String,
    },
    /// A connection ended that was wanted.
    #[error("{drive}: connection lost: {cause}")]
    ConnectionLost {
        /// The drive.
        drive: String,
        /// Why.
        cause: LostCause,
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
    /// The drive refused one parameter.
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
    /// The axis did not do what was wanted.
    #[error("{drive}: {trouble}")]
    Axis {
        /// The drive.
        drive: String,
        /// What happened.
        trouble: Trouble,
    },
    /// The drive is in another mode than this needs. It is not changed without being told to.
    #[error("{drive} is in {present}, this needs {}", mode_words(*needed))]
    WrongMode {
        /// The drive.
        drive: String,
        /// The mode needed.
        needed: Mode,
        /// The mode it is in, in words.
        present: String,
    },
    /// No telegram of the drive carries what is needed.
    #[error("{drive}: {problem}")]
    Telegram {
        /// The drive.
        drive: String,
        /// What is missing.
        problem: NoTelegram,
    },
    /// The module plugged is of a maker's file that nobody here knows, and it is not the telegram that is needed.
    #[error("{drive} has {} plugged in a module that is not in the tables; the ident number of the module of telegram {wanted} is not known", telegram_text(*.plugged))]
    ForeignModule {
        /// The drive.
        drive: String,
        /// The telegram plugged (PNU 922).
        plugged: Option<u16>,
        /// The telegram needed.
        wanted: u16,
    },
    /// Somebody at the drive itself commands it; nothing was sent.
    #[error("{drive} is in local operation: {}", local_text(*.enabled))]
    LocalOperation {
        /// The drive.
        drive: String,
        /// It is enabled (S4) from there.
        enabled: bool,
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
    /// The axis did not come up to its speed; it is being stopped.
    #[error("{drive}: {wanted} rpm not reached within {:.1} s, the highest speed was {}", .limit.as_secs_f64(), rpm_text(*.highest))]
    SpeedNotReached {
        /// The drive.
        drive: String,
        /// Speed asked for.
        wanted: f64,
        /// Highest speed in that direction, where the telegram tells speeds.
        highest: Option<f64>,
        /// How long.
        limit: Duration,
    },
    /// The axis had its speed and does not follow any more; it is being stopped.
    #[error("{drive}: {wanted} rpm was reached and is not kept: {} for {:.1} s", rpm_text(*.actual), .time.as_secs_f64())]
    SpeedLost {
        /// The drive.
        drive: String,
        /// Speed asked for.
        wanted: f64,
        /// Speed it has, where the telegram tells speeds.
        actual: Option<f64>,
        /// How long it was away from its speed.
        time: Duration,
    },
    /// Somebody changed what the speed setpoint means while the axis ran; it is being stopped.
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
    /// A speed that rounds to a standstill; nothing was sent.
    #[error(
        "{drive}: {wanted} rpm is less than half a step of its speed setpoint, which is {step:.4} rpm: it would stand"
    )]
    SpeedStep {
        /// The drive.
        drive: String,
        /// Speed asked for.
        wanted: f64,
        /// The smallest speed that can be told, rpm.
        step: f64,
    },
    /// The axis is held by something; what the drive said while it was still in operation.
    #[error("{error}; {evidence}")]
    Held {
        /// What went wrong.
        error: Box<Error>,
        /// What the drive said.
        evidence: Evidence,
    },
    /// A speed that the caller did not allow.
    #[error("{wanted} rpm is above the limit of {limit} rpm")]
    SpeedLimit {
        /// Speed wanted.
        wanted: f64,
        /// Speed allowed.
        limit: f64,
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
    /// A drive nobody has tables of, and no room for those it tells.
    #[error(
        "{drive}: no room for the tables of one more kind of drive, this program has learned {} already",
        crate::learn::MOST_KINDS
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
    /// Asked for something that cannot be.
    #[error(transparent)]
    Misuse(#[from] Misuse),
}

/// One parameter that a drive refused to read or write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// Number and element.
    pub shown: Shown,
    /// Name, where known.
    pub name: Option<&'static str>,
    /// True for a write.
    pub write: bool,
    /// The drive's error number.
    pub number: ErrorNumber,
    /// Whose words its own numbers have.
    pub names: ErrorNames,
    /// Additional information of the drive: often the element at fault.
    pub information: Option<u16>,
    /// What to do about it for this parameter, where the tables of the drive know more than the number says.
    pub advice: Option<&'static str>,
}

impl Refusal {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> Option<&'static str> {
        let general = || self.number.info(self.names).map(|info| info.remedy);
        self.advice.or_else(general)
    }

    /// The number with its meaning.
    #[must_use]
    pub fn words(&self) -> String {
        self.number.words(self.names)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = if self.write { "writing" } else { "reading" };
        match self.name {
            Some(name) => write!(f, "{verb} {name} ({}) refused: {}", self.shown, self.words())?,
            None => write!(f, "{verb} {} refused: {}", self.shown, self.words())?,
        }
        self.information
            .filter(|&info| info != 0)
            .map_or(Ok(()), |info| write!(f, " (information {info})"))
    }
}

/// What was heard instead of an answer.
fn in_place(telegrams: u64, noise: u64) -> String {
    match (telegrams, noise) {
        (0, 0) => "; the line is silent".into(),
        (_, 0) => "; others answer on this line".into(),
        _ => format!("; {noise} octets or telegrams came that make no sense"),
    }
}

/// PNU 930 in words.
pub(crate) const fn mode_words(mode: Mode) -> &'static str {
    match mode {
        Mode::Velocity => "velocity mode (PNU 930 = 1)",
        Mode::Position => "position mode (PNU 930 = 2)",
    }
}

/// What was tried and why it failed; said once where the reason begins with it.
fn once(what: &str, error: &ServiceError) -> String {
    let error = error.to_string();
    if error.starts_with(what) {
        error
    } else {
        format!("{what}: {error}")
    }
}

fn local_text(enabled: bool) -> &'static str {
    if enabled {
        "it is enabled (S4) though no controller commands it"
    } else {
        "it does not ask for control by the field bus (ZSW1 bit 9 is 0)"
    }
}

fn rpm_text(speed: Option<f64>) -> String {
    speed.map_or_else(|| "not told".into(), |speed| format!("{speed:.1} rpm"))
}

fn telegram_text(number: Option<u16>) -> String {
    number.map_or_else(
        || "an unknown telegram".into(),
        |number| format!("telegram {number}"),
    )
}

fn objections_text(objections: &[Objection]) -> String {
    let texts: Vec<String> = objections.iter().map(ToString::to_string).collect();
    texts.join("; ")
}

/// What to do about each of them; the same advice once.
fn hints(objections: &[Objection]) -> Option<String> {
    let mut hints: Vec<&str> = Vec::new();
    for hint in objections.iter().map(Objection::hint) {
        if !hints.contains(&hint) {
            hints.push(hint);
        }
    }
    (!hints.is_empty()).then(|| hints.join("; "))
}

/// Most stations of a list in a message.
const MOST_TOLD: usize = 8;

/// Who answered instead; of many those next to what was looked for.
fn others(drive: &DriveAddress, stations: &[Station]) -> String {
    if stations.is_empty() {
        return "; nobody else answered either".into();
    }
    let mut nearest: Vec<&Station> = stations.iter().collect();
    if nearest.len() > MOST_TOLD {
        nearest.sort_by_cached_key(|station| {
            let far = match drive {
                DriveAddress::Name(name) => name_distance(name, &station.name) as u64,
                DriveAddress::Ip(ip) => u32::from(*ip).abs_diff(station.ip.address.into()).into(),
                DriveAddress::Mac(mac) => number(*mac).abs_diff(number(station.mac)),
                DriveAddress::Line(_) => 0,
            };
            (far, station.name.clone(), station.mac)
        });
    }
    let more = nearest.len().saturating_sub(MOST_TOLD);
    let names: Vec<String> = nearest.into_iter().take(MOST_TOLD).map(describe).collect();
    let list = names.join(", ");
    match more {
        0 => format!("; heard: {list}"),
        _ => format!("; heard {}, the nearest: {list} and {more} more", stations.len()),
    }
}

fn number(mac: MacAddress) -> u64 {
    mac.0
        .iter()
        .fold(0, |number, octet| number << 8 | u64::from(*octet))
}

/// Faulty IOCRBlockReq: send clock, reduction ratio.
const fn faulty_timing(status: PnioStatus) -> bool {
    status.code1 == 2 && matches!(status.code2, 10 | 11)
}

/// A station in a few words: `akd-1 (02:50:4e:00:00:01, 10.0.0.2)`.
#[must_use]
pub fn describe(station: &Station) -> String {
    let name = if station.name.is_empty() {
        "no name"
    } else {
        &station.name
    };
    if station.mac == MacAddress::default() {
        // found by its IP address alone
        station.ip.address.to_string()
    } else if station.ip.is_set() {
        format!("{name} ({}, {})", station.mac, station.ip.address)
    } else {
        format!("{name} ({}, no IP address)", station.mac)
    }
}

fn join(macs: &[MacAddress]) -> String {
    macs.iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join(" and ")
}

impl Error {
    /// What to do about it, where that can be said.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::NotFound { heard, .. } if heard.is_empty() => {
                "check cable, interface and power; `profidrive scan` lists who answers".into()
            }
            Self::NotFound { .. } => "`profidrive scan` lists who answers".into(),
            Self::Ambiguous { .. } => {
                "use the MAC address; `profidrive blink MAC` shows which is which, `profidrive name MAC NAME` renames one"
                    .into()
            }
            Self::NoIpAddress { .. } => "give it one: `profidrive ip DRIVE A.B.C.D/NN`".into(),
            Self::OwnedByController { .. } => {
                "stop or disconnect the other controller first; `profidrive monitor` and `read` work beside it".into()
            }
            Self::Connect {
                cause: LostCause::Service(ServiceError::Refused { status, .. }),
                ..
            } if faulty_timing(*status) => {
                "the drive does not offer this update time; without --cycle the fastest it is known for is used".into()
            }
            Self::Refused { refusal, .. } => refusal.remedy()?.into(),
            Self::Parameter(problem) => problem.hint()?,
            Self::Axis { trouble, .. } => match trouble {
                Trouble::Fault => "`profidrive faults DRIVE` shows the fault, `profidrive ack DRIVE` acknowledges it",
                Trouble::FaultStays => "remove the cause, then acknowledge again",
                Trouble::LocalOperation => "hand control over to the PLC at the drive or in its software",
                Trouble::StuckIn { .. } => {
                    "check enable inputs, STO and DC bus: `profidrive read DRIVE DRV.DISSOURCES`"
                }
                Trouble::LeftOperation { .. } => "something else switched it off: check enable inputs and STO",
                Trouble::StillTurns => "keep clear of it; apply a brake (MOTOR.BRAKE) or take the load away",
                Trouble::QuickStopUsed | Trouble::NotStopped => "check the deceleration of the drive and the load",
                Trouble::NoInputs => "the telegram module is not usable in this drive: `profidrive info DRIVE`",
                Trouble::OtherMode { .. } => "`profidrive read DRIVE p930` shows the mode",
                Trouble::NotAccepted { homed: false } => "`profidrive home DRIVE` sets the home position",
                Trouble::NotAccepted { homed: true } | Trouble::AcceptanceStays | Trouble::TargetNotReached => {
                    "`profidrive status DRIVE` tells why: faults, warnings, limits, the task itself"
                }
                Trouble::HomingNotStarted | Trouble::HomingFailed => {
                    "check HOME.MODE, HOME.V and the switches: `profidrive list DRIVE --filter HOME. --values`"
                }
            }
            .into(),
            Self::Record {
                error: ServiceError::NotReady { .. },
                ..
            } => "the drive is there, but its parameter channel does not answer: another tool may hold it, or it is busy; try again"
                .into(),
            Self::Changing { .. } => "read it again; faults that come and go have a cause that comes and goes".into(),
            Self::NotAtRest { .. } => {
                "switch it off first (OFF1, or stop its controller); `profidrive status DRIVE` says why it is on".into()
            }
            Self::WrongMode { drive, needed, .. } => {
                let number = match needed {
                    Mode::Velocity => 1,
                    Mode::Position => 2,
                };
                format!("`profidrive write {drive} 930={number}` changes it, --set-mode does for this one command")
            }
            Self::ForeignModule { drive, wanted, .. } => {
                format!("`profidrive write {drive} 922={wanted}` selects it where the drive allows that")
            }
            Self::LocalOperation { drive, .. } => format!(
                "switch it off there (service channel: `profidrive stop {drive} --disable`) and hand control over to the field bus"
            ),
            Self::SpeedLost { .. } => {
                "something else stopped or limits it (`profidrive stop`, VL.LIMITP, a limit switch) or the load holds it".into()
            }
            Self::ScaleChanged { .. } => {
                "find out who writes PN.VELSCALING (1009, 3064); change it while the axis is off only".into()
            }
            Self::SpeedStep { .. } => "ask for a higher speed, or make the steps finer (PN.VELSCALING)".into(),
            Self::SpeedNotReached { .. } => {
                "the ramp (DRV.ACC), a limit of the drive (VL.LIMITP, VL.LIMITN, IL.LIMITP) or the load holds it".into()
            }
            Self::Held { error, evidence } => evidence.hint().map_or_else(|| error.hint(), |hint| Some(hint.into()))?,
            Self::NotEnabled { .. } => "enable it again".into(),
            Self::Objections { objections, .. } => hints(objections)?,
            Self::NotInTime { .. } => "--timeout gives it more time; `profidrive status DRIVE` tells what holds it".into(),
            Self::SpeedLimit { .. } => "raise the limit with --limit if the machine allows it".into(),
            Self::NoAnswer { telegrams, noise, .. } => match (telegrams, noise) {
                (0, 0) => "check that the drive is on, its address and protocol (VLT: 8-30, 8-31), A and B of the wire",
                (_, 0) => "check the address of the drive (VLT: 8-31)",
                _ => "check baud rate and parity (VLT: 8-32, 8-33), and the termination of the line",
            }
            .into(),
            Self::LineSilent { .. } => {
                "check line and adapter; the drive stops by itself only where its time-out is set to that (VLT: 8-03, 8-04)"
                    .into()
            }
            Self::Channel { error, .. } => error.remedy(PkwErrorNames::Profile).into(),
            Self::OtherWire { .. } => {
                "fc:PORT/ADDRESS and uss:PORT/ADDRESS are at a serial line, all others on a network".into()
            }
            Self::ConnectionLost { .. } => {
                "the drive stops by itself (AKD: F702); `profidrive ack DRIVE` once it is reachable again".into()
            }
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stations(count: u8) -> Vec<Station> {
        let station = |last| Station {
            name: format!("akd-{last}"),
            mac: MacAddress([2, 0x50, 0x4E, 0, 0, last]),
            ip: profinet::IpSuite {
                address: [10, 0, 0, last].into(),
                ..profinet::IpSuite::NONE
            },
            ..Station::default()
        };
        (1..=count).map(station).collect()
    }

    #[test]
    fn each_objection_to_a_move_has_its_own_advice() {
        let limit = |upper| Objection::SoftwareLimit {
            target: 10.0,
            limit: 9.5,
            upper,
        };
        let error = Error::Objections {
            drive: "akd-1".into(),
            objections: vec![Objection::NotHomed, limit(true), limit(false)],
        };
        let hint = error.hint().unwrap();
        assert!(
            hint.starts_with("`profidrive home DRIVE` sets the home position; `profidrive read"),
            "{hint}"
        );
        assert_eq!(hint.matches("SWLS.LIMIT1").count(), 1, "{hint}");
    }

    #[test]
    fn a_channel_that_is_never_ready_is_told_once() {
        let error = Error::Record {
            drive: "akd-1".into(),
            what: "parameter access".into(),
            error: ServiceError::NotReady {
                limit: Duration::from_secs(10),
                status: PnioStatus {
                    code: 0xDE,
                    decode: 0x80,
                    code1: 0xB5,
                    code2: 0,
                },
            },
        };
        let told = error.to_string();
        assert!(
            told.starts_with("akd-1: parameter access: not ready within 10000 ms"),
            "{told}"
        );
        assert!(error.hint().is_some_and(|hint| hint.contains("try again")));
    }

    #[test]
    fn of_many_stations_the_nearest_are_told() {
        for (drive, first) in [
            ("akd-64x", "akd-64 (02:50:4e:00:00:40, 10.0.0.64)"),
            ("10.0.0.99", "akd-80 (02:50:4e:00:00:50, 10.0.0.80)"),
            ("02:50:4e:00:00:00", "akd-1 (02:50:4e:00:00:01, 10.0.0.1)"),
        ] {
            let not_found = |count| Error::NotFound {
                drive: drive.parse().unwrap(),
                heard: stations(count),
            };
            let told = not_found(80).to_string();
            assert!(
                told.contains(&format!("; heard 80, the nearest: {first}, ")),
                "{told}"
            );
            assert!(told.ends_with(" and 72 more"), "{told}");
            let all = not_found(8).to_string();
            assert!(
                all.contains("; heard: akd-1 (") && all.contains("akd-8 ("),
                "{all}"
            );
        }
    }
}
