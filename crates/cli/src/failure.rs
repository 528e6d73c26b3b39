//! How a command fails: message, what to do, exit code.

use std::fmt;

use client::{Advice, ErrorKind};
use profidrive::{Explained, report};
use serde_json::{Map, Value};

use crate::advice::Commands;
use crate::output::members;

/// The exit code of each kind of error.
pub const fn exit_code(kind: ErrorKind) -> u8 {
    match kind {
        ErrorKind::Usage => 2,
        ErrorKind::Refused => 3,
        ErrorKind::Unreachable | ErrorKind::Lost => 4,
        ErrorKind::Difference => 5,
        ErrorKind::Safety => 6,
        _ => 1,
    }
}

/// Why a command ended without success.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// What kind of error it is; decides the exit code.
    pub kind: ErrorKind,
    /// What was tried, on which drive and parameter, and what came back.
    pub message: String,
    /// What the message lists, each on a line of its own.
    pub details: Vec<String>,
    /// What to do.
    pub hint: Advice,
}

impl Failure {
    /// A failure without a hint.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            details: Vec::new(),
            hint: Advice::default(),
        }
    }

    /// An error of the library.
    pub fn explained(error: &impl Explained) -> Self {
        Self {
            kind: error.kind(),
            message: error.message(),
            details: error.details(),
            hint: error.advice(),
        }
    }

    /// Ends with an exit code only, as stdout already has the result.
    pub fn silent(kind: ErrorKind) -> Self {
        Self::new(kind, String::new())
    }

    /// A mistake on the command line.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// For programs; `drive` is the drive as the person called it.
    pub fn json(&self, drive: &str) -> Map<String, Value> {
        members(&report::Error::new(
            self.kind,
            &self.message,
            &self.details,
            &self.hint,
            &Commands(drive),
        ))
    }

    /// The same with what to do, in place of what there is: words, with actions in braces in fixed ones.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<Advice>) -> Self {
        self.hint = hint.into();
        self
    }

    /// The same with something more to do.
    #[must_use]
    pub fn and_hint(mut self, more: impl Into<Advice>) -> Self {
        self.hint = self.hint.then(more.into());
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

/// Errors of the library, in its words.
macro_rules! explained {
    ($($error:ty),+ $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::explained(&error)
            }
        })+
    };
}

explained!(
    plant::PlantFileError,
    network::system::Error,
    network::serial::Error,
    client::Error,
    profidrive::OpenError,
    profidrive::addressing::AddressingError,
    profidrive::commissioning::CommissionError,
    profidrive::documents::DocumentError,
    profidrive::documents::traffic::TrafficError,
    profidrive::machine::MachineError,
    profidrive::monitor::MonitorError,
    profidrive::parameters::ParameterError,
    profidrive::recording::OverlayError,
    profidrive::recording::PlotError,
    profidrive::recording::WriteError,
    profidrive::settings::CompareError,
    profidrive::settings::Shortfall,
);

impl From<profile::value::ParameterProblem> for Failure {
    fn from(problem: profile::value::ParameterProblem) -> Self {
        client::Error::from(problem).into()
    }
}

#[cfg(test)]
mod tests {
    use client::{LossAction, LossReaction};
    use profidrive::CarrierError;

    use super::*;

    /// The own interface is down while an axis is under control.
    #[test]
    fn a_carrier_that_fails_under_an_axis_names_the_drive_and_keeps_its_cause() {
        let network = network::system::Error::InterfaceDown {
            interface: "eth7".into(),
        };
        let reaction = LossReaction {
            action: LossAction::KeepsTurning,
            parameter: Some("8-04".into()),
            setting: Some("Off".into()),
            after: None,
            commands: false,
            remedy: None,
        };
        let failure = Failure::from(client::Error::CarrierLost {
            drive: "vlt-1".into(),
            error: std::sync::Arc::new(CarrierError::Network(network)),
            reaction: Some(Box::new(reaction)),
        });
        assert_eq!(failure.kind, ErrorKind::Lost);
        assert_eq!(
            failure.message,
            "vlt-1: connection lost: network interface `eth7` is down; the drive keeps turning (8-04 is Off), unless something else has stopped it meanwhile"
        );
        let hint = failure.hint.to_string();
        assert!(
            hint.contains("ip link set eth7 up") && hint.contains("[stop] brings it to rest"),
            "{hint}"
        );
    }
}
