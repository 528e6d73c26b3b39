//! What is different for each make: the advice that names its parameters, and which warnings say a cause.

use profile::state::{Profile, Stw1};

use super::{Cause, DriveStatus};
use crate::WarningEntry;

/// What to do about a cause with the parameters of a make, actions in braces ([`Advice`](crate::Advice)). A make without a row gets the
/// advice that holds for all.
const ADVICE: &[(&str, Cause, &str)] = &[
    (
        "AKD",
        Cause::NoPower,
        "switch the mains on; {read VBUS.VALUE VBUS.UVFTHRESH} shows the voltage",
    ),
    (
        "AKD",
        Cause::ControlledStop,
        "release that input: {find DIN values} shows which",
    ),
    (
        "AKD",
        Cause::DisableSource,
        "{read DRV.DISSOURCES} names the bits",
    ),
    (
        "AKD",
        Cause::CommandSource,
        "{write DRV.CMDSOURCE=1} while it is disabled",
    ),
    (
        "AKD",
        Cause::MovedExternally,
        "keep clear: no command stops it; let it come to rest, take the load away, or have it held by a brake (MOTOR.BRAKE=1 where one is fitted, MOTOR.BRAKERLS=0)",
    ),
    ("AKD", Cause::NotReady, "{read DRV.DISSOURCES} may tell more"),
    ("AKD", Cause::MotionHeld, "{read DRV.MOTIONDISSOURCES}"),
    (
        "AKD",
        Cause::LimitSwitch,
        "move away from it, only the other direction is free; {read HWLS.NEGSTATE HWLS.POSSTATE} shows the switches",
    ),
    (
        "AKD",
        Cause::SoftwareLimit,
        "move back inside: {read SWLS.LIMIT0 SWLS.LIMIT1} shows the limits",
    ),
    (
        "AKD",
        Cause::HomingFailed,
        "check HOME.MODE and the switches, then {home}",
    ),
    (
        "AKD",
        Cause::TaskHeld,
        "{write MT.CONTINUE=1} goes on after DRV.STOP; a new task replaces it",
    ),
    (
        "AKD",
        Cause::DoesNotTurn,
        "{read IL.FB IL.LIMITP VL.LIMITP VL.LIMITN}",
    ),
    ("VLT", Cause::Sto, "close the safety circuit: 24 V at terminal 37"),
    (
        "VLT",
        Cause::NoPower,
        "switch the mains on; {read 16-30} shows the voltage of the DC link",
    ),
    (
        "VLT",
        Cause::NotReady,
        "terminal 27 may command a coast (5-12): {read 16-60} shows the inputs",
    ),
    (
        "VLT",
        Cause::DoesNotTurn,
        "{read 16-14 4-18 4-13} shows current and limits",
    ),
    (
        "VACON",
        Cause::NoPower,
        "switch the mains on; {read ID7} shows the voltage of the DC link",
    ),
    (
        "VACON",
        Cause::NotReady,
        "an input may hold it: {read ID15 ID16} shows the inputs",
    ),
    (
        "VACON",
        Cause::DoesNotTurn,
        "{read ID3 ID107} shows current and limit",
    ),
];

/// Warnings that say a cause. One that is told in this way is not told again as a warning.
const WARNINGS: &[(&str, u32, &[Cause])] = &[
    ("AKD", 602, &[Cause::Sto]),
    ("AKD", 502, &[Cause::NoPower]),
    // one number for the switch and the software limit of a direction
    ("AKD", 107, &[Cause::LimitSwitch, Cause::SoftwareLimit]),
    ("AKD", 108, &[Cause::LimitSwitch, Cause::SoftwareLimit]),
    ("VLT", 68, &[Cause::Sto]),
    ("VLT", 8, &[Cause::NoPower]),
    ("VLT", 36, &[Cause::NoPower]),
];

/// The parameter that switches a drive off beside its controller, and who writes it.
const DISABLES: &[(&str, &str, &str)] = &[(
    "AKD",
    "DRV.DIS",
    "find out who: {disable} of somebody else, service software (WorkBench), or a controller that writes DRV.DIS by record; then start again",
)];

