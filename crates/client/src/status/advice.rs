//! What to do about a cause: by the drive, its model, or in general.

use profile::catalogue::Cleared;
use profile::state::{Stw1, Zsw1};

use super::facts::positioning;
use super::{Cause, DriveStatus, vendors};
use crate::{Action, Advice, FaultEntry, Remedy};

/// What brings an axis to rest that no controller has.
pub(super) fn actions(cause: Cause, status: &DriveStatus) -> Vec<Advice> {
    let by_parameter = vendors::disable(status.model).is_some();
    // a stop by parameter leaves the power stage on
    let stop = if by_parameter {
        Action::Disable.sentence()
    } else {
        Action::Stop.sentence()
    };
    match cause {
        Cause::TurnsOwnerless | Cause::EnabledOwnerless => {
            let remedy = status.loss.as_ref().and_then(|loss| loss.remedy.as_ref());
            [Some(stop), remedy.map(Remedy::sentence)]
                .into_iter()
                .flatten()
                .collect()
        }
        // it is ownerless, and whether it turns cannot be read
        Cause::Silent if status.controller == Some(None) => vec![Action::Stop.sentence()],
        // what its service channel has enabled a parameter switches off
        Cause::LocalOperation if by_parameter && status.has(Zsw1::OPERATION_ENABLED) => vec![stop],
        _ => Vec::new(),
    }
}

/// Returns the advice for a cause: that of the model of the drive, else the general one.
pub(super) fn advice(cause: Cause, status: &DriveStatus) -> Option<Advice> {
    if let (Cause::LocalOperation, Some(local)) = (cause, &status.local) {
        return Some(local.remedy().into());
    }
    if cause == Cause::NoController && !status.motions.is_empty() {
        return Some(taking(cause.advice(), &status.motions));
    }
    let own = vendors::advice(cause, status.model);
    let general = || {
        vendors::in_words_of(status, cause.advice())
            .unwrap_or_else(|| in_words_of_mode(status, cause.advice()))
    };
    let next = own.map_or_else(general, str::to_owned);
    if cause == Cause::Fault {
        return Some(fault_advice(status, &next));
    }
    (!next.is_empty()).then(|| next.as_str().into())
}

/// What else can command the axis: that of the actions that the drive can do.
fn taking(next: &str, motions: &[Action]) -> Advice {
    let names: Vec<String> = motions.iter().map(|action| format!("{{{action}}}")).collect();
    let listed = match names.as_slice() {
        [more @ .., last] if !more.is_empty() => format!("{} or {last}", more.join(", ")),
        one => one.concat(),
    };
    format!("{next}, or use {listed}").as_str().into()
}

/// What ends the faults that are present: the remedy of the first by the table, then `acknowledge`, or a restart where
/// one of them goes away by nothing else.
fn fault_advice(status: &DriveStatus, acknowledge: &str) -> Advice {
    let remedy = status.faults.first().and_then(|fault| fault.remedy);
    let remedy = remedy.filter(|text| !text.is_empty());
    let restart = |fault: &&FaultEntry| fault.cleared == Some(Cleared::Restart);
    let restart = status.faults.iter().find(restart);
    match (remedy, restart.and_then(|fault| fault.clearing.as_deref())) {
        (Some(remedy), None) => {
            let acknowledge = acknowledge.trim_start_matches("remove the cause, ");
            Advice::from(remedy).then(acknowledge.into())
        }
        (None, None) => acknowledge.into(),
        (remedy, Some(clearing)) => {
            Advice::from(remedy.unwrap_or("remove the cause")).and(format!("; then {clearing}"))
        }
    }
}

/// Returns the advice for an axis of this model that an external force turns.
#[must_use]
pub fn moved_advice(model: &str) -> &'static str {
    vendors::advice(Cause::MovedExternally, model).unwrap_or(Cause::MovedExternally.advice())
}

/// Advice with the control words of the mode: in position mode bit 6 starts a task, so that OFF and ON are without it.
fn in_words_of_mode(status: &DriveStatus, advice: &str) -> String {
    if !positioning(status) {
        return advice.to_owned();
    }
    [Stw1::READY, Stw1::RUN]
        .iter()
        .fold(advice.to_owned(), |text, word| {
            text.replace(&word.to_string(), &word.without(Stw1::ACTIVATE_TASK).to_string())
        })
}
