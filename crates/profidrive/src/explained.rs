//! What every front end shows of an error: what happened, and what a person can do about it.

use std::net::Ipv4Addr;
use std::sync::Arc;

use client::{Action, Advice, AtWork, Choice, Error, ErrorKind};
use network::system::{Error as SystemError, NeighbourTable, PortHolder};
use profile::notation::setting::Cause;
use profinet::RPC_PORT;
use profinet::controller::{LostCause, ServiceError};

use crate::addressing::AddressingError;
use crate::carrier::CarrierError;
use crate::commissioning::CommissionError;
use crate::drive::DriveError;
use crate::fleet::StopError;
use crate::machine::MachineError;
use crate::monitor::MonitorError;
use crate::motion::{End, MotionError};
use crate::open::OpenError;
use crate::parameters::ParameterError;
use crate::reach::OtherSubnet;
use crate::selector::SelectorError;
use crate::settings::{CompareError, FileError, RestoreError};

/// An error as a front end shows it. The errors of verbs, recordings and selectors have it.
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use profidrive::addressing::{NewName, set_name};
/// use profidrive::client::{Choice, ErrorKind};
/// use profidrive::{Explained, Wait};
///
/// let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let drive = network.find(&"akd-1".parse()?).wait()?;
/// let error = set_name(&mut network, &drive, &NewName::new("Press_1")).wait().unwrap_err();
/// assert_eq!((error.kind(), error.advice().to_string()), (ErrorKind::Usage, "perhaps press-1".to_owned()));
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Explained: std::error::Error {
    /// The kind of the error: decides exit code, HTTP status or exception.
    fn kind(&self) -> ErrorKind;

    /// The error that this one only passes on; it has message, details and advice then.
    fn passed_on(&self) -> Option<&dyn Explained> {
        None
    }

    /// What was tried, on which drive, and what came back, in one sentence.
    fn message(&self) -> String {
        self.passed_on()
            .map_or_else(|| self.to_string(), Explained::message)
    }

    /// What the message sums up, one by one.
    fn details(&self) -> Vec<String> {
        self.passed_on().map_or_else(Vec::new, Explained::details)
    }

    /// What to do; empty where nothing is known. A front end puts its own words in the place of the actions.
    fn advice(&self) -> Advice {
        self.passed_on().map_or_else(Advice::default, Explained::advice)
    }
}

/// An error that is handed to several who wait for it, for example the clients of a server.
impl<E: Explained + ?Sized> Explained for Arc<E> {
    fn kind(&self) -> ErrorKind {
        (**self).kind()
    }

    fn message(&self) -> String {
        (**self).message()
    }

    fn details(&self) -> Vec<String> {
        (**self).details()
    }

    fn advice(&self) -> Advice {
        (**self).advice()
    }
}

fn words(text: Option<impl Into<String>>) -> Advice {
    text.map_or_else(Advice::default, |text| Advice::from(text.into()))
}

impl Explained for SelectorError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Usage
    }

    fn advice(&self) -> Advice {
        match self {
            Self::NoMachine { .. } => Action::Choose(Choice::Machine).into(),
            Self::UnknownGroup(_) => Advice::default(),
            _ => "a drive is a station name (akd-1), an IP address, a MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS at a serial \
                  line; several are a list (akd-1,akd-2), a pattern (akd-*), model=vlt, vendor=danfoss, a group of the machine file (@line1) or all"
                .into(),
        }
    }
}

impl Explained for SystemError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Unreachable
    }

    fn advice(&self) -> Advice {
        let holders = match self {
            Self::PortOccupied { address, port } => PortHolder::named(*port, *address),
            _ => None,
        };
        match holders {
            Some(holders) => words(Some(format!("it is held by {holders}: end it first"))),
            None => words(self.hint()),
        }
    }
}

impl Explained for network::serial::Error {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Unreachable
    }

    fn advice(&self) -> Advice {
        let advice = words(self.hint());
        match self {
            // the program that has the line may have left an axis turning
            Self::Busy { .. } => advice.then("then {stop} brings its axis to rest".into()),
            _ => advice,
        }
    }
}

/// What carried the network, where that failed.
fn carrier(error: &Error) -> Option<&CarrierError> {
    match error {
        Error::Medium(inner) | Error::CarrierLost { error: inner, .. } => inner.downcast_ref(),
        _ => None,
    }
}

/// Whether an answer is missing to what went by IP: the kernel may have had no room for the address.
const fn is_silence(error: &Error) -> bool {
    let cause = match error {
        Error::Connect {
            cause: LostCause::Service(cause),
            ..
        } => cause,
        Error::Record { error: cause, .. } => cause,
        _ => return false,
    };
    matches!(cause, ServiceError::Timeout { .. })
}

