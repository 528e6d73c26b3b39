//! `profidrive status`

use clap::Args;
use client::status::{Diagnosis, DriveStatus, Note, Verdict, diagnose};
use client::{Action, LossReaction, Wait};
use profidrive::motion::leftovers;
use profile::catalogue::{Catalogue, Part};
use profile::state::{Mode, Profile};
use serde_json::{Map, Value};

use super::axis::{fault_text, warned};
use crate::advice;
use crate::args::Interface;
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::{Colour, Output};
use crate::render::table::clean;
use crate::render::{hex16, words};

#[derive(Debug, Args)]
pub struct Status {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Only the sentence, and what else stands in the way
    #[arg(long)]
    pub short: bool,
}

pub fn run(args: &Status, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let status = session
        .status(&mut drive)
        .wait()
        .map_err(|error| unread(error, &drive.label()))?;
    // a controller may be the very program that will put its setting back
    let left = match status.controller {
        Some(None) => leftovers(&mut session, &mut drive).wait()?,
        _ => Vec::new(),
    };
    session.close().wait()?;
    let mut diagnosis = diagnose(&status);
    diagnosis.notes.extend(left.iter().map(|left| {
        let (sentence, next) = advice::leftover(left, &drive.label());
        Note {
            id: "leftover",
            sentence,
            next: Some(next.into()),
        }
    }));
    if output.json() {
        output.document("status", json(&status, &diagnosis));
    } else {
        let colour = match diagnosis.verdict {
            Verdict::Runs => Colour::Normal,
            Verdict::Waits => Colour::Action,
            Verdict::Held => Colour::Fault,
        };
        let sentence = format!("{}: {}", drive.label(), clean(&diagnosis.sentence));
        output.line(&output.paint(colour, &sentence));
        if let Some(next) = advice::next(&diagnosis, &drive.label()) {
            output.line(&format!("  next: {}", clean(&next)));
        }
        for note in &diagnosis.notes {
            output.line(&output.paint(Colour::Warning, &format!("  also: {}", clean(&note.sentence))));
            if let Some(next) = &note.next {
                let next = advice::text(next, &drive.label());
                output.line(&format!("    next: {}", clean(&next)));
            }
        }
        if !args.short {
            for line in lines(&status, drive.model.catalogue) {
                output.line(&line);
            }
        }
    }
    match diagnosis.verdict {
        Verdict::Runs | Verdict::Waits => Ok(()),
        // the sentence stands on stdout already
        Verdict::Held => Err(Failure::new(
            Exit::Difference,
            format!(
                "{} is kept from running ({})",
                drive.label(),
                diagnosis.cause.id()
            ),
        )),
    }
}

/// A drive whose parameters cannot be read may turn all the same.
fn unread(error: client::Error, drive: &str) -> Failure {
    let silent = error.is_of_parameters();
    let failure = Failure::from(error);
    let stop = advice::sentence(&Action::Stop, drive).filter(|_| silent);
    let hints = failure.hint.clone().into_iter();
    let turns = stop.map(|stop| {
        format!("if it turns: {stop} by its control word, without parameters, where no controller has it")
    });
    let all: Vec<String> = hints.chain(turns).collect();
    if all.is_empty() {
        return failure;
    }
    failure.hint(all.join("; "))
}

