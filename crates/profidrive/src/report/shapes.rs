//! The shapes that reports share.

use client::axis::SpeedUnit;
use client::{Advice, ErrorKind, FaultEntry, Refusal, Snapshot, WarningEntry};
use dissect::words;
use profile::catalogue::{Cleared, vendor_name};
use profile::model::Model;
use profile::state::{Mode, Profile, State, Zsw1};
use profile::value::{Beyond, Reading};
use profinet::wire::dcp::role;
use serde::Serialize;
use uss::Protocol;

use super::{DriveState, Parameter, ParameterError, Word};

/// The words of a front end for what to do: no library words a command.
pub trait Wording {
    /// Returns the call of the front end that carries out an action; `None` where it has none.
    fn command(&self, action: &client::Action) -> Option<String>;

    /// Returns advice with the calls of the front end in it.
    fn advice(&self, advice: &Advice) -> String;
}

/// The wording of a program without commands: each action by its name.
#[derive(Debug, Clone, Copy, Default)]
pub struct PlainWording;

impl Wording for PlainWording {
    fn command(&self, _: &client::Action) -> Option<String> {
        None
    }

    fn advice(&self, advice: &Advice) -> String {
        advice.to_string()
    }
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quantity {
    /// The number.
    pub value: f64,
    /// Its unit: `rpm`, `%`, `rev`, `V`; empty for none.
    pub unit: String,
    /// `>` or `<` where a measured value may be higher or lower: its signal has no number beyond.
    pub beyond: Option<String>,
}

impl Quantity {
    /// Returns a number with its unit.
    #[must_use]
    pub fn new(value: f64, unit: impl Into<String>) -> Self {
        Self {
            value,
            unit: unit.into(),
            beyond: None,
        }
    }

    /// Returns a speed.
    #[must_use]
    pub fn speed(value: f64, unit: SpeedUnit) -> Self {
        Self::new(value, unit.symbol())
    }

    /// Returns a speed in rpm.
    #[must_use]
    pub fn rpm(value: f64) -> Self {
        Self::new(value, "rpm")
    }

    /// Returns a position or a distance in turns.
    #[must_use]
    pub fn turns(value: f64) -> Self {
        Self::new(value, "rev")
    }

    /// Returns the same with the end of the numbers that a measured value is at.
    #[must_use]
    pub fn beyond(mut self, end: Option<Beyond>) -> Self {
        self.beyond = end.map(|end| end.sign().to_owned());
        self
    }

    /// Returns the number of a reading; `None` for text.
    #[must_use]
    pub fn of(reading: &Reading) -> Option<Self> {
        let number = reading.number()?;
        Some(Self::new(number, reading.unit).beyond(reading.beyond()))
    }
}

/// State of a drive, with the control and status word that it is decoded from. The bits have the names of the vendor's words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DriveWords {
    /// State of the drive.
    pub state: Option<DriveState>,
    /// Whose words these are: `PROFIdrive`, `FC profile`, ..
    pub profile: &'static str,
    /// Mode that decides over the bits: `velocity` or `position`.
    pub mode: &'static str,
    /// Control word that the drive acts on.
    pub stw1: Option<Word>,
    /// Status word of the drive.
    pub zsw1: Option<Word>,
    /// Whether the status word reports a fault.
    pub fault_bit: Option<bool>,
    /// Whether the status word reports a warning.
    pub warning_bit: Option<bool>,
}

impl DriveWords {
    /// Returns the words of a drive that cannot be read.
    #[must_use]
    pub fn unknown() -> Self {
        Self::of(Profile::Profidrive, Mode::Velocity, None, None)
    }

    /// Returns state and words of a drive with the names of its profile.
    #[must_use]
    pub fn of(profile: Profile, mode: Mode, sent: Option<u16>, status: Option<u16>) -> Self {
        let general = status.map(|status| profile.zsw1(status, sent.unwrap_or_default()));
        let runs = general.is_some_and(|word| word.has(Zsw1::READY_TO_OPERATE));
        let commanded = sent.map(|word| {
            let state = if runs { State::S4 } else { State::S2 };
            profile.orders(word, state).stw1.0
        });
        Self {
            state: general.and_then(|word| DriveState::of(word.0, commanded)),
            profile: profile.name(),
            mode: mode.name(),
            stw1: sent.map(|word| {
                let meaning = words::control_meaning(profile, mode, word);
                Word::of(profile.control_bits(mode), word, word, Some(meaning))
            }),
            zsw1: status.zip(general).map(|(word, general)| {
                let meaning = words::state(general.0, commanded);
                Word::of(profile.status_bits(mode), word, word, Some(meaning))
            }),
            fault_bit: general.map(|word| word.has(Zsw1::FAULT)),
            warning_bit: general.map(|word| word.has(Zsw1::WARNING)),
        }
    }
}

