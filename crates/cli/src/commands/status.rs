//! `profidrive status`

use client::{Drive, Session};
use profidrive::machine::Machine;
use profidrive::report::{Controller, LoadStatus, LossReaction, Quantity, StatusReport, Word};
use profidrive::{Reported, inspection};
use profile::catalogue::Part;
use profile::state::Profile;

use super::each::{self, Each, Progress, Shown};
use crate::advice::Commands;
use crate::args::{Status, Target};
use crate::connect;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::table::clean;
use crate::render::{Page, hex16};

pub fn run(args: &Status, target: &Target, output: &Output) -> Result<(), Failure> {
    let verb = Reading {
        short: args.short,
        machine: connect::machine(&target.options, output)?,
    };
    each::run(&verb, target, output)
}

/// How a status is read and shown.
struct Reading {
    short: bool,
    /// The units of the loads.
    machine: Option<Machine>,
}

impl Each for Reading {
    const DOING: &'static str = "reading the status";

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<Self::Done, Failure> {
        let label = drive.label();
        let status = inspection::status(session, drive, &Commands(&label)).await;
        let Reported { report, outcome } = status.map_err(|error| {
            let more = inspection::without_status(&error);
            Failure::from(error).and_hint(more)
        })?;
        let unit = self
            .machine
            .as_ref()
            .and_then(|machine| machine.user_unit(&label));
        let report = report.of_load(unit);
        Ok(Reported { report, outcome })
    }
}

impl Shown for Reading {
    type Done = Reported<StatusReport>;
    type Report = StatusReport;
    const COLUMNS: &'static [&'static str] = &["status", ">speed", "", "why, and what to do"];
    const MATTER: Option<&'static str> = Some("kept from running");

    fn report(&self, done: &Self::Done, _: &Drive) -> StatusReport {
        done.report.clone()
    }

    fn show(&self, done: &Self::Done, drive: &Drive, output: &Output) {
        done.report.print(output);
        if !self.short {
            let named = |part| drive.named(&[part]).pop();
            for line in lines(&done.report, &named) {
                output.line(&line);
            }
        }
    }

    fn rows(&self, done: &Self::Done, _: &Drive) -> Vec<Vec<String>> {
        let report = &done.report;
        let speed = report.speed_actual.as_ref();
        let mut rows = vec![vec![
            report.verdict.clone(),
            speed.map_or_else(String::new, |speed| format!("{:.0}", speed.value)),
            speed.map_or_else(String::new, |speed| speed.unit.clone()),
            report.sentence.clone(),
        ]];
        if !self.short && report.verdict == "held" {
            let next = report
                .next
                .iter()
                .map(|next| vec![String::new(), String::new(), String::new(), next.clone()]);
            rows.extend(next);
        }
        rows
    }

    fn problems(&self, done: &Self::Done, _: &Drive) -> Vec<Failure> {
        // the sentence stands on stdout already
        let problem = |kind| {
            let report = &done.report;
            let message = format!("{} is kept from running ({})", report.drive, report.cause);
            Failure::new(kind, message)
        };
        done.outcome.kind().map(problem).into_iter().collect()
    }

    fn urgency(&self, done: &Self::Done) -> u8 {
        match done.report.verdict.as_str() {
            "held" => 2,
            "waits" => 1,
            _ => 0,
        }
    }
}

impl Page for StatusReport {
    fn print(&self, output: &Output) {
        let colour = match self.verdict.as_str() {
            "runs" => Colour::Normal,
            "waits" => Colour::Action,
            _ => Colour::Fault,
        };
        let sentence = format!("{}: {}", self.drive, clean(&self.sentence));
        output.line(&output.paint(colour, &sentence));
        if let Some(next) = &self.next {
            output.line(&format!("  next: {}", clean(next)));
        }
        for note in &self.notes {
            output.line(&output.paint(Colour::Warning, &format!("  also: {}", clean(&note.sentence))));
            if let Some(next) = &note.next {
                output.line(&format!("    next: {}", clean(next)));
            }
        }
    }
}