/// The facts, one a line.
fn lines(status: &DriveStatus, tables: Option<&Catalogue>) -> Vec<String> {
    let mode = status.word_mode;
    let mut lines = Vec::new();
    let mut line = |name: &str, text: Option<String>| {
        if let Some(text) = text {
            lines.push(format!("{name:<12} {}", clean(&text)));
        }
    };
    line("state", status.state().map(|state| state.to_string()));
    line(
        "STW1",
        status
            .control_word
            .map(|word| words::shown(status.profile.control_bits(mode), word)),
    );
    line(
        "ZSW1",
        status
            .status_word
            .map(|word| words::shown(status.profile.status_bits(mode), word)),
    );
    line(
        "words",
        (status.profile != Profile::Profidrive).then(|| format!("of {}", status.profile.name())),
    );
    line("control", status.controller.as_ref().map(owner));
    line("telegram", status.telegram.map(|number| number.to_string()));
    line("mode", status.mode.map(mode_text));
    line(
        "setpoints",
        status.command_source.map(|source| {
            let text = status.command_source_text.unwrap_or("not in the tables");
            format!("from {source}, {text} (DRV.CMDSOURCE)")
        }),
    );
    line("STO", status.torque_allowed.map(allowed));
    line(
        "disabled by",
        status
            .disable_sources
            .filter(|&sources| sources != 0)
            .map(|sources| bits_of(tables, Part::DisableSources, sources)),
    );
    line(
        "motion held",
        status
            .motion_disable_sources
            .filter(|&sources| sources != 0)
            .map(|sources| bits_of(tables, Part::MotionDisableSources, sources)),
    );
    line("DC bus", status.bus_voltage.map(|volts| format!("{volts:.0} V")));
    line("limits", limits(status));
    if mode == Mode::Position {
        line("homed", status.zsw1.map(homed));
    }
    let rpm = |speed: Option<f64>| speed.map(|speed| format!("{speed:.2} rpm"));
    line("speed set", rpm(status.speed_set));
    let percent = |speed: f64| format!("{speed:.2} % of its reference");
    line(
        "speed",
        rpm(status.speed_actual).or(status.speed_percent.map(percent)),
    );
    let lost = status
        .loss
        .as_ref()
        .filter(|loss| !loss.action.stops() && loss.parameter.is_some());
    line("if lost", lost.map(ToString::to_string));
    line("position", status.position.map(|turns| format!("{turns:.3} rev")));
    line(
        "following",
        status
            .following_error
            .map(|error| format!("{error:.3} rev (position command minus position)")),
    );
    for fault in &status.faults {
        line("fault", Some(fault_text(fault)));
    }
    for warning in &status.warnings {
        line("warning", Some(warned(warning)));
    }
    lines
}

/// `0x0003 [Software disable, Fault present]`
fn bits_of(tables: Option<&Catalogue>, part: Part, word: u16) -> String {
    let known = tables.and_then(|tables| {
        let parameter = tables.part(part)?;
        tables.word_at(parameter.pnu, parameter.base)
    });
    match known {
        Some(known) => format!(
            "{} {}",
            hex16(word),
            words::bracketed(&known.describe(word.into(), Profile::default(), Mode::default()))
        ),
        None => hex16(word),
    }
}

fn owner(controller: &Option<String>) -> String {
    controller.as_ref().map_or_else(
        || "none: no controller is connected".into(),
        |name| format!("controller \"{name}\""),
    )
}

fn mode_text(mode: u16) -> String {
    match mode {
        1 => "1, speed control (PNU 930)".into(),
        2 => "2, positioning (PNU 930)".into(),
        other => format!("{}, vendor-specific (PNU 930)", hex16(other)),
    }
}

fn allowed(allowed: bool) -> String {
    if allowed {
        "torque allowed".into()
    } else {
        "safe torque off".into()
    }
}

fn homed(zsw1: profile::state::Zsw1) -> String {
    if zsw1.has(profile::state::Zsw1::HOMED) {
        "yes (ZSW1 bit 11)".into()
    } else {
        "no (ZSW1 bit 11)".into()
    }
}

fn limits(status: &DriveStatus) -> Option<String> {
    let mut hit = Vec::new();
    for (switch, name) in [
        (status.negative_switch, "negative switch"),
        (status.positive_switch, "positive switch"),
    ] {
        if switch == Some(true) {
            hit.push(name.to_owned());
        }
    }
    if let Some(limits) = status.software_limits.filter(|&limits| limits != 0) {
        hit.push(format!("software limits (SWLS.STATE {limits})"));
    }
    (!hit.is_empty()).then(|| hit.join(", "))
}

