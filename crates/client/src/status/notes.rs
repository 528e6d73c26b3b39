//! What stands in the way of a drive beside the cause that matters most, or will once that is gone.

use profile::catalogue::Part;
use profile::state::Zsw1;

use super::advice::{advice, moved_advice};
use super::rules::{self, RULES};
use super::{Cause, DriveStatus, facts, vendors};
use crate::names::in_model;
use crate::{Advice, WarningEntry};

/// Causes that are reported beside another one too: what the controller does is not news then, what is at the drive is.
const NOTED: [Cause; 6] = [
    Cause::Sto,
    Cause::NoPower,
    Cause::HardwareDisable,
    Cause::ControlledStop,
    Cause::LimitSwitch,
    Cause::SoftwareLimit,
];

/// Something that speaks against running, beside the cause that matters most.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Note {
    /// Stable name for programs: that of a cause, `brake` or `warning`.
    pub id: &'static str,
    /// One sentence.
    pub sentence: String,
    /// What to do about it, where something is to be done.
    pub next: Option<Advice>,
}

/// Everything beside the cause `main`.
pub(super) fn beside(main: Cause, status: &DriveStatus) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut causes = vec![main];
    for rule in RULES {
        if !NOTED.contains(&rule.cause) || causes.contains(&rule.cause) || !(rule.applies)(status) {
            continue;
        }
        causes.push(rule.cause);
        notes.push(Note {
            id: rule.cause.id(),
            sentence: (rule.sentence)(status),
            next: advice(rule.cause, status),
        });
    }
    let moved = Cause::MovedExternally;
    if main != moved && facts::turns(status) && status.unpowered() {
        notes.push(Note {
            id: moved.id(),
            sentence: facts::moved(status),
            next: Some(moved_advice(status.model).into()),
        });
    }
    if status.brake_fitted == Some(true) && status.brake_released == Some(false) && status.unpowered() {
        let by_hand = in_model(status.model, Part::BrakeReleased).map_or_else(String::new, |name| {
            format!("; {name}=1 opens it by hand, and lets a load fall")
        });
        notes.push(Note {
            id: "brake",
            sentence: "the holding brake is applied as long as the power stage is off".to_owned(),
            next: Some(format!("it opens with the power stage{by_hand}").as_str().into()),
        });
    }
    let new = |warning: &&WarningEntry| {
        let says = vendors::causes(status.model, warning);
        !says.iter().any(|cause| causes.contains(cause))
    };
    notes.extend(status.warnings.iter().filter(new).map(|warning| {
        Note {
            id: "warning",
            sentence: format!("warning {warning}"),
            next: warning
                .remedy
                .filter(|remedy| !remedy.is_empty())
                .map(Advice::from),
        }
    }));
    if status.warnings.is_empty() && status.has(Zsw1::WARNING) {
        notes.push(Note {
            id: "warning",
            sentence: "a warning is present (ZSW1 bit 7), the drive does not report its number here"
                .to_owned(),
            next: Some("look at its panel".into()),
        });
    }
    notes
}

pub(super) fn switched_off_beside(status: &DriveStatus) -> Option<Note> {
    let (command, advice) = vendors::disable(status.model)?;
    let inputs = status
        .disable_sources
        .is_some_and(|sources| sources & rules::AT_INPUTS != 0);
    let local = status.zsw1.is_some() && !status.has(Zsw1::CONTROL_REQUESTED);
    let known = inputs
        || local
        || !status.faults.is_empty()
        || !status.warnings.is_empty()
        || status.has(Zsw1::FAULT)
        || RULES
            .iter()
            .any(|rule| NOTED.contains(&rule.cause) && (rule.applies)(status));
    (!known).then(|| Note {
        id: "disabled-by-parameter",
        sentence: format!(
            "no fault, input or supply did it: it was disabled by parameter ({command}), by another program"
        ),
        next: Some(advice.into()),
    })
}