/// Names the table of the kernel that is full.
fn of_table(table: Option<NeighbourTable>) -> Advice {
    words(table.map(|table| {
        let NeighbourTable { held, most } = table;
        let remedy = table.enlarged_for(held);
        format!(
            "the table of this computer for the addresses of stations is full ({held} of {most}): {remedy}"
        )
    }))
}

impl Explained for Error {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn message(&self) -> String {
        match (self, carrier(self)) {
            // the message of a carrier names what failed
            (Self::Medium(_), Some(carrier)) => carrier.to_string(),
            _ => self.to_string(),
        }
    }

    fn advice(&self) -> Advice {
        let own = match self {
            Self::AtWork { works, .. } => Some(at_work(works)),
            Self::NeedsCallPort { .. } => {
                let holders = PortHolder::named(RPC_PORT, Ipv4Addr::UNSPECIFIED);
                let named = words(holders.map(|holders| format!("it is held by {holders}")));
                Some(named.then(Self::advice(self).unwrap_or_default()))
            }
            error if is_silence(error) => {
                let table = NeighbourTable::of_kernel().filter(NeighbourTable::is_full);
                Some(Self::advice(self).unwrap_or_default().then(of_table(table)))
            }
            _ => Self::advice(self),
        };
        let of_carrier = words(carrier(self).and_then(CarrierError::hint));
        own.unwrap_or_default().then(of_carrier)
    }
}

/// A drive that is at work is not named, addressed or reset.
fn at_work(works: &AtWork) -> Advice {
    match works {
        AtWork::Controller(_) => "its axis would lose the controller; {blink} shows which drive it is",
        AtWork::Turns(_) | AtWork::Enabled => "{disable} stops it first",
    }
    .into()
}

impl Explained for OpenError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Network(error) => error.advice(),
            Self::Serial(error) => error.advice(),
            Self::NoInterface { existing } => {
                let there = match existing.as_slice() {
                    [] => "; there is none".to_owned(),
                    names => format!("; there are: {}", names.join(", ")),
                };
                Advice::from(Action::Choose(Choice::Interface)).and(there)
            }
            _ => Advice::default(),
        }
    }
}

impl Explained for OtherSubnet {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Unreachable
    }

    fn advice(&self) -> Advice {
        Advice::from(format!("give the drive an address in {}: ", self.own_subnet()))
            .with(Action::SetAddress { device: None })
            .and(format!(
                "; or this computer one more in {}: ip address add A.B.C.D/{} dev {}",
                self.subnet(),
                self.prefix(),
                self.interface
            ))
    }
}

impl Explained for DriveError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Open(error) => Some(error),
            Self::Client(error) => Some(error),
            Self::Far { error, .. } => Some(&**error),
            Self::Subnet(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Far { subnets, .. } => Advice::from(subnets.clone()),
            Self::MoreStations { .. } => "select the others by their names or IP addresses".into(),
            #[cfg(feature = "gsdml")]
            Self::Description(crate::description::DescriptionError::UnknownTelegrams { .. }) => {
                "{choose model} takes it for one of the known drives".into()
            }
            other => other.passed_on().map_or_else(Advice::default, Explained::advice),
        }
    }
}

impl Explained for AddressingError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::BadName { legal, .. } => words(legal.as_ref().map(|legal| format!("perhaps {legal}"))),
            Self::NameTaken { .. } => "one name belongs to one station; rename the other first, or disconnect it if this one replaces it".into(),
            Self::AddressTaken { .. } | Self::OwnAddress { .. } => "choose a free address".into(),
            Self::Interfaces(error) => error.advice(),
            Self::Client(error @ Error::AtWork { .. }) => Explained::advice(error)
                .then("{choose force} sends the request anyway; the drive may refuse it".into()),
            Self::Client(error) => Explained::advice(error),
        }
    }
}

impl Explained for ParameterError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }

    fn details(&self) -> Vec<String> {
        match self {
            Self::Outdated { changes, .. } => changes.clone(),
            Self::Client(error) => Explained::details(error),
            _ => Vec::new(),
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Client(error) => Explained::advice(error),
            other => other.advice(),
        }
    }
}

impl Explained for MonitorError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Client(error) if !Self::is_of_drive(error) => Explained::advice(error),
            other => other.advice(),
        }
    }
}

