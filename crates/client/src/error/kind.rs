//! What kind of error it is: what a front end makes its exit code, status or exception of.

use profinet::controller::{DcpError, LostCause, ServiceError};

use super::Error;
use crate::axis::{Objection, Trouble};

/// The kinds of errors, for programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// What was requested is wrong, whatever the drive is like: a value, a unit, a name.
    Usage,
    /// The drive or the device refused, or another station has what was requested: a name, an address.
    Refused,
    /// The drive or the network cannot be reached, or the permission to use it is missing.
    Unreachable,
    /// A connection that was there is gone, while an axis was under control.
    Lost,
    /// A rule that protects people or machines stopped it.
    Safety,
    /// The drive has a fault.
    Fault,
    /// What was commanded was not reached: speed, position, state.
    NotReached,
    /// A part was done, a part was not.
    Partial,
    /// Something differs from what it should be.
    Difference,
    /// The drive cannot do it, or not as it is now set up.
    Unsupported,
    /// The caller requested a stop.
    Interrupted,
    /// Something on this computer cannot be used: a file, a socket, the output; or the content of a file is wrong.
    Local,
    /// The drive sent an answer that has no meaning, or this program has an error.
    Internal,
}

impl ErrorKind {
    /// Every kind with its stable name.
    pub const ALL: [(Self, &'static str); 13] = [
        (Self::Usage, "usage"),
        (Self::Refused, "refused"),
        (Self::Unreachable, "unreachable"),
        (Self::Lost, "lost"),
        (Self::Safety, "safety"),
        (Self::Fault, "fault"),
        (Self::NotReached, "not_reached"),
        (Self::Partial, "partial"),
        (Self::Difference, "difference"),
        (Self::Unsupported, "unsupported"),
        (Self::Interrupted, "interrupted"),
        (Self::Local, "local"),
        (Self::Internal, "internal"),
    ];

    /// Stable name for programs.
    ///
    /// ```
    /// assert_eq!(profidrive_client::ErrorKind::NotReached.id(), "not_reached");
    /// ```
    #[must_use]
    pub fn id(self) -> &'static str {
        let row = Self::ALL.iter().find(|(kind, _)| *kind == self);
        row.map_or("internal", |(_, id)| id)
    }
}

impl Error {
    /// Returns true when nothing is carried any more, so that waiting makes no sense.
    pub(crate) const fn is_final(&self) -> bool {
        matches!(self, Self::Closed | Self::DriverFailed)
    }

