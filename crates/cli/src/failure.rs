//! How a command fails: message, what to do, exit code.

use std::fmt;

use client::{Advice, ErrorKind};
use profidrive::{CarrierError, OpenError, OtherSubnet, report};
use serde_json::{Map, Value};

use crate::advice;
use crate::output::members;

/// The exit codes of the conventions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Anything not named below.
    Failed = 1,
    /// The command line is wrong.
    Usage = 2,
    /// The drive refused.
    Refused = 3,
    /// The drive, the network or the right to use it is not there.
    Unreachable = 4,
    /// Something differs from what it should be.
    Difference = 5,
    /// A rule that protects people or machines stopped it.
    Safety = 6,
}

impl Exit {
    /// Word for the JSON form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Usage => "usage",
            Self::Refused => "refused",
            Self::Unreachable => "unreachable",
            Self::Difference => "difference",
            Self::Safety => "safety",
        }
    }
}

/// Why a command ended without success.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// Exit code.
    pub exit: Exit,
    /// What was tried, on which drive and parameter, and what came back.
    pub message: String,
    /// What the message lists, each on a line of its own.
    pub details: Vec<String>,
    /// What to do.
    pub hint: Option<String>,
}

impl Failure {
    /// A failure without a hint.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            message: message.into(),
            details: Vec::new(),
            hint: None,
        }
    }

    /// Ends with an exit code only, as stdout already has the result.
    pub const fn silent(exit: Exit) -> Self {
        Self {
            exit,
            message: String::new(),
            details: Vec::new(),
            hint: None,
        }
    }

    /// A mistake on the command line.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// For programs.
    pub fn json(&self) -> Map<String, Value> {
        members(&report::Error {
            kind: self.exit.word(),
            message: self.message.clone(),
            details: self.details.clone(),
            hint: self.hint.clone(),
        })
    }

    /// The same with the drive as the person called it, where the advice is for any drive.
    #[must_use]
    pub fn about(mut self, drive: Option<&str>) -> Self {
        if let (Some(drive), Some(hint)) = (drive, &self.hint) {
            self.hint = Some(with_drive(hint, drive));
        }
        self
    }

    /// The same with what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// Commands in `advice` name the drive.
fn with_drive(advice: &str, drive: &str) -> String {
    advice
        .replace(" DRIVE ", &format!(" {drive} "))
        .replace(" DRIVE`", &format!(" {drive}`"))
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl From<network::system::Error> for Failure {
    fn from(error: network::system::Error) -> Self {
        let failure = Self::new(Exit::Unreachable, error.to_string());
        match error.hint() {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    }
}

impl From<network::serial::Error> for Failure {
    fn from(error: network::serial::Error) -> Self {
        let failure = Self::new(Exit::Unreachable, error.to_string());
        match error.hint() {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    }
}

impl From<client::Error> for Failure {
    fn from(error: client::Error) -> Self {
        // the message of a carrier already names what failed
        let message = match (&error, carrier(&error)) {
            (client::Error::Medium(_), Some(carrier)) => carrier.to_string(),
            _ => error.to_string(),
        };
        let failure = Self::new(exit_of(error.kind()), message);
        match hint(&error, error.advice()) {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    }
}

impl From<OpenError> for Failure {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Network(error) => error.into(),
            OpenError::Serial(error) => {
                let busy = matches!(error, network::serial::Error::Busy { .. });
                let mut failure = Self::from(error);
                // that program may have left an axis turning
                if let (true, Some(hint)) = (busy, &mut failure.hint) {
                    hint.push_str("; then `profidrive stop DRIVE` brings its axis to rest");
                }
                failure
            }
            OpenError::NoInterface { ref existing } => {
                let there = match existing.as_slice() {
                    [] => "there is none".to_owned(),
                    names => format!("there are: {}", names.join(", ")),
                };
                Self::usage(error.to_string()).hint(format!("-i IFACE, or PROFIDRIVE_INTERFACE; {there}"))
            }
            other => Self::new(Exit::Unreachable, other.to_string()),
        }
    }
}

impl From<OtherSubnet> for Failure {
    fn from(error: OtherSubnet) -> Self {
        let (drive, interface, prefix) = (&error.drive, &error.interface, error.prefix());
        let (near, subnet) = (error.own_subnet(), error.subnet());
        let hint = format!(
            "give the drive an address in {near}: `profidrive ip {drive} A.B.C.D/NN`; \
             or this computer one more in {subnet}: ip address add A.B.C.D/{prefix} dev {interface}"
        );
        Self::new(Exit::Unreachable, error.to_string()).hint(hint)
    }
}

/// The carrier that failed.
fn carrier(error: &client::Error) -> Option<&CarrierError> {
    match error {
        client::Error::Medium(inner) | client::Error::CarrierLost { error: inner, .. } => {
            inner.downcast_ref()
        }
        _ => None,
    }
}

/// What to do about an error: the hints of its kind and of its carrier, and its action as a command.
pub fn hint(error: &client::Error, of_kind: Option<Advice>) -> Option<String> {
    let action = error
        .action()
        .and_then(|action| advice::sentence(&action, "DRIVE"));
    let of_carrier = carrier(error).and_then(CarrierError::hint);
    let all: Vec<String> = of_kind
        .map(|advice| advice::text(&advice, "DRIVE"))
        .into_iter()
        .chain(of_carrier)
        .chain(action)
        .collect();
    (!all.is_empty()).then(|| all.join("; "))
}

impl From<profile::value::ParameterProblem> for Failure {
    fn from(problem: profile::value::ParameterProblem) -> Self {
        client::Error::from(problem).into()
    }
}

/// The exit code of each kind of error.
pub const fn exit_of(kind: ErrorKind) -> Exit {
    match kind {
        ErrorKind::Usage => Exit::Usage,
        ErrorKind::Refused => Exit::Refused,
        ErrorKind::Unreachable | ErrorKind::Lost => Exit::Unreachable,
        ErrorKind::Safety => Exit::Safety,
        _ => Exit::Failed,
    }
}

#[cfg(test)]
mod tests {
    use client::{LossAction, LossReaction};

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
        assert_eq!(failure.exit, Exit::Unreachable);
        assert_eq!(
            failure.message,
            "vlt-1: connection lost: network interface `eth7` is down; the drive keeps turning (8-04 is Off), unless something else has stopped it meanwhile"
        );
        let hint = failure.hint.unwrap_or_default();
        assert!(
            hint.contains("ip link set eth7 up") && hint.contains("`profidrive stop DRIVE`"),
            "{hint}"
        );
    }

    #[test]
    fn advice_names_the_drive_as_the_person_did() {
        let failure = |hint: &str| Failure::usage("no").hint(hint).about(Some("10.0.0.2")).hint;
        assert_eq!(
            failure("`profidrive describe DRIVE PARAM`, then `profidrive ack DRIVE`").as_deref(),
            Some("`profidrive describe 10.0.0.2 PARAM`, then `profidrive ack 10.0.0.2`")
        );
        let kinds = "DRIVE is a station name (akd-1), an IP address";
        assert_eq!(failure(kinds).as_deref(), Some(kinds));
    }
}
