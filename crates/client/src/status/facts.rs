//! What the rules go by and mention: single facts of a status, in numbers and in words.

use profile::catalogue::Part;
use profile::notation::fixed;
use profile::state::{Mode, PositionMachine, Profile, SetpointChannel, SpeedCommand, State, Stw1, Zsw1};

use super::DriveStatus;
use crate::LossReaction;
use crate::names::in_model;

/// Without this voltage on its DC bus no drive runs, whatever its own limit is.
const NO_VOLTAGE: f64 = 50.0;
/// Speed below which an axis counts as standing, rpm.
pub(super) const STANDS: f64 = 1.0;

/// The same in percent of the reference.
pub(super) const STANDS_PERCENT: f64 = 0.2;

pub(super) fn moved(status: &DriveStatus) -> String {
    format!(
        "it turns at {} with its power stage off: it coasts, or something outside moves it (a load that hangs on it, a brake that does not hold)",
        speed(status)
    )
}

/// Describes what commands an ownerless drive.
pub(super) fn in_force(status: &DriveStatus) -> String {
    if let Some((loss, parameter, setting)) = status.loss.as_ref().and_then(by_reaction) {
        let from = loss.after.map_or_else(String::new, |after| {
            format!(", from {} s after the last control word", after.as_secs_f64())
        });
        return format!(
            "what it does when its controller is lost commands it ({parameter} is {setting}){from}"
        );
    }
    match status.control_word {
        Some(word) if status.sent(Stw1::CONTROL_BY_PLC | Stw1::ON) => {
            format!("the last control word, 0x{word:04X}, is still in force")
        }
        _ => "what commanded it last is still in force".to_owned(),
    }
}

/// What commands a drive that has lost its controller, where that is not the last control word.
pub(super) fn by_reaction(loss: &LossReaction) -> Option<(&LossReaction, &str, &str)> {
    let (parameter, setting) = loss.parameter.as_deref().zip(loss.setting.as_deref())?;
    loss.commands.then_some((loss, parameter, setting))
}

pub(super) fn bus_is_low(status: &DriveStatus) -> bool {
    let least = status.bus_lowest.unwrap_or_default().max(NO_VOLTAGE);
    status.bus_voltage.is_some_and(|volts| volts < least)
}

/// What goes before something that keeps an enabled axis from moving.
pub(super) fn but(status: &DriveStatus) -> &'static str {
    if status.state() == Some(State::S4) {
        "enabled (S4), but "
    } else {
        ""
    }
}

pub(super) fn fault(status: &DriveStatus) -> String {
    match status.faults.as_slice() {
        [] => "a fault is present (ZSW1 bit 3), the drive does not report its number".into(),
        [fault, more @ ..] => {
            let text = fault.meaning.unwrap_or("not in the tables");
            let others = match more {
                [] => String::new(),
                [other] => format!(", then F{}", other.number),
                _ => format!(", then {} more", more.len()),
            };
            format!("fault F{} is present: {text}{others}", fault.number)
        }
    }
}

/// The parameter that shows it, by its name in the model: ` (STO.STATE is 0)`. Nothing for a drive without a name for it.
pub(super) fn by(status: &DriveStatus, part: Part, says: &str) -> String {
    in_model(status.model, part).map_or_else(String::new, |name| {
        format!(" ({})", format!("{name} {says}").trim_end())
    })
}

pub(super) fn sources(status: &DriveStatus) -> u16 {
    status.disable_sources.unwrap_or(0)
}

pub(super) fn motion(status: &DriveStatus) -> u32 {
    status.motion.unwrap_or(0)
}

pub(super) fn positioning(status: &DriveStatus) -> bool {
    status.mode == Some(2)
}

pub(super) fn turns(status: &DriveStatus) -> bool {
    let above = |speed: Option<f64>, least: f64| speed.is_some_and(|speed| speed.abs() >= least);
    above(status.speed_actual, STANDS) || above(status.speed_percent, STANDS_PERCENT)
}

/// The speed in the unit in which it is known.
pub(super) fn speed(status: &DriveStatus) -> String {
    match (status.speed_actual, status.speed_percent) {
        (None, Some(percent)) => format!("{} % of its reference", fixed(percent, 1)),
        (speed, _) => format!("{} rpm", fixed(speed.unwrap_or_default(), 1)),
    }
}

/// In operation and turning; in position mode the drive reports it itself.
pub(super) fn moves(status: &DriveStatus) -> bool {
    turns(status) || (positioning(status) && !status.has(Zsw1::STOPPED))
}

/// True when the control word alone commands a jog.
pub(super) fn jogs(status: &DriveStatus) -> bool {
    let Some(word) = status.stw1 else {
        return false;
    };
    if positioning(status) {
        return PositionMachine::commanded(word).is_jogging();
    }
    let command = SetpointChannel::default().step(State::S4, word, true);
    matches!(command, SpeedCommand::Jog1 | SpeedCommand::Jog2)
}

/// True when two bits command a jog and nothing else has the axis.
pub(super) fn jogs_at_once(status: &DriveStatus) -> bool {
    status.stw1.is_some_and(|word| {
        let closed = (word & (Stw1::ENABLE_RAMP | Stw1::UNFREEZE_RAMP | Stw1::ENABLE_SETPOINT)).0 == 0;
        match positioning(status) {
            true => word.jogs_at_once(Mode::Position),
            false => closed && word.jogs_at_once(Mode::Velocity),
        }
    })
}

/// The jog bits that are set: `(STW1 bits 8 and 9)`; where the words have other bits, the word itself.
pub(super) fn jog_bits(status: &DriveStatus) -> String {
    match status.control_word {
        Some(word) if status.profile != Profile::Profidrive => {
            return format!("(control word 0x{word:04X}, {})", status.profile.name());
        }
        _ => {}
    }
    let word = status.stw1.unwrap_or_default();
    let jogs = [(8, Stw1::JOG_1), (9, Stw1::JOG_2), (12, Stw1::REAL_TIME_JOG)];
    let numbers: Vec<String> = jogs
        .iter()
        .filter(|(number, bit)| word.has(*bit) && (*number != 12 || positioning(status)))
        .map(|(number, _)| number.to_string())
        .collect();
    let plural = if numbers.len() > 1 { "s" } else { "" };
    format!("(STW1 bit{plural} {})", numbers.join(" and "))
}

pub(super) fn stands_in(status: &DriveStatus) -> String {
    status
        .state()
        .map_or_else(String::new, |state| format!(" (the drive is in {state})"))
}

pub(super) fn telegram(status: &DriveStatus) -> String {
    status
        .telegram
        .map_or_else(|| "its telegram".into(), |number| format!("telegram {number}"))
}