    /// What kind of error it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Held { error, .. } => error.kind(),
            Self::Axis { trouble, .. } => of_trouble(trouble),
            // nothing was sent, so the drive refused nothing
            Self::Refused { refusal, .. } if refusal.is_unsent() => ErrorKind::Unsupported,
            Self::Refused { .. }
            | Self::OwnedByController { .. }
            | Self::ParametersOwned { .. }
            | Self::Dcp {
                error: DcpError::Refused { .. } | DcpError::NotSupported,
                ..
            }
            | Self::Connect {
                cause: LostCause::Service(ServiceError::Refused { .. }) | LostCause::AbortedByPeer(_),
                ..
            }
            | Self::Record {
                error: ServiceError::Refused { .. },
                ..
            } => ErrorKind::Refused,
            Self::ConnectionLost { .. } | Self::CarrierLost { .. } | Self::LineSilent { .. } => {
                ErrorKind::Lost
            }
            Self::Medium(_)
            | Self::Closed
            | Self::Busy { .. }
            | Self::NoAnswer { .. }
            | Self::StopUnanswered { .. }
            | Self::Channel { .. }
            | Self::NotFound { .. }
            | Self::Ambiguous { .. }
            | Self::SharedAddress { .. }
            | Self::NeedsDiscovery { .. }
            | Self::NeedsRawFrames { .. }
            | Self::NeedsCallPort { .. }
            | Self::NoIpAddress { .. }
            | Self::Dcp { .. }
            | Self::Connect { .. }
            | Self::NoRoute { .. }
            | Self::Record { .. }
            | Self::Timeout { .. } => ErrorKind::Unreachable,
            // nothing but numbers that cannot be sent: whatever the drive does, they are wrong
            Self::Objections { objections, .. } if objections.iter().all(is_number) => ErrorKind::Usage,
            Self::Parameter(_)
            | Self::SpeedStep { .. }
            | Self::NoFrequency { .. }
            | Self::NotOnLine { .. }
            | Self::OtherWire { .. }
            | Self::UpdateTime { .. }
            | Self::Misuse(_) => ErrorKind::Usage,
            Self::AtWork { .. }
            | Self::LocalOperation { .. }
            | Self::UnderControl { .. }
            | Self::Ownerless { .. }
            | Self::RunsOn { .. }
            | Self::MovesWhenLost { .. }
            | Self::StatusUnread { .. }
            | Self::SpeedLimit { .. }
            | Self::SpeedRange { .. }
            | Self::Objections { .. }
            | Self::WrongMode { .. }
            | Self::NotAtRest { .. }
            | Self::ScaleChanged { .. } => ErrorKind::Safety,
            Self::NotEnabled { .. }
            | Self::NotInTime { .. }
            | Self::HomingEnded { .. }
            | Self::MoveEnded { .. }
            | Self::SpeedNotReached { .. }
            | Self::NotMoved { .. }
            | Self::SpeedLost { .. }
            | Self::Changing { .. } => ErrorKind::NotReached,
            Self::Interrupted | Self::StopInterrupted { .. } => ErrorKind::Interrupted,
            Self::DriverFailed | Self::Malformed { .. } | Self::UnknownRequest { .. } => ErrorKind::Internal,
            Self::NotADrive { .. }
            | Self::Telegram { .. }
            | Self::SpeedOnly { .. }
            | Self::NoJog { .. }
            | Self::ForeignModule { .. }
            | Self::NoStopBeside { .. }
            | Self::SpeedUnit { .. }
            | Self::NoSuchTelegram { .. }
            | Self::UnknownModel { .. }
            | Self::TooManyKinds { .. }
            | Self::Journal { .. } => ErrorKind::Unsupported,
        }
    }
}

const fn is_number(objection: &Objection) -> bool {
    matches!(
        objection,
        Objection::SpeedStep { .. } | Objection::NoDistance { .. }
    )
}

const fn of_trouble(trouble: &Trouble) -> ErrorKind {
    match trouble {
        // a motion that is not attended ends by a safety rule too
        Trouble::StillTurns
        | Trouble::QuickStopUsed
        | Trouble::NotStopped
        | Trouble::LocalOperation
        | Trouble::Unattended => ErrorKind::Safety,
        Trouble::Fault | Trouble::FaultStays => ErrorKind::Fault,
        Trouble::TargetNotReached | Trouble::HomingFailed => ErrorKind::NotReached,
        Trouble::Stopped => ErrorKind::Interrupted,
        Trouble::StuckIn { .. }
        | Trouble::LeftOperation { .. }
        | Trouble::OtherMode { .. }
        | Trouble::NotAccepted { .. }
        | Trouble::AcceptanceStays
        | Trouble::HomingNotStarted
        | Trouble::NoInputs => ErrorKind::Refused,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_cannot_be_sent_are_mistakes_of_the_caller() {
        let kind = |objections: Vec<Objection>| {
            let drive = "akd-1".into();
            Error::Objections { drive, objections }.kind()
        };
        let none = Objection::NoDistance { counts: 0.1 };
        assert_eq!(kind(vec![none]), ErrorKind::Usage);
        assert_eq!(kind(vec![none, Objection::NotHomed]), ErrorKind::Safety);
    }

    #[test]
    fn an_answer_without_meaning_is_no_missing_feature() {
        let malformed = Error::Malformed {
            drive: "akd-1".into(),
            reason: "3 octets".into(),
        };
        assert_eq!(malformed.kind(), ErrorKind::Internal);
        assert_eq!(Error::Interrupted.kind(), ErrorKind::Interrupted);
    }

    #[test]
    fn every_kind_has_one_name() {
        for (at, (kind, id)) in ErrorKind::ALL.iter().enumerate() {
            assert_eq!(kind.id(), *id);
            assert!(ErrorKind::ALL.iter().skip(at + 1).all(|(_, other)| other != id));
        }
    }
}
