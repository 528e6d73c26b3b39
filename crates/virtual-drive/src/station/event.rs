//! Events of a station.

use profile::catalogue::Catalogue;
use profile::notation::figures;
use profile::parameter::SaveId;
use profile::state::State;
use profinet::device::{SetRefusal, Stored};
use profinet::wire::PnioStatus;
use profinet::{IpSuite, MacAddress};

use crate::drive::{Event as DriveEvent, Written, WrittenValue};
use crate::store::ImageError;

/// An event that the owner has to handle or may report.
#[derive(Debug, Clone, PartialEq)]
pub enum StationEvent {
    /// Store this over a restart: name, address and I&M data that were set permanently.
    PersistNetwork {
        /// All of it.
        network: Stored,
        /// Number of the save, for the `report_network` of the station.
        save: SaveId,
    },
    /// Keep this text over a restart.
    PersistParameters {
        /// Image of the saved parameters.
        text: String,
        /// A client requested it. Otherwise the drive saves its counters, which is not reported.
        asked: bool,
        /// Number of the save, for the `report_save` of the station.
        save: SaveId,
    },
    /// The saved parameters could not be used; the drive has the values as delivered.
    ParametersIgnored(ImageError),
    /// A change by DCP was refused.
    SetRefused {
        /// Origin of the request.
        source: MacAddress,
        /// Why.
        refusal: SetRefusal,
    },
    /// Show which drive this is.
    Blink,
    /// Restarts by command (DRV.REBOOT, VLT 9-72).
    Restarting,
    /// Takes its address by the settings of now (IP.RESET).
    AddressApplied,
    /// The address settings are those of the delivery at the next power-on (button B1).
    AddressReset,
    /// Has an address that no DCP set, [`IpSuite::NONE`] when it is lost.
    AddressFound(IpSuite),
    /// Ignores a setpoint of the telegram that is outside its limits.
    SetpointIgnored {
        /// Number of the setpoint.
        pnu: u16,
        /// As it came.
        raw: i64,
    },
    /// A parameter was written.
    Written(Written),
    /// Refused a command that the virtual drive does not simulate.
    Unable {
        /// Number of the command.
        pnu: u16,
    },
    /// An AR was opened.
    Connected {
        /// A controller, else a tool that reads and writes parameters.
        controller: bool,
        /// Name of the other station.
        station: String,
    },
    /// The controller and the drive exchange data.
    Exchanging {
        /// Telegram in use.
        telegram: u16,
    },
    /// The connection of the controller ended.
    Disconnected {
        /// Why.
        cause: PnioStatus,
    },
    /// The master of a serial line has control.
    MasterTook,
    /// The master of a serial line is silent.
    MasterGone {
        /// It had control; else it had given it back.
        lost: bool,
    },
    /// The profile state changed.
    State {
        /// Before.
        from: State,
        /// Now.
        to: State,
    },
    /// A fault came.
    Fault {
        /// Its number.
        number: u16,
    },
    /// The faults were acknowledged.
    Acknowledged,
    /// A warning came or went.
    Warning {
        /// Its number.
        number: u16,
        /// True when it came.
        active: bool,
    },
}

impl From<DriveEvent> for StationEvent {
    fn from(event: DriveEvent) -> Self {
        match event {
            DriveEvent::State { from, to } => Self::State { from, to },
            DriveEvent::Fault { number } => Self::Fault { number },
            DriveEvent::Acknowledged => Self::Acknowledged,
            DriveEvent::Warning { number, active } => Self::Warning { number, active },
            DriveEvent::Save { text, asked, save } => Self::PersistParameters { text, asked, save },
            DriveEvent::Blink => Self::Blink,
            DriveEvent::Restart => Self::Restarting,
            DriveEvent::ApplyAddress => Self::AddressApplied,
            DriveEvent::AddressReset => Self::AddressReset,
            DriveEvent::Ignored { pnu, raw } => Self::SetpointIgnored { pnu, raw },
            DriveEvent::Written(written) => Self::Written(written),
            DriveEvent::Unable { pnu } => Self::Unable { pnu },
        }
    }
}

impl StationEvent {
    /// Returns a text of the event; the meaning of fault numbers is from `catalogue`. `None` for what only requests to
    /// be kept.
    #[must_use]
    pub fn words(&self, catalogue: &Catalogue) -> Option<String> {
        let meaning = |number, warning| catalogue.fault(number, warning).map_or("", |fault| fault.meaning);
        Some(match self {
            Self::SetRefused { source, refusal } => refused(*source, *refusal),
            Self::Blink => "blinks".into(),
            Self::Restarting => "restarts by command".into(),
            Self::AddressApplied => "applies IP.MODE (IP.RESET)".into(),
            Self::AddressReset => "address settings reset, effective at the next power-on".into(),
            Self::AddressFound(suite) if suite.is_set() => format!("address {}", suite.address),
            Self::AddressFound(_) => "address lost".into(),
            Self::SetpointIgnored { pnu, raw } => {
                let name = catalogue.by_pnu(*pnu).map_or("", |parameter| parameter.name);
                format!("setpoint {name} ({pnu}) = {raw} ignored: outside its limits, the last value stays")
            }
            Self::Unable { pnu } => {
                let name = catalogue.by_pnu(*pnu).map_or("", |parameter| parameter.name);
                format!(
                    "{name} ({pnu}) refused with error 0x11: the virtual drive does not simulate this command"
                )
            }
            Self::Written(written) => words_of(written, catalogue),
            Self::Connected { controller, station } => {
                let kind = if *controller {
                    "controller"
                } else {
                    "parameter tool"
                };
                format!("connected: {kind} \"{}\"", station.escape_debug())
            }
            Self::Exchanging { telegram } => format!("exchanges data, telegram {telegram}"),
            Self::Disconnected { cause } => format!("disconnected: {cause}"),
            Self::MasterTook => "a master has control".into(),
            Self::MasterGone { lost: true } => "the master is silent: connection lost".into(),
            Self::MasterGone { lost: false } => "the master has left".into(),
            Self::State { from, to } => format!("{from} -> {to}"),
            Self::Fault { number } => format!("fault F{number} {}", meaning(*number, false)),
            Self::Acknowledged => "faults acknowledged".into(),
            Self::Warning { number, active } => {
                let end = if *active { "" } else { " is gone" };
                format!("warning n{number} {}{end}", meaning(*number, true))
            }
            Self::ParametersIgnored(error) => {
                format!("saved parameters not used, values as delivered: {error}")
            }
            Self::PersistNetwork { .. } | Self::PersistParameters { .. } => return None,
        })
    }
}

fn words_of(written: &Written, catalogue: &Catalogue) -> String {
    let found = catalogue.at(written.pnu, written.subindex);
    let name = found.map_or_else(|| written.pnu.to_string(), |parameter| catalogue.label(parameter));
    match &written.value {
        WrittenValue::Text(text) => format!("{name} written: \"{}\"", text.escape_debug()),
        WrittenValue::Number { value, .. } => {
            let unit = found.map_or("", |parameter| parameter.unit);
            let text = format!("{name} written: {} {unit}", figures(*value));
            text.trim_end().to_owned()
        }
    }
}

fn refused(source: MacAddress, refusal: SetRefusal) -> String {
    match refusal {
        SetRefusal::TooMany => {
            format!("changes by DCP from {source} come too fast and are ignored until it is silent")
        }
        SetRefusal::InOperation(option) => {
            format!("refused by DCP from {source}: {option}, while the motor runs under a controller")
        }
        SetRefusal::Connected(option) => {
            format!("refused by DCP from {source}: {option}, while a controller is connected")
        }
    }
}