/// Control word for operation, as PROFIdrive has it.
const OPERATION: Stw1 = Stw1(0x047F);

/// What to do about a cause, where the make has something of its own.
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
            "in the controller: control word {operation} asks for operation ({})",
            profile.name()
        ));
    }
    Some(format!(
        "{} ({})",
        advice_text.replace("0x047F", &word(OPERATION)),
        profile.name()
    ))
}

/// The parameter that switches a drive of this make off beside its controller, and who may write it.
pub(super) fn disable(model: &str) -> Option<(&'static str, &'static str)> {
    let row = DISABLES.iter().find(|(of, ..)| *of == model);
    row.map(|(_, command, advice)| (*command, *advice))
}

/// A warning of the drive that says this cause.
pub(super) fn warned(status: &DriveStatus, cause: Cause) -> Option<&WarningEntry> {
    status
        .warnings
        .iter()
        .find(|warning| causes(status.model, warning).contains(&cause))
}

/// The causes that a warning says.
pub(super) fn causes(model: &str, warning: &WarningEntry) -> &'static [Cause] {
    let row = WARNINGS
        .iter()
        .find(|(of, number, _)| *of == model && *number == warning.number);
    row.map_or(&[], |(_, _, causes)| *causes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Action, Advice};
    use profile::catalogue::{AKD, Catalogue, VACON, VLT};
    use profile::notation::ParameterReference;
    use profile::value::Parameters;

    const MODELS: [&Catalogue; 3] = [&AKD, &VLT, &VACON];

    /// Every parameter that an action names, and every word with the shape of an AKD name.
    fn named(advice: &str) -> Vec<String> {
        let mut named = Vec::new();
        for action in Advice::from(advice).actions() {
            match action {
                Action::Read { parameters } => named.extend(parameters.iter().cloned()),
                Action::Write { parameter, .. } => named.push(parameter.clone()),
                _ => {}
            }
        }
        let akd = |word: &&str| {
            word.split_once('.').is_some_and(|(group, name)| {
                let plain = |text: &str| {
                    !text.is_empty() && text.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit())
                };
                plain(group) && plain(name) && group.chars().all(|c| c.is_ascii_uppercase())
            })
        };
        let words = advice.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.'));
        named.extend(words.filter(akd).map(str::to_owned));
        named
    }

    #[test]
    fn advice_names_only_parameters_of_the_model() {
        let mut seen = 0;
        for tables in MODELS {
            for &cause in Cause::ALL {
                let rule = super::super::rules::RULES
                    .iter()
                    .find(|rule| rule.cause == cause)
                    .unwrap();
                let text = advice(cause, tables.model).unwrap_or(rule.next);
                for name in named(text) {
                    if tables.model != "AKD" && name.parse::<u16>() == Ok(930) || name.starts_with("930") {
                        continue; // a number of the profile
                    }
                    let parameters = Parameters {
                        catalogue: Some(tables),
                        scaling: tables.scaling,
                    };
                    let reference: ParameterReference =
                        name.parse().unwrap_or_else(|error| panic!("{name}: {error}"));
                    let found = parameters
                        .select(&reference)
                        .ok()
                        .and_then(|found| found.parameter);
                    assert!(found.is_some(), "{}: {cause:?}: {name} in {text}", tables.model);
                    seen += 1;
                }
            }
        }
        assert!(seen > 30, "{seen}");
        for (model, cause, _) in ADVICE {
            assert!(
                MODELS.iter().any(|tables| tables.model == *model),
                "{model} {cause:?}"
            );
        }
    }

    #[test]
    fn every_warning_is_in_the_tables() {
        for (model, number, causes) in WARNINGS {
            let tables = MODELS.iter().find(|tables| tables.model == *model).unwrap();
            let number = u16::try_from(*number).unwrap();
            assert!(
                tables.fault(number, true).is_some() && !causes.is_empty(),
                "{model} {number}"
            );
        }
    }
}