impl From<&Snapshot> for DriveWords {
    fn from(snapshot: &Snapshot) -> Self {
        Self::of(snapshot.profile, snapshot.mode, snapshot.stw1, snapshot.zsw1)
    }
}

/// A fault of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fault {
    /// The vendor's number.
    pub number: u16,
    /// What it means.
    pub meaning: Option<String>,
    /// What the drive does about it.
    pub reaction: Option<String>,
    /// What to do.
    pub remedy: Option<String>,
    /// The parameters that the remedy names, by name or number as their vendor writes them.
    pub parameters: Vec<String>,
    /// What ends it once the cause is gone.
    pub cleared: Option<String>,
    /// Whether only switching off and on ends it.
    pub needs_restart: Option<bool>,
    /// Fault situation: 0 is not acknowledged yet, 1 the last acknowledged.
    pub situation: u8,
    /// Position in its situation; 0 is the fault that came first.
    pub position: u8,
    /// Whether it was acknowledged.
    pub acknowledged: bool,
    /// When it came, in the drive's own time (PNU 948).
    pub time: Option<i64>,
    /// What else the drive noted (PNU 949).
    pub value: Option<i64>,
}

impl From<&FaultEntry> for Fault {
    fn from(entry: &FaultEntry) -> Self {
        Self {
            number: entry.number,
            meaning: entry.meaning.map(str::to_owned),
            reaction: entry.reaction.map(|reaction| reaction.text().to_owned()),
            remedy: entry.remedy.map(str::to_owned),
            parameters: entry.parameters.clone(),
            cleared: entry.clearing.clone(),
            needs_restart: entry.cleared.map(|cleared| cleared == Cleared::Restart),
            situation: entry.situation,
            position: entry.position,
            acknowledged: entry.situation > 0,
            time: entry.time,
            value: entry.value,
        }
    }
}

/// A warning of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Warning {
    /// The vendor's number.
    pub number: u32,
    /// What it means.
    pub meaning: Option<String>,
    /// What to do.
    pub remedy: Option<String>,
    /// The parameters that the remedy names, by name or number as their vendor writes them.
    pub parameters: Vec<String>,
}

impl From<&WarningEntry> for Warning {
    fn from(entry: &WarningEntry) -> Self {
        Self {
            number: entry.number,
            meaning: entry.meaning.map(str::to_owned),
            remedy: entry.remedy.map(str::to_owned),
            parameters: entry.parameters.clone(),
        }
    }
}

/// A station on the network, as it answers to discovery.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Station {
    /// Name of station.
    pub name: Option<String>,
    /// Ethernet address.
    pub mac: String,
    /// IP address.
    pub ip: Option<String>,
    /// Subnet mask.
    pub mask: Option<String>,
    /// Prefix length of the subnet mask.
    pub prefix: Option<u8>,
    /// Gateway.
    pub gateway: Option<String>,
    /// VendorID.
    pub vendor_id: u16,
    /// Name of the vendor, where it is in the tables.
    pub vendor: Option<&'static str>,
    /// DeviceID.
    pub device_id: u16,
    /// Instance of the device.
    pub instance: u16,
    /// Type of station in the vendor's words.
    #[serde(rename = "type")]
    pub station_type: String,
    /// `device`, `controller` or `supervisor`.
    pub role: Option<&'static str>,
    /// Model whose tables are built in: `AKD`, `VLT`, `Vacon`.
    pub model: Option<&'static str>,
}

impl From<&profinet::controller::Station> for Station {
    fn from(station: &profinet::controller::Station) -> Self {
        let ip = station.ip;
        let set = ip.is_set();
        let model = Model::of(station.vendor_id, station.device_id);
        let roles = [
            (role::CONTROLLER, "controller"),
            (role::SUPERVISOR, "supervisor"),
            (role::DEVICE, "device"),
        ];
        let role = roles.into_iter().find(|(bit, _)| station.role & bit != 0);
        Self {
            name: Some(station.name.clone()).filter(|name| !name.is_empty()),
            mac: station.mac.to_string(),
            ip: set.then(|| ip.address.to_string()),
            mask: set.then(|| ip.mask.to_string()),
            prefix: u8::try_from(u32::from(ip.mask).leading_ones())
                .ok()
                .filter(|_| set),
            gateway: (!ip.gateway.is_unspecified()).then(|| ip.gateway.to_string()),
            vendor_id: station.vendor_id,
            vendor: vendor_name(station.vendor_id),
            device_id: station.device_id,
            instance: station.instance,
            station_type: station.station_type.clone(),
            role: role.map(|(_, name)| name),
            model: model.catalogue.map(|_| model.name),
        }
    }
}