fn json(status: &DriveStatus, diagnosis: &Diagnosis) -> Map<String, Value> {
    let mode = status.word_mode;
    let faults: Vec<Value> = status
        .faults
        .iter()
        .map(|fault| entry(fault.number.into(), fault.meaning, fault.remedy))
        .collect();
    let warnings: Vec<Value> = status
        .warnings
        .iter()
        .map(|warning| entry(warning.number, warning.meaning, warning.remedy))
        .collect();
    let notes: Vec<Value> = diagnosis
        .notes
        .iter()
        .map(|note| {
            Value::Object(
                fields! { "cause": note.id, "sentence": note.sentence.as_str(), "next": note.next.as_ref().map(|next| advice::text(next, &status.drive)) },
            )
        })
        .collect();
    let mut fields = fields! {
        "drive": status.drive.as_str(), "verdict": diagnosis.verdict.to_string(), "cause": diagnosis.cause.id(),
        "sentence": diagnosis.sentence.as_str(), "next": advice::next(diagnosis, &status.drive), "actions": advice::json(diagnosis, &status.drive),
        "state": status.zsw1.map(|zsw1| words::state_number(zsw1.0, status.stw1.map(|stw1| stw1.0))),
        "telegram": status.telegram, "mode": status.mode, "command_source": status.command_source,
        "disable_sources": status.disable_sources, "motion_disable_sources": status.motion_disable_sources,
        "motion_status": status.motion, "torque_allowed": status.torque_allowed,
        "negative_switch": status.negative_switch, "positive_switch": status.positive_switch,
        "software_limits": status.software_limits, "speed_set": status.speed_set,
        "speed_actual": status.speed_actual, "speed_percent": status.speed_percent, "position": status.position,
        "following_error": status.following_error, "bus_voltage": status.bus_voltage, "notes": notes,
        "faults": faults, "warnings": warnings,
    };
    if let Some(loss) = &status.loss {
        fields.insert("on_loss".into(), Value::Object(on_loss(loss)));
    }
    if let Some(controller) = &status.controller {
        fields.insert("controller".into(), controller.as_deref().into());
    }
    if let Some(word) = status.control_word {
        fields.insert(
            "stw1".into(),
            words::word_json(status.profile.control_bits(mode), word),
        );
    }
    if let Some(word) = status.status_word {
        fields.insert(
            "zsw1".into(),
            words::word_json(status.profile.status_bits(mode), word),
        );
    }
    fields
}

/// What the drive does when its controller is lost.
fn on_loss(loss: &LossReaction) -> Map<String, Value> {
    fields! {
        "action": loss.action.id(), "parameter": loss.parameter.as_deref(), "setting": loss.setting.as_deref(),
        "after": loss.after.map(|after| after.as_secs_f64()),
    }
}

fn entry(number: u32, meaning: Option<&str>, remedy: Option<&str>) -> Value {
    Value::Object(fields! { "number": number, "meaning": meaning, "remedy": remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::AKD;
    use profile::state::{Stw1, Zsw1};

    #[test]
    fn a_drive_with_a_silent_channel_can_be_stopped() {
        let silent = client::Error::Timeout {
            drive: "vlt-1".into(),
            what: "record access",
            limit: std::time::Duration::from_secs(10),
        };
        let hint = unread(silent, "vlt-1").hint.unwrap_or_default();
        assert!(hint.contains("`profidrive stop vlt-1`"), "{hint}");
        let gone = unread(client::Error::Interrupted, "vlt-1");
        assert_eq!(gone.hint, None);
    }

    #[test]
    fn facts_of_a_position_drive() {
        let status = DriveStatus {
            drive: "akd-1".into(),
            controller: Some(Some("plc\u{1b}[2J".into())),
            stw1: Some(Stw1(0x043F)),
            zsw1: Some(Zsw1(0x2337)),
            control_word: Some(0x043F),
            status_word: Some(0x2337),
            telegram: Some(9),
            mode: Some(2),
            word_mode: Mode::Position,
            positive_switch: Some(true),
            software_limits: Some(1),
            position: Some(1.25),
            disable_sources: Some(3),
            ..DriveStatus::default()
        };
        let text = lines(&status, Some(&AKD)).join("\n");
        for part in [
            "state        S4 operation",
            "ZSW1         0x2337 [READY_ON, READY_OP, OPERATION, IN_TOLERANCE, CTRL_REQ, STOPPED]",
            "control      controller \"plc\\u{1b}[2J\"",
            "mode         2, positioning (PNU 930)",
            "limits       positive switch, software limits (SWLS.STATE 1)",
            "homed        no (ZSW1 bit 11)",
            "position     1.250 rev",
            "disabled by  0x0003 [Software disable, Fault present]",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        assert!(!text.contains("speed"), "{text}");
        let fields = json(&status, &diagnose(&status));
        assert_eq!(fields["cause"], "limit-switch");
        assert_eq!(fields["verdict"], "held");
    }
}