impl Explained for MotionError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn message(&self) -> String {
        match self {
            Self::Client(error) => error.message(),
            Self::Failed { error, findings, .. } => {
                findings.iter().fold(error.message(), |message, finding| {
                    format!("{message}; {finding}")
                })
            }
            Self::Stopped { drive, end, .. } => match end {
                End::Open | End::Time => format!("{drive}: stopped before the end by request"),
                other => format!("{drive}: stopped by request, {}", other.missing()),
            },
            other => other.to_string(),
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Client(error) => Explained::advice(error),
            Self::Failed { error, .. } => {
                let of_carrier = words(carrier(error).and_then(CarrierError::hint));
                Self::advice(self).unwrap_or_default().then(of_carrier)
            }
            other => other.advice().unwrap_or_default(),
        }
    }
}

impl Explained for StopError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Drive(error) => error.kind(),
            Self::Motion(error) => error.kind(),
        }
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        Some(match self {
            Self::Drive(error) => error,
            Self::Motion(error) => error,
        })
    }
}

impl Explained for FileError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn message(&self) -> String {
        match self {
            Self::Wrong { path, error } if error.problems.len() != 1 => {
                format!("{}: {} lines are wrong", path.display(), error.problems.len())
            }
            other => other.to_string(),
        }
    }

    fn details(&self) -> Vec<String> {
        match self {
            Self::Wrong { error, .. } if error.problems.len() != 1 => {
                error.problems.iter().map(ToString::to_string).collect()
            }
            _ => Vec::new(),
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Wrong { error, .. } => match error.problems.as_slice() {
                [one] => wrong(&one.cause),
                _ => Advice::default(),
            },
            Self::OtherContent(_) => "choose another name; {choose force} writes over it".into(),
            _ => Advice::default(),
        }
    }
}

/// What to do about a file that is not read.
fn wrong(cause: &Cause) -> Advice {
    match cause {
        Cause::TooLong { .. } | Cause::NotText { .. } | Cause::OtherKind { .. } => "{backup} writes a backup",
        Cause::OtherVersion { .. } => "another version of profidrive wrote it; that version reads it",
        Cause::NoLineBreak => "if the file is complete, end its last line with a line break",
        Cause::Changed { .. } => {
            "if the file was changed on purpose and is complete, remove its last line, the checksum"
        }
        _ => "",
    }
    .into()
}

impl Explained for MachineError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }
}

impl Explained for CommissionError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        Some(match self {
            Self::Drive(error) => error,
            Self::Addressing(error) => error,
            Self::Restore(error) => error,
            Self::File(error) => error,
            Self::Client(error) => error,
            Self::Machine(error) => error,
            Self::Entry { problem, .. } => &**problem,
            _ => return None,
        })
    }

    fn advice(&self) -> Advice {
        match self {
            Self::NotFound { .. } => "{scan} lists who answers".into(),
            Self::OtherStation { .. } => "switch it off, or give it another name".into(),
            Self::Setting { problem, .. } => Explained::advice(&**problem),
            Self::Refused { first, .. } => Explained::advice(&**first),
            Self::Exists(_) => {
                "{choose force} replaces it; groups, limits and units of the load are kept".into()
            }
            Self::NotInFile { .. } => "{name}".into(),
            Self::NotRead { .. } => {
                "remove the drives that are gone from the file, or choose another file; what was read is in \
                                     the backups"
                    .into()
            }
            other => other.passed_on().map_or_else(Advice::default, Explained::advice),
        }
    }
}

impl Explained for CompareError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }
}

impl Explained for RestoreError {
    fn kind(&self) -> ErrorKind {
        Self::kind(self)
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Client(error) => Explained::advice(error),
            Self::Misfit(_) => {
                "{choose force} continues anyway: names and numbers can mean something else there".into()
            }
            Self::Controlled { .. } => "it can switch the axis on while values change; stop it first, or \
                {choose force} goes on while the axis is off"
                .into(),
            Self::WayBack { .. } => "choose another file: {choose way-back}".into(),
            Self::Nothing => Advice::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_passed_on_keeps_its_words_and_its_advice() {
        let inner = Error::NotFound {
            drive: client::DriveAddress::Name("akd-1".into()),
            answered: Vec::new(),
        };
        let (message, advice) = (inner.message(), Explained::advice(&inner));
        assert!(!advice.is_empty(), "{message}");
        let shared = Arc::new(StopError::Drive(DriveError::Client(inner)));
        let waiting = Arc::clone(&shared);
        assert_eq!(
            (waiting.kind(), waiting.message()),
            (ErrorKind::Unreachable, message)
        );
        assert_eq!(Explained::advice(&waiting), advice);
    }
}