/// Who has the cyclic connection of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Controller {
    /// Whether a controller is connected.
    pub connected: bool,
    /// Its name, where it has one.
    pub name: Option<String>,
}

impl Controller {
    /// Returns the controller that a drive reports: `Some(None)` where none is connected.
    #[must_use]
    pub fn of(controller: Option<&Option<String>>) -> Option<Self> {
        controller.map(|name| Self {
            connected: name.is_some(),
            name: name.clone().filter(|name| !name.is_empty()),
        })
    }
}

/// Something to do next.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Action {
    /// What it is: `stop`, `write`, `acknowledge`, ..
    pub action: &'static str,
    /// What it is done with: a device, parameters, `PARAMETER=VALUE`, a choice.
    pub arguments: Vec<String>,
    /// The call that does it; null where it is a choice of the call that was made.
    pub command: Option<String>,
}

impl Action {
    /// Returns an action with the call of a front end.
    #[must_use]
    pub fn of(action: &client::Action, wording: &dyn Wording) -> Self {
        Self {
            action: action.id(),
            arguments: action.arguments(),
            command: wording.command(action),
        }
    }

    /// Returns the actions of an advice.
    #[must_use]
    pub fn all(advice: &Advice, wording: &dyn Wording) -> Vec<Self> {
        advice.actions().map(|action| Self::of(action, wording)).collect()
    }
}

/// What a drive does when its controller is lost.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LossReaction {
    /// `ramp`, `quick-stop`, `coast`, `stop`, `keeps-turning` or `unknown`.
    pub action: &'static str,
    /// The parameter that decides.
    pub parameter: Option<String>,
    /// Its setting.
    pub setting: Option<String>,
    /// Seconds from the last control word until the drive reacts.
    pub after: Option<f64>,
    /// The same in words: `the drive keeps turning (8-04 is Off)`.
    pub text: String,
}

impl From<&client::LossReaction> for LossReaction {
    fn from(loss: &client::LossReaction) -> Self {
        Self {
            action: loss.action.id(),
            parameter: loss.parameter.clone(),
            setting: loss.setting.clone(),
            after: loss.after.map(|after| after.as_secs_f64()),
            text: loss.to_string(),
        }
    }
}

/// Why a verb failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Error {
    /// What kind of error it is: `usage`, `refused`, `unreachable`, `lost`, `safety`, `fault`, `not_reached`, `partial`,
    /// `difference`, `unsupported`, `interrupted`, `local` or `internal`.
    pub kind: &'static str,
    /// What was tried, on which drive and parameter, and what came back.
    pub message: String,
    /// What the message lists.
    pub details: Vec<String>,
    /// What to do.
    pub hint: Option<String>,
    /// The actions in it.
    pub actions: Vec<Action>,
}

impl Error {
    /// Returns an error with the words of a front end for its advice.
    #[must_use]
    pub fn new(
        kind: ErrorKind,
        message: &str,
        details: &[String],
        advice: &Advice,
        wording: &dyn Wording,
    ) -> Self {
        Self {
            kind: kind.id(),
            message: message.to_owned(),
            details: details.to_vec(),
            hint: (!advice.is_empty()).then(|| wording.advice(advice)),
            actions: Action::all(advice, wording),
        }
    }
}

/// Returns a value of a parameter, or why it was not read.
#[must_use]
pub fn parameter(reading: &Result<Reading, Refusal>, wording: &dyn Wording) -> Parameter {
    match reading {
        Ok(reading) => reading.into(),
        Err(refusal) => Parameter {
            pnu: refusal.shown.pnu,
            index: refusal.shown.index,
            number: refusal.shown.to_string(),
            name: refusal.name.map(str::to_owned),
            value: None,
            text: None,
            unit: String::new(),
            meaning: None,
            word: None,
            beyond: None,
            raw: None,
            hex: None,
            format: None,
            writable: refusal.shown.writable,
            error: Some(parameter_error(refusal, wording)),
        },
    }
}

/// Returns the reason why a parameter was not read or written.
#[must_use]
pub fn parameter_error(refusal: &Refusal, wording: &dyn Wording) -> ParameterError {
    let sent = !refusal.is_unsent();
    ParameterError {
        number: refusal.received(),
        meaning: refusal.words(),
        information: refusal.information.filter(|_| sent),
        remedy: refusal.remedy().map(|remedy| wording.advice(&remedy)),
        channel: match refusal.channel.map(|channel| channel.protocol) {
            None => "records",
            Some(Protocol::Fc) => "fc",
            Some(Protocol::Uss) => "uss",
        },
        sent,
    }
}
