//! The safety rule behind an error, as data.

use super::{Error, ErrorKind};
use crate::axis::{Objection, Trouble};
use crate::{AtWork, LossReaction};

/// A rule that protects people or machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Rule {
    /// No motion is faster than its caller, the machine and the drive allow.
    SpeedLimit,
    /// No motion begins in a mode of the drive that it is not for.
    Mode,
    /// No motion depends on a connection whose loss leaves the motor turning, unless that is consented to.
    ControllerLoss,
    /// No motion, and no change that its controller does not bear, beside another one who commands the drive.
    Control,
    /// Nothing that an axis at work does not bear: it must be at rest, and be known to be.
    AtRest,
    /// No move that something speaks against: an axis without home position, a limit, a fault.
    Move,
    /// No motion at a setpoint whose meaning has changed.
    Scale,
    /// No motion whose program makes no calls any more.
    Lease,
    /// A motion ends at standstill.
    Standstill,
}

impl Rule {
    /// Stable name for programs.
    ///
    /// ```
    /// assert_eq!(profidrive_client::Rule::ControllerLoss.id(), "controller_loss");
    /// ```
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::SpeedLimit => "speed_limit",
            Self::Mode => "mode",
            Self::ControllerLoss => "controller_loss",
            Self::Control => "control",
            Self::AtRest => "at_rest",
            Self::Move => "move",
            Self::Scale => "scale",
            Self::Lease => "lease",
            Self::Standstill => "standstill",
        }
    }
}

impl Error {
    /// Returns the rule that an error of the kind [`ErrorKind::Safety`] stands for.
    #[must_use]
    pub fn rule(&self) -> Option<Rule> {
        if self.kind() != ErrorKind::Safety {
            return None;
        }
        Some(match self {
            Self::Held { error, .. } => return error.rule(),
            Self::Axis { trouble, .. } => match trouble {
                Trouble::Unattended => Rule::Lease,
                Trouble::LocalOperation => Rule::Control,
                _ => Rule::Standstill,
            },
            Self::SpeedLimit { .. } | Self::SpeedRange { .. } => Rule::SpeedLimit,
            Self::Objections { objections, .. } if objections.iter().any(is_speed) => Rule::SpeedLimit,
            Self::WrongMode { .. } => Rule::Mode,
            Self::RunsOn { .. } | Self::MovesWhenLost { .. } => Rule::ControllerLoss,
            Self::LocalOperation { .. } | Self::UnderControl { .. } | Self::Ownerless { .. } => Rule::Control,
            Self::ScaleChanged { .. } => Rule::Scale,
            Self::AtWork {
                works: AtWork::Controller(_),
                ..
            } => Rule::Control,
            Self::AtWork { .. } | Self::StatusUnread { .. } | Self::NotAtRest { .. } => Rule::AtRest,
            _ => Rule::Move,
        })
    }

    /// Returns the station name of the controller that has what was requested, where the drive reports it.
    #[must_use]
    pub fn owner(&self) -> Option<&str> {
        match self {
            Self::OwnedByController { controller, .. } | Self::ParametersOwned { controller, .. } => {
                controller.as_deref()
            }
            Self::NoStopBeside { controller, .. } | Self::StopUnanswered { controller, .. } => {
                Some(controller)
            }
            Self::AtWork {
                works: AtWork::Controller(name),
                ..
            } => Some(name),
            _ => None,
        }
    }

    /// Returns what the drive does that lost its controller, or would do, where the error is about that.
    #[must_use]
    pub fn loss_reaction(&self) -> Option<&LossReaction> {
        match self {
            Self::ConnectionLost { reaction, .. }
            | Self::CarrierLost { reaction, .. }
            | Self::LineSilent { reaction, .. } => reaction.as_deref(),
            Self::RunsOn { reaction, .. } | Self::MovesWhenLost { reaction, .. } => Some(reaction),
            _ => None,
        }
    }
}

const fn is_speed(objection: &Objection) -> bool {
    matches!(
        objection,
        Objection::SpeedLimit { .. } | Objection::DriveLimit { .. } | Objection::SpeedRange { .. }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_without_calls_ends_by_the_lease() {
        let rule = |trouble| {
            let drive = "akd-1".into();
            Error::Axis { drive, trouble }.rule()
        };
        assert_eq!(rule(Trouble::Unattended), Some(Rule::Lease));
        assert_eq!(rule(Trouble::NotStopped), Some(Rule::Standstill));
        assert_eq!(rule(Trouble::Fault), None);
    }

    #[test]
    fn what_a_controller_does_not_bear_breaks_the_rule_of_its_control() {
        let rule = |works| {
            let drive = "akd-1".into();
            let undone = "nothing was written";
            Error::AtWork { drive, undone, works }.rule()
        };
        assert_eq!(rule(AtWork::Controller("plc".into())), Some(Rule::Control));
        assert_eq!(rule(AtWork::Enabled), Some(Rule::AtRest));
    }

    #[test]
    fn a_move_that_is_too_fast_breaks_the_rule_of_the_speed() {
        let rule = |objection| {
            let drive = "akd-1".into();
            let objections = vec![objection];
            Error::Objections { drive, objections }.rule()
        };
        let (speed, limit) = (4000.0, 3000.0);
        assert_eq!(
            rule(Objection::SpeedLimit { speed, limit }),
            Some(Rule::SpeedLimit)
        );
        assert_eq!(rule(Objection::NotHomed), Some(Rule::Move));
        assert_eq!(rule(Objection::NoDistance { counts: 0.1 }), None);
    }
}