/// The facts, one a line. `named` has the drive's name of the parameter with a part.
fn lines(report: &StatusReport, named: &dyn Fn(Part) -> Option<String>) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = |name: &str, text: Option<String>| {
        if let Some(text) = text {
            lines.push(format!("{name:<12} {}", clean(&text)));
        }
    };
    let words = &report.words;
    let percent = |quantity: &Option<Quantity>, digits: usize, of: &str| {
        let Quantity { value, unit, .. } = quantity.as_ref()?;
        let of = if unit == "%" {
            format!(" of {of}")
        } else {
            String::new()
        };
        Some(format!("{value:.digits$} {unit}{of}"))
    };
    let number = |quantity: &Option<Quantity>, digits| percent(quantity, digits, "its reference");
    let with_load = |motor: Option<String>, load: fn(&LoadStatus) -> &Option<Quantity>| {
        let load = report.load.as_ref().and_then(|found| number(load(found), 3));
        let load = load.map_or_else(String::new, |load| format!(", {load} of the load"));
        motor.map(|motor| motor + &load)
    };
    let set = |word: &Option<Word>| word.as_ref().filter(|word| word.number != 0).map(Word::shown);
    line("state", report.state_text.clone());
    line("STW1", words.stw1.as_ref().map(Word::shown));
    line("ZSW1", words.zsw1.as_ref().map(Word::shown));
    let other = words.profile != Profile::Profidrive.name();
    line("words", other.then(|| format!("of {}", words.profile)));
    line("control", report.controller.as_ref().map(owner));
    line("telegram", report.telegram.map(|number| number.to_string()));
    line("mode", report.operating_mode.map(mode_text));
    line(
        "setpoints",
        report.command_source.as_ref().map(|source| {
            let text = source.meaning.as_deref().unwrap_or("not in the tables");
            let of = named(Part::CommandSource).map_or_else(String::new, |name| format!(" ({name})"));
            format!("from {}, {text}{of}", source.number)
        }),
    );
    let torque = |allowed| {
        if allowed {
            "torque allowed"
        } else {
            "safe torque off"
        }
    };
    line("STO", report.torque_allowed.map(|allowed| torque(allowed).into()));
    line("disabled by", set(&report.disable_sources));
    line("motion held", set(&report.motion_disable_sources));
    line("DC bus", number(&report.bus_voltage, 0));
    line("current", number(&report.current, 2));
    line("torque", percent(&report.torque, 1, "the nominal torque"));
    line("temperature", temperatures(report));
    line("limits", limits(report, named));
    let homed = |homed| {
        if homed {
            "yes (ZSW1 bit 11)"
        } else {
            "no (ZSW1 bit 11)"
        }
    };
    line("homed", report.homed.map(|yes| homed(yes).into()));
    line("speed set", number(&report.speed_set, 2));
    line(
        "speed",
        with_load(number(&report.speed_actual, 2), |load| &load.speed),
    );
    let goes_on =
        |loss: &&LossReaction| matches!(loss.action, "keeps-turning" | "unknown") && loss.parameter.is_some();
    let lost = report.on_loss.as_ref().filter(goes_on);
    line("if lost", lost.map(|loss| loss.text.clone()));
    line(
        "position",
        with_load(number(&report.position, 3), |load| &load.position),
    );
    let following = with_load(number(&report.following_error, 3), |load| &load.following_error);
    line(
        "following",
        following.map(|error| format!("{error} (position command minus position)")),
    );
    for fault in &report.faults {
        let meaning = fault.meaning.as_deref().unwrap_or("not in the tables");
        line("fault", Some(format!("F{} {meaning}", fault.number)));
    }
    for warning in &report.warnings {
        let meaning = warning.meaning.as_deref().unwrap_or("not in the tables");
        line("warning", Some(format!("n{} {meaning}", warning.number)));
    }
    lines
}

fn temperatures(report: &StatusReport) -> Option<String> {
    let of = |quantity: &Option<Quantity>, what: &str| {
        let Quantity { value, unit, .. } = quantity.as_ref()?;
        Some(format!("{value:.0} {unit} ({what})"))
    };
    let all = [
        of(&report.temperature, "power stage"),
        of(&report.motor_temperature, "motor"),
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    (!all.is_empty()).then(|| all.join(", "))
}

fn owner(controller: &Controller) -> String {
    if controller.connected {
        format!(
            "controller \"{}\"",
            controller.name.as_deref().unwrap_or_default()
        )
    } else {
        "none: no controller is connected".into()
    }
}

fn mode_text(mode: u16) -> String {
    match mode {
        1 => "1, speed control (PNU 930)".into(),
        2 => "2, positioning (PNU 930)".into(),
        other => format!("{}, vendor-specific (PNU 930)", hex16(other)),
    }
}

fn limits(report: &StatusReport, named: &dyn Fn(Part) -> Option<String>) -> Option<String> {
    let mut hit = Vec::new();
    for (switch, name) in [
        (report.negative_switch, "negative switch"),
        (report.positive_switch, "positive switch"),
    ] {
        if switch == Some(true) {
            hit.push(name.to_owned());
        }
    }
    if let Some(limits) = report.software_limits.filter(|&limits| limits != 0) {
        let name = named(Part::SoftwareLimitState).unwrap_or_else(|| "state".to_owned());
        hit.push(format!("software limits ({name} {limits})"));
    }
    (!hit.is_empty()).then(|| hit.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use client::status::{DriveStatus, diagnose};
    use profile::catalogue::AKD;
    use profile::state::{Mode, Stw1, Zsw1};

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
        let diagnosis = diagnose(&status);
        let report = StatusReport::new(&status, &diagnosis, Some(&AKD), &Commands("akd-1"));
        let named = |part| AKD.part(part).map(|row| row.name.to_owned());
        let text = lines(&report, &named).join("\n");
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
        assert_eq!((report.cause, report.verdict.as_str()), ("limit-switch", "held"));
    }
}
