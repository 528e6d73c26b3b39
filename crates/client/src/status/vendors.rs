//! Differences between the vendors: advice with their parameters, and the causes of their warnings.

use profile::state::{Profile, Stw1};

use super::generated::{ADVICE, DISABLES, WARNINGS};
use super::{Cause, DriveStatus};
use crate::WarningEntry;

/// Control word for operation, as PROFIdrive has it.
const OPERATION: Stw1 = Stw1(0x047F);

/// Returns the advice for a cause, if the model has its own.
pub(super) fn advice(cause: Cause, model: &str) -> Option<&'static str> {
    let row = ADVICE
        .iter()
        .find(|(of, about, _)| *of == model && *about == cause);
    row.map(|(_, _, advice)| *advice)
}

/// Advice about bits of STW1 for a controller whose control word has others: its own words for OFF and operation, its
/// own bit that acknowledges, else the word for operation.
pub(super) fn in_words_of(status: &DriveStatus, advice: &str) -> Option<String> {
    let profile = status.profile;
    if profile == Profile::Profidrive || !advice.contains("STW1") {
        return None;
    }
    let word = |stw1| format!("0x{:04X}", profile.control(stw1));
    let acknowledges = profile.control(Stw1::ACKNOWLEDGE) & !profile.control(Stw1::READY);
    let advice_text = advice
        .replace("STW1 0x047E", &format!("control word {}", word(Stw1::READY)))
        .replace(
            "STW1 bit 7",
            &format!("control word bit {}", acknowledges.trailing_zeros()),
        );
    if advice_text.contains("STW1") {
        let operation = word(OPERATION);
        return Some(format!(
            "in the controller: control word {operation} requests operation ({})",
            profile.name()
        ));
    }
    Some(format!(
        "{} ({})",
        advice_text.replace("0x047F", &word(OPERATION)),
        profile.name()
    ))
}

/// Returns the parameter that switches a drive of this model off independent of its controller, and who may write it.
pub(super) fn disable(model: &str) -> Option<(&'static str, &'static str)> {
    let row = DISABLES.iter().find(|(of, ..)| *of == model);
    row.map(|(_, command, advice)| (*command, *advice))
}

/// A warning of the drive that means this cause.
pub(super) fn warned(status: &DriveStatus, cause: Cause) -> Option<&WarningEntry> {
    status
        .warnings
        .iter()
        .find(|warning| causes(status.model, warning).contains(&cause))
}

/// The causes that a warning means.
pub(super) fn causes(model: &str, warning: &WarningEntry) -> &'static [Cause] {
    let row = WARNINGS
        .iter()
        .find(|(of, number, _)| *of == model && *number == warning.number);
    row.map_or(&[], |(_, _, causes)| *causes)
}
